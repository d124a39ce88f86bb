"""Elastic joints and joints with backlash: what `install` writes swings as it should."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.effects.gear import BACKLASH, JOINT_ELASTICITY
from frictionjoint.errors import ModelError
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.rivals import StaticParameters
from frictionjoint.simulate.carrier import read_friction

SMOOTH = StaticParameters.symmetric(Fs=1e-9, Fc=1e-9, Vs=0.1, sigma2=0.02, V0=1e-3)
BODIES = {
    # where the MJCF has the rotor: in the link, in the armature, partly missing; and a point mass
    "in the link": ('pos="0 0 0" mass="1" diaginertia="0.05 0.05 0.06"', 0.0),
    "in the armature": ('pos="0 0 0" mass="1" diaginertia="0.05 0.05 0.03"', 0.03),
    "link too light": ('pos="0 0 0" mass="1" diaginertia="0.05 0.05 0.02"', 0.04),
    "point mass": ('pos="0.2 0 0" mass="1.5" diaginertia="1e-6 1e-6 1e-6"', 0.0),
}
INERTIA, LINK, RESONANCE, RATIO = 0.06, 0.03, 12.0, 0.03


def spec_of(inertial, armature, step=0.001, gravity=0.0, more=""):
    return mujoco.MjSpec.from_string(
        f'<mujoco><compiler angle="radian"/><option timestep="{step}" gravity="0 {-gravity} 0" '
        f'integrator="implicitfast"/><worldbody><body><joint name="j" axis="0 0 1" '
        f'armature="{armature}"/><inertial {inertial}/>{more}</body></worldbody>'
        '<actuator><motor name="m" joint="j"/></actuator>'
        '<keyframe><key name="k" qpos="0.3" qvel="0.1" ctrl="0"/></keyframe></mujoco>'
    )


def installed(spec, *effects):
    fj.install(spec, {"j": SMOOTH}, {"j": [SimulatedEffect(*e) for e in effects]})
    spec.compile()
    model = mujoco.MjModel.from_xml_string(spec.to_xml())
    assert [e.effect.name for e in read_friction(model)["j"].effects] == [
        e[0].name for e in effects
    ]
    return model


ELASTIC = (JOINT_ELASTICITY, (RESONANCE, RATIO), (LINK,))


@pytest.mark.parametrize("case", BODIES)
def test_the_frequency_response_is_that_of_two_masses(case):
    step, length = 0.002, 4000
    model = installed(spec_of(*BODIES[case], step), ELASTIC)
    np.testing.assert_array_equal(model.key_qpos, [[0.3, 0.0]])
    frequencies = np.arange(2.0, 21.0, 0.5)
    t = step * np.arange(5 * length)
    phases = np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, len(frequencies))
    u = 0.05 * np.sin(2.0 * np.pi * np.outer(t, frequencies) + phases).sum(axis=1)
    data, q = mujoco.MjData(model), np.empty(len(t))
    with fj.attach(model):
        for k, data.ctrl[0] in enumerate(u):
            mujoco.mj_step(model, data)
            q[k] = data.qpos[0]
    # after four lengths the transients are gone; what drifts is a line
    end = slice(4 * length, None)
    q = q[end] - np.polyval(np.polyfit(t[end], q[end], 1), t[end])
    lines = np.round(frequencies * step * length).astype(int)
    found = np.abs(np.fft.rfft(q)[lines] / np.fft.rfft(u[end])[lines])
    s, w = 2j * np.pi * frequencies, 2.0 * np.pi * RESONANCE
    link = LINK * s**4 / (s * s + 2.0 * RATIO * w * s + w * w)
    wanted = 1.0 / np.abs(INERTIA * s * s - link + 0.02 * s)
    assert np.abs(20.0 * np.log10(found / wanted)).max() < 1.0
    swinging = frequencies > RESONANCE
    peaks = [frequencies[swinging][np.argmax(x[swinging])] for x in (found, wanted)]
    assert peaks[0] == pytest.approx(peaks[1], rel=0.05)


def test_gravity_bends_the_spring():
    hanging = spec_of('pos="0.2 0 0" mass="1.5" diaginertia="0.01 0.01 0.01"', 0.01, gravity=9.81)
    model = installed(hanging, (JOINT_ELASTICITY, (RESONANCE, 0.2), (0.07,)))
    data = mujoco.MjData(model)
    with fj.attach(model):
        for _ in range(4000):
            data.ctrl[0] = 1.5 * 0.2 * 9.81 - 60.0 * data.qpos[0] - 3.0 * data.qvel[0]
            mujoco.mj_step(model, data)
    stiffness = 0.07 * (2.0 * np.pi * RESONANCE) ** 2
    assert data.qpos[1] == pytest.approx(-1.5 * 0.2 * 9.81 / stiffness, rel=0.01)


@pytest.mark.parametrize("step", [0.001, 0.002])
@pytest.mark.parametrize("integrator", ["mjINT_EULER", "mjINT_IMPLICITFAST"])
def test_a_gap_keeps_its_energy(step, integrator):
    inertia, rotor, gap, flank = 0.05, 0.02, 0.02, 14.0
    spec = spec_of('pos="0.2 0 0" mass="1.25" diaginertia="1e-9 1e-9 1e-9"', rotor, step)
    spec.option.integrator = getattr(mujoco.mjtIntegrator, integrator)
    still = StaticParameters.symmetric(Fs=1e-9, Fc=1e-9, Vs=0.1, sigma2=0.0, V0=1e-3)
    play = SimulatedEffect(BACKLASH, (gap * inertia, flank, 1e-12, 0.0), (1.0,))
    fj.install(spec, {"j": still}, {"j": [play]})
    model = spec.compile()
    data, energies = mujoco.MjData(model), []
    data.qvel[:] = 0.2, 0.5
    stiffness = inertia * (2.0 * np.pi * flank) ** 2
    mass = np.array([[inertia + rotor, inertia], [inertia, inertia]])
    with fj.attach(model):
        for _ in range(round(20.0 / step)):
            mujoco.mj_step(model, data)
            beyond = max(0.0, abs(data.qpos[1]) - 0.5 * gap)
            energies.append(0.5 * data.qvel @ mass @ data.qvel + 0.5 * stiffness * beyond**2)
    tenth = len(energies) // 10
    first, last = np.mean(energies[:tenth]), np.mean(energies[-tenth:])
    assert last == pytest.approx(first, rel=0.01)
    assert np.ptp(energies) < 0.1 * first


def test_in_the_gap_nothing_acts_and_beyond_it_the_flank_holds():
    spec = spec_of('pos="0.2 0 0" mass="1.25" diaginertia="1e-9 1e-9 1e-9"', 0.02, gravity=9.81)
    model = installed(spec, (BACKLASH, (1e-3, 16.0, 0.3, 0.0), (1.0,)))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    held = 1.25 * 9.81 * 0.2
    assert data.qacc[1] == pytest.approx(-held / 0.05, rel=1e-3)  # falls freely
    with fj.attach(model):
        for _ in range(3000):
            data.ctrl[0] = held - 30.0 * data.qpos[0] - 1.5 * data.qvel[0]
            mujoco.mj_step(model, data)
    sag = 0.01 + held / (0.05 * (2.0 * np.pi * 16.0) ** 2)
    assert data.qpos[1] == pytest.approx(-sag, rel=0.01)


def test_what_cannot_be_said_is_refused_or_warned_of():
    with pytest.warns(RuntimeWarning, match="its spring of 200 Hz is softened to"):
        installed(spec_of(*BODIES["in the armature"]), (JOINT_ELASTICITY, (200.0, 0.05), (0.03,)))
    two = '<joint name="other" axis="0 1 0"/>'
    spec = spec_of(*BODIES["in the armature"], more=two)
    with pytest.raises(ModelError, match="'other' of the same body comes after it"):
        fj.install(spec, {"j": SMOOTH}, {"j": [SimulatedEffect(*ELASTIC)]})
    model = installed(spec_of(*BODIES["in the armature"]), ELASTIC)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_SPRING)
    with pytest.raises(ModelError, match="the flag 'spring' is disabled"):
        fj.attach(model)


@pytest.mark.parametrize("case", BODIES)
def test_taken_out_again_the_joint_has_its_inertia(case):
    spec = spec_of(*BODIES[case])
    fj.install(spec, {"j": SMOOTH}, {"j": [SimulatedEffect(*ELASTIC)]})
    fj.uninstall(spec)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.M[0] == pytest.approx(INERTIA, rel=1e-4)
    assert (model.nv, model.ntendon) == (1, 0)
