"""Descriptions of the numbers of effects and of shared causes."""

_QUANTITIES = {
    "added": "of which your model lacks",
    "ambient": "ambient temperature",
    "bias": "torque",
    "cx": "direction, x",
    "cy": "direction, y",
    "deadband": "half width",
    "emf": "voltage per speed",
    "factor": "factor of kp",
    "flank_resonance": "resonance frequency of the flanks",
    "gain": "relative error of the logged torque, in whose unit friction is stated",
    "inertia": "inertia that the model lacks",
    "kt2_over_R": "kt²/R",
    "left": "fraction of the output that remains",
    "limit": "largest output",
    "link_inertia": "inertia of the link",
    "moment": "mass times distance",
    "moment_x": "mass times distance along x",
    "moment_y": "mass times distance along y",
    "rate": "largest speed",
    "reach": "presliding distance",
    "resistance": "thermal resistance",
    "resonance": "resonance frequency",
    "rotor_inertia": "inertia of the rotor",
    "sag": "supply resistance over winding resistance",
    "scale": "temperature rise that lowers friction to 37%",
    "share": "fraction of the load behind the gap",
    "slip": "distance of sliding that undoes it",
    "T0": "reference temperature",
    "tau": "time constant",
    "time_constant": "thermal time constant",
    "viscous_scale": "temperature rise that lowers viscous friction to 37%",
    "vs": "Stribeck velocity of the load-dependent friction",
}
_OF_EFFECT = {
    ("gear-coupling", "concave"): "concave friction",
    ("gear-coupling", "level"): "Coulomb friction",
    ("gear-coupling", "ratio"): "turns of the shaft per turn of the second joint",
    ("gear-coupling", "top"): "concave friction is constant above",
    ("gear-coupling", "viscous"): "viscous friction",
    ("gear-coupling", "wave"): "amplitude along the shaft",
    ("gear-coupling", "inertia"): "inertia",
    ("payload", "inertia"): "inertia",
    ("direction-asymmetry", "level"): "half the difference in Coulomb friction",
    ("direction-asymmetry", "viscous"): "half the difference in viscous friction",
    ("dwell-time", "level"): "largest rise of friction",
    ("dwell-time", "tau"): "time constant of the rise",
    ("end-stop", "lower"): "lower position",
    ("end-stop", "upper"): "upper position",
    ("frictional-lag", "level"): "friction that lags",
    ("frictional-lag", "Vs"): "Stribeck velocity",
    ("load-dependent", "c"): "friction per unit of load",
    ("load-dependent", "cs"): "additional friction at low speed per unit of load",
    ("motor", "gain"): "torque per unit of the drive",
    ("motor-saturation", "s"): "coefficient of the cubed torque",
    ("motor-temperature", "a"): "relative change of torque per kelvin",
    ("nonlinear-viscous", "c"): "coefficient",
    ("nonlinear-viscous", "p"): "exponent of speed",
    ("position-periodic", "N"): "angular frequency",
    ("position-periodic", "cos"): "cosine part",
    ("position-periodic", "sin"): "sine part",
    ("spring", "preload"): "torque at zero position",
    ("temperature-dependent", "level"): "Coulomb friction that falls with temperature",
    ("temperature-dependent", "viscous"): "viscous friction that falls with temperature",
    ("temperature-dependent", "slope"): "fall of Coulomb friction at the reference temperature",
    ("warm-up-drift", "slope"): "initial fall of Coulomb friction",
    ("warm-up-drift", "ratio"): "viscous over Coulomb friction in the loss",
    ("warm-up-drift", "level"): "additional Coulomb friction when cold",
    ("warm-up-drift", "viscous"): "additional viscous friction when cold",
    ("warm-up-drift", "scale"): "distance of sliding that warms the joint",
}


def quantity_of(effect: str, number: str) -> str:
    """Description of a number of an effect.

    Args:
        effect: canonical name, also of a shared cause. number: name of the number.
    Returns:
        for an unknown number, its name with spaces.
    """
    own = _OF_EFFECT.get((effect, number)) or _QUANTITIES.get(number)
    return own or number.replace("_", " ")
