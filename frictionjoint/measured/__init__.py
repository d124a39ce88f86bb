"""Measured logs: formats, validation, derivatives, public data sets."""
