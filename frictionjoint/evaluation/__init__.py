"""Error of a model on logs, with any kind of friction; nothing is fitted."""

from frictionjoint.evaluation.run import evaluate

__all__ = ["evaluate"]
