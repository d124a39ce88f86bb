"""The shipped log with an undeclared effect; see README.md beside it."""
