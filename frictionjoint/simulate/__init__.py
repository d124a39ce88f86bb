"""Friction in MuJoCo: the model contains the parameters, the data contain the state."""
