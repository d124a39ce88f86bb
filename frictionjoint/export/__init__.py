"""Conversion of a joint's friction for other programs, one file per target, with its losses.

The package is callable: ``frictionjoint.export(model, to, out)`` is
`frictionjoint.commands.export`.
"""
