"""Torques of a whole rigid-body tree, linear in the inertial parameters of its bodies."""
