"""Several recordings of one joint: what each says of the friction, and how much they differ."""
