"""Friction parameters for MuJoCo's own system identification, ``mujoco.sysid``.

    parameters = sysid.ParameterDict()
    for p in friction_parameters("elbow", start, {"Fc": (0.1, 3.0), "sigma2": (0.0, 2.0)}):
        parameters.add(p)                            # with masses, gains, delays of your own
    build = build_model({"elbow": start})
    residual = sysid.build_residual_fn(
        models_sequences=[sequences], build_model=build, custom_rollout=rollout
    )
    with frictionjoint.attach(build(parameters, sequences.spec)):
        found, _ = sysid.optimize(parameters, residual)
    identified(start, found, "elbow")                # FrictionParameters

The spec has no friction; each model built from it does.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import mujoco

try:
    from mujoco import sysid
except ImportError as error:
    raise ImportError(
        f"MuJoCo {mujoco.__version__} has no sysid to import ({error}): pip install "
        "'mujoco[sysid]>=3.17'"
    ) from None

from frictionjoint.errors import ParameterError
from frictionjoint.parameters import FrictionParameters
from frictionjoint.simulate.carrier import install, resolve

# Breakaway as a ratio, for optimisers know bounds but not Fs >= Fc.
RATIO = "Fs_over_Fc"
FREE = ("Fc", RATIO, "Vs", "sigma2", "sigma1", "n")


def friction_parameters(
    joint: str, start: FrictionParameters, ranges: Mapping[str, tuple[float, float]]
) -> list[sysid.Parameter]:
    """Parameters named "joint:Fc" and so on, starting from `start`, equal in both directions.

    Args:
        start: first guess; parameters that are not in `ranges` keep its values.
        ranges: bounds by name: "Fc" (N m), "Fs_over_Fc" (1), "Vs" (rad/s), "sigma1", "sigma2" (N m
            s/rad), "n" (1). The transition curve grows with Fs, its displacements stay.
    Raises:
        ParameterError: an unknown name, or bounds that allow values the law does not.
    """
    values = {name: getattr(start, f"{name}_pos") for name in ("Fc", "Vs", "sigma2")}
    values |= {RATIO: start.Fs_pos / start.Fc_pos, "sigma1": start.sigma1, "n": start.n}
    found = []
    for name, (low, high) in ranges.items():
        if name not in FREE:
            raise ParameterError(f"no free parameter {name!r}: choose from {', '.join(FREE)}")
        for bound in (low, high):
            _moved(start, {name: bound})
        found.append(sysid.Parameter(f"{joint}:{name}", values[name], low, high))
    return found


def identified(
    start: FrictionParameters, parameters: sysid.ParameterDict, joint: str
) -> FrictionParameters:
    """`start` with the present values of a joint's parameters.

    Raises:
        ParameterError: values that the law does not allow.
    """
    prefix = f"{joint}:"
    values = {
        key.removeprefix(prefix): float(parameter.value[0])
        for key, parameter in parameters.items()
        if key.startswith(prefix)
    }
    return _moved(start, values)


def _moved(start: FrictionParameters, values: Mapping[str, float]) -> FrictionParameters:
    """`start` with new values; Fs keeps its ratio to Fc unless the ratio is given."""
    fields: dict[str, Any] = start.to_dict()
    for name in ("sigma1", "n"):
        fields[name] = values.get(name, fields[name])
    for side in ("pos", "neg"):
        ratio = values.get(RATIO, fields[f"Fs_{side}"] / fields[f"Fc_{side}"])
        for name in ("Fc", "Vs", "sigma2"):
            fields[f"{name}_{side}"] = values.get(name, fields[f"{name}_{side}"])
        if "Fc" in values or RATIO in values:
            fields[f"Fs_{side}"] = ratio * fields[f"Fc_{side}"]
    growth = (fields["Fs_pos"] + fields["Fs_neg"]) / (start.Fs_pos + start.Fs_neg)
    fields["knots"] = [(z, F * growth) for z, F in start.knots]
    return FrictionParameters.from_dict(fields)


def build_model(start: Mapping[str, FrictionParameters]) -> sysid.BuildModelFn:
    """Function for ``build_residual_fn(build_model=...)``: a model with the parameters' friction;
    those that are not free keep the values of `start`, by joint name."""

    def build(parameters: sysid.ParameterDict, spec: mujoco.MjSpec) -> mujoco.MjModel:
        changed = sysid.apply_param_modifiers_spec(parameters, spec.copy())
        install(changed, {joint: identified(p, parameters, joint) for joint, p in start.items()})
        model = changed.compile()
        resolve(model)
        return model

    return build


def rollout(
    *,
    models: Sequence[mujoco.MjModel],
    datas: Sequence[mujoco.MjData],
    control_signal: Sequence[sysid.TimeSeries],
    initial_states: Sequence[Any],
    param_dicts: Sequence[sysid.ParameterDict],
    **mappings: Any,
) -> list[sysid.SystemTrajectory]:
    """Function for ``build_residual_fn(custom_rollout=...)``: every rollout starts with joints
    never moved.

    sysid's own rollout starts from a full-physics state, which lacks user data, on `datas` that
    still contain the friction memory of the previous rollout.
    """

    def one(i: int) -> sysid.SystemTrajectory:
        fresh = mujoco.MjData(models[i])
        (trajectory,) = sysid.sysid_rollout(
            [models[i]], [fresh], [control_signal[i]], [initial_states[i]], **mappings
        )
        return trajectory

    with ThreadPoolExecutor(len(datas)) as pool:
        return list(pool.map(one, range(len(models))))
