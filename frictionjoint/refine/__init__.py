"""Refinement by simulation: the parameters of a named model, fitted to simulated motion.

The torque balance finds and names effects in seconds; a user needs correct motion.

``vector``    the numbers of a fitted model as one vector, with its prior
``objective`` the residual: errors of simulated motion, in windows or whole, and the prior
``guard``     errors on left-out kinds of logs
``refine``    the least squares, the evidence for their result, and whether it is used
"""
