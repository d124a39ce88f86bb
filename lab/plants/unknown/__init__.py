"""Effects that the catalogue lacks on purpose.

QUANTITIES are what a residual should point at, by the names of a report; ALSO are effects of the
catalogue that the kind truly brings with it, where it has any.
"""
