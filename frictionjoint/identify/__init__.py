"""From a log to parameters: rigid-body torque, prepared signals, least squares.

The package can be called: ``frictionjoint.identify(logs, model, joint)`` is
`frictionjoint.commands.identify`.
"""

from frictionjoint.callable_package import make_callable

make_callable(__name__)
