"""The shipped log with an undeclared effect; see README.md in this folder."""
