"""Conversion of a joint's friction for other programs, one file per target, with the losses of
each.

``c``         a header for controllers: the law, the effects, the parameters of a model's joints

The package is callable: ``frictionjoint.export(model, to, out)`` is
`frictionjoint.commands.export`.
"""
