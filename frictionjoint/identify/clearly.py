"""Relative reduction of the residual required to prefer another model."""

# part of an error that another law, or the motion without an effect, must take away: what chance or
# a few more parameters do not make
CLEARLY = 0.05
