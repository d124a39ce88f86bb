"""Errors a user can mend: one line that names what is wrong, where, and what to do."""


class FrictionJointError(ValueError):
    """Base of every error this package raises on bad input."""


class ParameterError(FrictionJointError):
    """A friction or effect parameter is missing, unknown or out of its allowed range."""


class ModelError(FrictionJointError):
    """A MuJoCo model cannot carry the friction asked of it."""


class LogError(FrictionJointError):
    """A measured log cannot be read, or its content cannot be trusted."""
