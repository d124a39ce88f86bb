"""Refinement by simulation: the parameters of a named model, fitted to simulated motion.

The torque balance finds and names effects in seconds; a user needs correct motion.

``vector``    the numbers of a fitted model as one vector, with its prior
``motion``    simulated motion of logs, in windows or whole
``objective`` the residual: errors of that motion, and the prior
``secant``    its derivatives, by differences and by the steps of a search
``guard``     errors on left-out kinds of logs
``tried``     the least squares, and the evidence for their result
``refine``    whether their result is used
"""
