"""By how much one way to see the logs must leave less than another to be taken in its place."""

# part of an error that another law, or the motion without an effect, must take away: what chance or
# a few more parameters do not make
CLEARLY = 0.05
