"""Causes that several joints share, one file per cause: how each changes the rigid-body model."""
