"""Several recordings of one joint: the friction estimate of each, and how much they differ."""
