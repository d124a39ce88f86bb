"""Presliding that is stiff for the step: hold, slips and stopping against a hundredth of the step.

    python lab/stiff_joints.py         prints the table of lab/notes/stiff_joints.md

A joint of 0.01 kg m^2 at 1 ms, Fs 1.5 N m, Fc 1 N m; its stiffness K is set by h sqrt(K/J).
"""

import mujoco
import numpy as np

import frictionjoint as fj

INERTIA, STEP, FS, FC = 0.01, 1e-3, 1.5, 1.0


def joint(ratio: float, step: float) -> mujoco.MjModel:
    """One hinge with friction of that stiffness."""
    K = INERTIA * (ratio / STEP) ** 2
    p = fj.FrictionParameters.symmetric(
        Fs=FS, Fc=FC, Vs=0.05, n=4.0, virgin="masing", knots=((FS / K, FS), (4 * FS / K, 2 * FS))
    )
    spec = mujoco.MjSpec.from_string(
        f'<mujoco><option timestep="{step}" gravity="0 0 0" integrator="implicitfast"/>'
        '<worldbody><body><joint name="j"/><inertial pos="0 0 0" mass="1" '
        f'diaginertia="{INERTIA} {INERTIA} {INERTIA}"/></body></worldbody></mujoco>'
    )
    fj.install(spec, {"j": p})
    return spec.compile()


def run(model: mujoco.MjModel, load, seconds: float, v0: float = 0.0):
    """Time, position and velocity, each of shape (n,)."""
    data = mujoco.MjData(model)
    data.qvel[0] = v0
    out = []
    with fj.attach(model):
        for _ in range(round(seconds / model.opt.timestep)):
            data.qfrc_applied[0] = load(data.time, data.qpos[0])
            mujoco.mj_step(model, data)
            out.append((data.time, data.qpos[0], data.qvel[0]))
    return np.array(out).T


def figures(ratio: float, step: float) -> list[str]:
    """Cells of a row: rms velocity and creep of a hold, slip distance and period, stopping."""
    t, q, v = run(joint(ratio, step), lambda t, q: 0.5 * FS * min(1.0, t / 2.0), 10.0)
    late = t > 3.0
    cells = [f"{np.sqrt(np.mean(v[late] ** 2)):.1e}", f"{abs(q[-1] - q[late][0]):.1e}"]
    t, q, v = run(joint(ratio, step), lambda t, q: 20.0 * (0.3 * t - q), 4.0)
    edges = np.flatnonzero(np.diff((np.abs(v) < 0.02).astype(int)))
    gone = np.diff(q[edges])
    starts = t[edges[:-1]][gone > 0.02]
    slips = gone[gone > 0.02]
    cells.append(f"{np.median(slips):.4f}" if slips.size else "none")
    cells.append(f"{np.median(np.diff(starts)):.3f}" if slips.size > 1 else "none")
    _, q, v = run(joint(ratio, step), lambda t, q: 0.0, 0.2, v0=1.0)
    cells += [f"{1e3 * q[-1]:.2f}", f"{max(0.0, np.abs(v).max() - 1.0):.1e}"]
    return cells


def main() -> None:
    """Print."""
    print("| h sqrt(K/J) | step, us | rms velocity | creep | slip | period | stop | gained |")
    print("|---|---|---|---|---|---|---|---|")
    for ratio in (0.2, 1.0, 3.0, 8.0, 26.0):
        for step in (STEP, STEP / 100):
            print(
                f"| {ratio:g} | {1e6 * step:g} | {' | '.join(figures(ratio, step))} |", flush=True
            )


if __name__ == "__main__":
    main()
