"""Errors on bad input: one line with what is wrong, where, and the fix."""

from collections.abc import Sequence

NO_JOINT = "no hinge or slide joint in the model"


class FrictionJointError(ValueError):
    """Base of every error this package raises on bad input.

    Args:
        message: what is wrong, where, and the fix; line breaks, e.g. from names in a user's file,
            become blanks.
    """

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))


class ParameterError(FrictionJointError):
    """A friction or effect parameter is missing, unknown or out of its allowed range."""


class ModelError(FrictionJointError):
    """A MuJoCo model cannot carry the friction given to it."""


class LogError(FrictionJointError):
    """A measured log cannot be read, or its content cannot be trusted."""


class NoMotionError(LogError):
    """The joint of a measured log does not move."""


def few(names: Sequence[str], most: int = 3) -> str:
    """The first of some names, and the number of the others."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
