"""``--to mjx``: an MJCF that MJX loads, with the friction that MJX computes.

MJX raises an error for some elements and silently ignores others: coefficients of `damping` beyond
the first, `springyield`, and passive callbacks, and so the friction of this package. Elements for
which MJX raises an error are removed, and each of them is named.
"""

import mujoco

_ACTUATOR = {
    "dyntype": ("mjDYN_DCMOTOR", "mjDYN_PID", "mjDYN_USER"),
    "gaintype": ("mjGAIN_DCMOTOR", "mjGAIN_SO3", "mjGAIN_PID", "mjGAIN_USER"),
    "biastype": ("mjBIAS_DCMOTOR", "mjBIAS_SO3", "mjBIAS_USER"),
    "trntype": ("mjTRN_SLIDERCRANK", "mjTRN_BODY", "mjTRN_SO3"),
}
_EQUALITY = ("mjEQ_FLEX", "mjEQ_FLEXVERT", "mjEQ_FLEXSTRAIN", "mjEQ_DISTANCE")
_SENSOR = (
    *("mjSENS_JOINTLIMITPOS", "mjSENS_JOINTLIMITVEL", "mjSENS_JOINTLIMITFRC"),
    *("mjSENS_TENDONLIMITPOS", "mjSENS_TENDONLIMITVEL", "mjSENS_TENDONLIMITFRC"),
    *("mjSENS_INSIDESITE", "mjSENS_GEOMDIST", "mjSENS_GEOMNORMAL", "mjSENS_GEOMFROMTO"),
    *("mjSENS_E_POTENTIAL", "mjSENS_E_KINETIC", "mjSENS_PLUGIN", "mjSENS_USER"),
)
_FLAGS = ("mjENBL_OVERRIDE", "mjENBL_ENERGY", "mjENBL_FWDINV", "mjENBL_DIAGEXACT")


def fit_for_mjx(spec: mujoco.MjSpec) -> list[str]:
    """Remove elements that MJX 3.17 rejects; the spec is changed in place.

    Returns:
        a sentence per element that was left out or replaced.
    """
    said = []
    option = spec.option
    if option.integrator == mujoco.mjtIntegrator.mjINT_IMPLICIT:
        option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        said.append("the integrator implicit: implicitfast takes its place")
    if option.solver == mujoco.mjtSolver.mjSOL_PGS:
        option.solver = mujoco.mjtSolver.mjSOL_NEWTON
        said.append("the solver PGS: Newton takes its place")
    for flag in _FLAGS:
        bit = int(getattr(mujoco.mjtEnableBit, flag, 0))
        if option.enableflags & bit:
            option.enableflags &= ~bit
            said.append(f"the flag {flag.removeprefix('mjENBL_').lower()}")
    for actuator in list(spec.actuators):
        refused = [
            kind
            for field, names in _ACTUATOR.items()
            for kind in _of(getattr(actuator, field), names)
        ]
        if refused:
            said.append(f"the actuator {actuator.name!r}, of type {refused[0]}")
            for sensor in [x for x in spec.sensors if x.objname == actuator.name]:
                spec.delete(sensor)
            spec.delete(actuator)
    others = (("equality", spec.equalities, _EQUALITY), ("sensor", spec.sensors, _SENSOR))
    for what, elements, names in others:
        for element in list(elements):
            for kind in _of(element.type, names):
                said.append(f"the {what} {element.name!r}, of type {kind}")
                spec.delete(element)
    return said


def _of(value: object, names: tuple[str, ...]) -> list[str]:
    """Plain name of a value that is an enumeration member of one of some types."""
    name = str(getattr(value, "name", value))
    return [name.split("_", 1)[1].lower()] if name in names else []
