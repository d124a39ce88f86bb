"""Effects that the catalogue lacks on purpose; QUANTITIES are what a residual should point at."""
