"""Error of a model on logs, with any kind of friction; nothing is fitted."""
