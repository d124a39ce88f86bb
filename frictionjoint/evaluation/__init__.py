"""How far a model is from logs, whatever friction it has; nothing is fitted."""

from frictionjoint.evaluation.run import evaluate

__all__ = ["evaluate"]
