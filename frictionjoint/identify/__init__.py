"""From logs to parameters: rigid-body torque, prepared signals, least squares.

The package is callable: ``frictionjoint.identify(logs, model, joint)`` is
`frictionjoint.commands.identify`.
"""
