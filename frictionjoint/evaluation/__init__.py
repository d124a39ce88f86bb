"""Error of a model on logs, whatever its friction; nothing is fitted."""

from frictionjoint.evaluation.run import evaluate

__all__ = ["evaluate"]
