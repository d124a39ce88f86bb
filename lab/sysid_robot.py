"""mujoco.sysid on a whole robot, for `robot_rivals.py`: within a bound of time.

The pseudo-inertia of the last links, and the armature, damping and frictionloss of every joint,
fitted to positions of short free runs, from one start.
"""

import time

import mujoco
import numpy as np
from mujoco import sysid

STEP = 2e-3
# last links whose inertia is fitted
LINKS = 3


class Timed:
    """A residual that remembers the numbers that left least, for a time.

    Args:
        limit: s of processor time.
    """

    def __init__(self, residual, limit):
        self.residual, self.limit = residual, limit
        self.begin, self.count = time.process_time(), 0
        self.least, self.best, self.first = np.inf, None, None

    @property
    def spent(self):
        """s of processor time."""
        return time.process_time() - self.begin

    def __call__(self, x, *args, **kwargs):
        if self.spent > self.limit:
            raise TimeoutError
        found = self.residual(x, *args, **kwargs)
        left = sum(float(np.sum(np.square(part))) for part in found[0])
        self.count += np.size(x) // len(x)
        if np.size(x) > len(x):  # a difference quotient: one column for each number
            return found
        self.first = left if self.first is None else self.first
        if left < self.least:
            self.least, self.best = left, np.array(x).ravel()
        return found


def fitted(model_file, names, sizes, pieces, dt, limit):
    """The model with its numbers, and s of processor time.

    Args:
        sizes: rms torque of each joint. pieces: free runs: positions, velocities, torques.
        dt: s between their samples. limit: s of processor time.
    """
    spec = mujoco.MjSpec.from_file(str(model_file))
    spec.option.timestep = STEP
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    for name in names:
        motor = spec.add_actuator(name=f"motor {name}", target=name)
        motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
        spec.add_sensor(
            name=f"q {name}",
            type=mujoco.mjtSensor.mjSENS_JOINTPOS,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            objname=name,
        )
    model = spec.compile()
    parameters = sysid.ParameterDict()
    for j, name in enumerate(names):
        body = model.body(int(model.joint(name).bodyid[0])).name
        kind = sysid.InertiaType.Pseudo
        if j >= len(names) - LINKS:
            parameters.add(
                sysid.body_inertia_param(spec, model, body, kind, modifier=inertia_setter(body))
            )
        rotor = float(model.joint(name).armature[0])
        for key, start, most in (
            ("armature", rotor, 2.0 * rotor + 0.5 * sizes[j] / 10.0),
            ("damping", 0.01 * sizes[j], sizes[j]),
            ("frictionloss", 0.1 * sizes[j], sizes[j]),
        ):
            parameters.add(
                sysid.Parameter(f"{name} {key}", start, 0.0, most, modifier=setter(name, key))
            )
    times = np.arange(len(pieces[0][0])) * dt
    log = sysid.ModelSequences(
        "arm",
        spec,
        [f"run {k}" for k in range(len(pieces))],
        [sysid.create_initial_state(model, q[0], v[0]) for q, v, _ in pieces],
        [sysid.TimeSeries(times, drive) for _, _, drive in pieces],
        [sysid.TimeSeries.from_names(times, q, model) for q, _, _ in pieces],
    )
    residual = Timed(sysid.build_residual_fn(models_sequences=[log], n_threads=1), limit)
    found = parameters.move_off_bounds()
    try:
        found, _ = sysid.optimize(found, residual, verbose=False, max_iters=40)
        state = "ended"
    except TimeoutError:
        found.update_from_vector(residual.best)
        state = "stopped"
    print(
        f"sysid: {state} after {residual.count} runs of {len(pieces)} windows; "
        f"squares {residual.first:.3g} to {residual.least:.3g}"
    )
    changed = sysid.apply_param_modifiers_spec(found, spec.copy())
    return changed.compile(), residual.spent


def inertia_setter(name):
    """sysid's own modifier, with principal inertias: what it writes does not compile in 3.17."""

    def write(spec, parameter):
        sysid.apply_body_inertia(spec, name, parameter)
        body = spec.body(name)
        xx, yy, zz, xy, xz, yz = np.array(body.fullinertia).ravel()
        sizes, axes = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        axes[:, 2] *= np.linalg.det(axes)
        quat = np.zeros(4)
        mujoco.mju_mat2Quat(quat, axes.ravel())
        body.fullinertia = np.full(6, np.nan)
        body.inertia, body.iquat = sizes, quat

    return write


def setter(name, key):
    """A modifier that writes one number of a joint."""

    def write(spec, parameter):
        joint = spec.joint(name)
        value = float(parameter.value[0])
        if key == "damping":
            damping = np.zeros_like(joint.damping)  # a polynomial in newer versions
            damping.flat[0] = value
            joint.damping = damping
        else:
            setattr(joint, key, value)

    return write
