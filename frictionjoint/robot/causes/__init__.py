"""What several joints show at once, one file a cause: how it changes a rigid-body model."""
