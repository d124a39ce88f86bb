"""A whole robot at once: every joint, shared causes, one report, one model."""
