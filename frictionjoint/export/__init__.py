"""A joint's friction in the terms of other programs, one file per target, and what each loses.

``c``         a header for controllers: the law, the effects, the parameters of a model's joints

The package can be called: ``frictionjoint.export(model, to, out)`` is
`frictionjoint.commands.export`.
"""

from frictionjoint.callable_package import make_callable

make_callable(__name__)
