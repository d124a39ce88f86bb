"""An arm in Newton that hangs on the friction of its joint; Newton has no friction with memory.

    python examples/newton_joint.py

Needs Newton (`pip install newton[sim]`, Python 3.12 is what it asks for). State and friction are
Warp arrays: on a GPU nothing leaves it but what is printed.
"""

import newton
import warp as wp

import frictionjoint as fj

STEP, SECONDS, INERTIA = 2e-3, 4.0, 0.05
FRICTION = fj.FrictionParameters.symmetric(
    Fs=1.0, Fc=0.8, Vs=0.1, sigma2=0.05, knots=((1e-3, 1.0), (4e-3, 2.0))
)
ARM = """<mujoco><option gravity="0 0 -9.81"/><worldbody><body><joint name="joint" axis="0 1 0"
armature="0.04"/><inertial pos="0.2 0 0" mass="{mass}" diaginertia="1e-3 1e-3 1e-3"/>
<geom type="sphere" size="0.02" contype="0" conaffinity="0"/></body></worldbody></mujoco>"""


@wp.kernel
def friction_force(
    qd: wp.array(dtype=float),
    torque: wp.array(dtype=float),
    stiffness: wp.array(dtype=float),
    damping: wp.array(dtype=float),
    h: float,
    inertia: float,
    force: wp.array(dtype=float),
):
    """Minus the friction at the end of the step, without other forces known."""
    i = wp.tid()
    v = qd[i]
    gain = h * stiffness[i] + damping[i]
    end = (inertia * v - h * (torque[i] - damping[i] * v)) / (inertia + h * gain)
    force[i] = -(torque[i] + h * stiffness[i] * end + damping[i] * (end - v))


def fall(mass: float, friction: bool) -> float:
    """Angle, rad, of a level arm of this mass in the end."""
    builder = newton.ModelBuilder()
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    builder.add_mjcf(ARM.format(mass=mass))
    model = builder.finalize()
    solver = newton.solvers.SolverMuJoCo(model)
    state, control = model.state(), model.control()
    batch = fj.FrictionBatch(FRICTION, model.joint_dof_count, device=str(model.device))
    for _ in range(int(SECONDS / STEP)):
        if friction:
            given = batch.step(state.joint_q, state.joint_qd, STEP)
            wp.launch(
                friction_force,
                dim=model.joint_dof_count,
                inputs=[state.joint_qd, *given, STEP, INERTIA],
                outputs=[control.joint_f],
            )
        solver.step(state, state, control, None, STEP)
    return float(state.joint_q.numpy()[-1])


def main() -> None:
    print(f"0.3 kg, with friction: {fall(0.3, True):.4f} rad")
    print(f"0.3 kg, without: {fall(0.3, False):.4f} rad")
    print(f"0.8 kg, with friction: {fall(0.8, True):.4f} rad")


if __name__ == "__main__":
    main()
