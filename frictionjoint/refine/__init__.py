"""Refinement by simulation: the parameters of a named model, fitted to simulated motion.

The torque balance finds and names effects in seconds; a user needs correct motion.

``vector``    the numbers of a fitted model as one vector, with its prior
``objective`` the residual: errors of simulated motion, in windows or whole, and the prior
``guard``     errors on left-out kinds of logs
``tried``     the least squares, and the evidence for their result
``refine``    whether their result is used, and as the report states it
"""
