"""Effects beyond the friction law, one file each; `catalogue` lists them, `kernel` runs them."""
