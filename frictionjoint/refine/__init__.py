"""Refinement by simulation: the parameters of a named model, fitted to simulated motion.

The balance of torques finds and names in seconds; what a user wants right is the motion.

``vector``    the numbers of a fitted model as one vector, with its prior
``motion``    simulated motion of logs, in windows or whole
``objective`` what is made small: errors of that motion, and the prior
``secant``    its derivatives, by differences and by the steps of a search
``guard``     errors on kinds of logs left out
``tried``     the least squares, and what logs say of them
``refine``    whether their result is taken
"""

from frictionjoint.refine.refine import Refined, refine

__all__ = ["Refined", "refine"]
