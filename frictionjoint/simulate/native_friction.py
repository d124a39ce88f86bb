"""MuJoCo's own friction and damping of a joint, which would count twice together with ours."""

from collections.abc import Iterable

import mujoco
import numpy as np

from frictionjoint.model_files import compiled_copy

CLEAR = "clear it with `frictionjoint install --clear-native`, or install(..., clear_native=True)"


def native_friction(model: mujoco.MjModel, joints: Iterable[str]) -> dict[str, str]:
    """MuJoCo's own friction in words by joint name, without joints that have none."""
    found = {}
    for name in joints:
        dof = int(model.jnt_dofadr[model.joint(name).id])
        # MuJoCo 3.7 on: damping that grows with the speed
        more = model.dof_dampingpoly[dof] if hasattr(model, "dof_dampingpoly") else ()
        found[name] = _words(model.dof_frictionloss[dof], [model.dof_damping[dof], *more])
    return {name: words for name, words in found.items() if words}


def tendon_friction(model: mujoco.MjModel, joint: str) -> list[str]:
    """A sentence for each fixed tendon with native friction or damping over a joint."""
    found = []
    for t in range(model.ntendon):
        first, count = int(model.tendon_adr[t]), int(model.tendon_num[t])
        fixed = model.wrap_type[first] == mujoco.mjtWrap.mjWRAP_JOINT
        if fixed and model.joint(joint).id in model.wrap_objid[first : first + count]:
            words = _words(model.tendon_frictionloss[t], [model.tendon_damping[t]])
            if words:
                name = model.tendon(t).name or "without a name"
                found.append(f"tendon {name} over the joint has MuJoCo's own {words} too")
    return found


def native_friction_of_spec(spec: mujoco.MjSpec, joints: Iterable[str]) -> dict[str, str]:
    """Native friction of a spec, including the damping from ``springdamper`` at compilation."""
    joints = list(joints)
    if any(_has_springdamper(spec.joint(name)) for name in joints):
        return native_friction(compiled_copy(spec), joints)
    own = ((name, spec.joint(name)) for name in joints)
    found = {name: _words(j.frictionloss, np.atleast_1d(j.damping)) for name, j in own}
    return {name: words for name, words in found.items() if words}


def clear_native_friction(spec: mujoco.MjSpec, joints: Iterable[str]) -> None:
    """Remove frictionloss and damping from joints of a spec.

    ``springdamper`` overrides a joint's stiffness and damping when the model compiles: its
    stiffness is kept as a number, its damping removed.
    """
    joints = list(joints)
    of_springdamper = [name for name in joints if _has_springdamper(spec.joint(name))]
    if of_springdamper:
        model = compiled_copy(spec)
        for name in of_springdamper:
            set_first(spec.joint(name), "stiffness", model.joint(name).stiffness[0])
            spec.joint(name).springdamper = np.zeros(2)
    for name in joints:
        spec.joint(name).frictionloss = 0.0
        set_first(spec.joint(name), "damping", 0.0)


def set_first(joint: mujoco.MjsJoint, field: str, value: float) -> None:
    """Set the first coefficient of a polynomial and clear the others; until MuJoCo 3.6 there is one
    number."""
    numbers = np.zeros_like(np.array(getattr(joint, field), dtype=np.float64))
    np.ravel(numbers)[:1] = value
    setattr(joint, field, numbers if numbers.ndim else value)


def _has_springdamper(joint: mujoco.MjsJoint) -> bool:
    return bool(np.all(np.asarray(joint.springdamper) > 0.0))


def counts_twice(found: dict[str, str]) -> str:
    """Sentence of a message that native friction would count twice."""
    joints = "; ".join(f"{name!r} has {words}" for name, words in found.items())
    return f"friction counts twice where native friction acts too: joint {joints}: {CLEAR}"


def _words(loss: float, damping: Iterable[float]) -> str:
    coefficients = [float(x) for x in damping]
    while coefficients and coefficients[-1] == 0.0:
        coefficients.pop()
    said = [f"frictionloss {loss:g}"] if loss else []
    if coefficients:
        said.append(f"damping {' '.join(f'{x:g}' for x in coefficients)}")
    return " and ".join(said)
