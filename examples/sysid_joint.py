"""Friction in MuJoCo's system identification: a servo joint made with another friction law.

    python examples/sysid_joint.py [--seconds 6] [--noise 1e-4]

The plant has generalised Maxwell-slip friction and steps at 0.1 ms; its log has noise. mujoco.sysid
then fits Fc, Fs, Vs, sigma2 of the integrated law and the servo's stiffness together.
"""

import argparse
import sys
from pathlib import Path

import mujoco
import numpy as np
from mujoco import sysid

sys.path.append(str(Path(__file__).resolve().parents[1] / "lab"))  # plants
from plants.friction import ATTRACTION, gms, maxwell_elements, stribeck

import frictionjoint as fj
from frictionjoint.simulate.sysid import build_model, friction_parameters, identified, rollout

ARM = """
<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.0005" integrator="implicitfast"/>
  <worldbody><body><joint name="elbow" axis="0 1 0" armature="0.05"/>
    <inertial pos="0 0 -0.25" mass="1.2" diaginertia="0.02 0.02 0.02"/></body></worldbody>
  <actuator><position name="servo" joint="elbow" kp="80" kv="5"/></actuator>
  <sensor><jointpos name="q" joint="elbow"/><actuatorfrc name="torque" actuator="servo"/></sensor>
</mujoco>
"""
TRUE = {"Fc": 1.0, "Fs": 1.5, "Vs": 0.1, "sigma2": 0.4, "kp": 80.0}
FINE = 5  # plant steps in a sample


def target(t):
    """Slow enough to stick and creep, fast enough to tell the viscous part."""
    return 0.5 * np.sin(2 * np.pi * 0.15 * t) + 0.25 * np.sin(2 * np.pi * 0.8 * t)


def measure(seconds, noise):
    """The test joint's log: times, targets, and sensors with noise (rad, and N m times 100)."""
    model = mujoco.MjModel.from_xml_string(ARM)
    sample, model.opt.timestep = model.opt.timestep, model.opt.timestep / FINE
    data, h = mujoco.MjData(model), model.opt.timestep
    k, alpha = maxwell_elements(TRUE["Fs"], 1e-3)
    z, slip, last = np.zeros(len(k)), np.zeros(len(k), bool), 0.0
    times, rows = np.arange(round(seconds / sample)) * sample, []
    for t in times:
        data.ctrl[0] = target(t)
        mujoco.mj_forward(model, data)
        rows.append(data.sensordata.copy())
        for _ in range(FINE):
            v = data.qvel[0]
            level = stribeck(v, TRUE["Fs"], TRUE["Fc"], TRUE["Vs"], 2.0)
            friction = gms(z, slip, v * h, v, h, level, k, alpha, ATTRACTION, 0.5, last)
            data.qfrc_applied[0], last = -friction - TRUE["sigma2"] * v, v
            mujoco.mj_step(model, data)
    noise = noise * np.random.default_rng(0).standard_normal((len(times), 2)) * [1, 100]
    return times, target(times)[:, None], np.array(rows) + noise


def main():
    """Measure, identify, compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=6.0)
    parser.add_argument("--noise", type=float, default=1e-4)
    asked = parser.parse_args()
    times, control, sensors = measure(asked.seconds, asked.noise)
    spec = mujoco.MjSpec.from_string(ARM)
    bare = spec.compile()
    log = sysid.ModelSequences(
        "arm",
        spec,
        "log",
        sysid.create_initial_state(bare, np.zeros(1)),
        sysid.TimeSeries(times, control),
        # sysid counts a sensor at the end of the step it was computed in
        sysid.TimeSeries.from_names(times + bare.opt.timestep, sensors, bare),
    )
    start = fj.FrictionParameters.symmetric(
        Fs=0.7, Fc=0.6, Vs=0.05, sigma2=0.1, n=2, knots=((1e-4, 0.6), (3e-4, 1.0), (1e-3, 1.5))
    )
    ranges = {"Fc": (0.1, 4), "Fs_over_Fc": (1, 3), "Vs": (0.01, 0.5), "sigma2": (0, 2)}
    parameters = sysid.ParameterDict(
        {p.name: p for p in friction_parameters("elbow", start, ranges)}
    )
    servo = sysid.Parameter("kp", 60.0, 20.0, 200.0, modifier=stiffen)
    parameters.add(servo)
    build = build_model({"elbow": start})
    residual = sysid.build_residual_fn(
        models_sequences=[log], build_model=build, custom_rollout=rollout
    )
    with fj.attach(build(parameters, spec)):
        found, _ = sysid.optimize(parameters, residual, verbose=False)
    friction = identified(start, found, "elbow")
    print("            true  started   found")
    for name in ("Fc", "Fs", "Vs", "sigma2"):
        old, new = (getattr(p, f"{name}_pos") for p in (start, friction))
        print(f"{name:8} {TRUE[name]:8.3f} {old:8.3f} {new:8.3f}")
    print(f"{'kp':8} {TRUE['kp']:8.3f} {60:8.3f} {found['kp'].value[0]:8.3f}")


def stiffen(spec, parameter):
    """Write the servo's stiffness into a spec."""
    kp = parameter.value[0]
    servo = spec.actuator("servo")
    servo.gainprm[0], servo.biasprm[1] = kp, -kp


if __name__ == "__main__":
    main()
