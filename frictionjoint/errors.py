"""Errors a user can mend: one line that names what is wrong, where, and what to do."""

from collections.abc import Sequence


class FrictionJointError(ValueError):
    """Base of every error this package raises on bad input.

    Args:
        message: names what is wrong, where, and the mend; made one line whatever names of a user's
            file it quotes.
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
    """The first of some names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
