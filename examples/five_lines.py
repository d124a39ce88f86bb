"""Five lines to a better joint: an arm held by friction alone, for ten seconds.

    python examples/five_lines.py

At 0.2 rad from hanging the load asks for 0.93 N m of the joint's 1.5 N m. MuJoCo's frictionloss of
the same torque lets the arm creep down; the hysteresis gives by microradians and holds.
"""

import mujoco

import frictionjoint as fj

ARM = """
<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.001" integrator="implicitfast"/>
  <worldbody><body euler="0 0.2 0"><joint name="elbow" axis="0 1 0" armature="0.05"/>
    <inertial pos="0 0 -0.4" mass="1.2" diaginertia="0.05 0.05 0.05"/></body></worldbody>
</mujoco>
"""
# displacement, rad, and torque, N m, of the transition curve
KNOTS = ((1e-4, 1.5), (3e-4, 2.5), (1e-3, 3.2))
ELBOW = fj.FrictionParameters.symmetric(
    Fs=1.5, Fc=1.0, Vs=0.05, sigma1=3.0, sigma2=0.3, n=2, knots=KNOTS
)


def main():
    """The five lines, then the same arm with frictionloss."""
    spec = mujoco.MjSpec.from_string(ARM)
    fj.install(spec, {"elbow": ELBOW})
    model = spec.compile()
    data = mujoco.MjData(model)
    with fj.attach(model):
        mujoco.mj_step(model, data, nstep=10_000)
    print("after 10 s       position         velocity")
    print(f"frictionjoint  {1e3 * data.qpos[0]:9.4f} mrad, {1e3 * data.qvel[0]:9.2g} mrad/s")

    spec = mujoco.MjSpec.from_string(ARM)
    spec.joint("elbow").frictionloss = ELBOW.Fs_pos
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=10_000)
    print(f"frictionloss   {1e3 * data.qpos[0]:9.4f} mrad, {1e3 * data.qvel[0]:9.2g} mrad/s")


if __name__ == "__main__":
    main()
