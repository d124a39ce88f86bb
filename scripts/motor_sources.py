"""What the library of motors is identified from: logs, models, licences, conditions.

Paths of logs are patterns in the data folder. Those that are not as published are made by
`lab/motor_logs.py` from clones of the repositories.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Presliding:
    """What is assumed of a joint before it slides.

    Attributes:
        damping: over the critical one of the joint's own inertia in its model.
        length: displacement to the breakaway torque at the first stiffness, rad, which the encoder
            does not resolve; None: as fitted.
        flat: friction at rest is no more than in slow sliding, where the logs do not determine it
            and the fit ends at its bound.
    """

    damping: float
    length: float | None = None
    flat: bool = False


@dataclass(frozen=True)
class Source:
    """Logs of one motor, or of one robot.

    Attributes:
        title: of the machine. logs: fitted ones, patterns in the data folder.
        held_out: such patterns, or the fraction of each log's end.
        model: MJCF in models/, or PATTERN=MJCF by the names of the logs. joint: None for a robot.
        address, licence: of the logs. controller: preset or file in models/. remark: of the author.
        assumed: what is assumed before sliding, by joint, where the fitted numbers are not
            determined and would not hold a load at rest.
        conditions: of the recordings. refine: whether numbers are fitted to simulated motion too,
            where the controller is known.
        units: joints that are units of one actuator, with their own logs or none where `logs`
            holds them all; the library keeps the one that is explained best and lists the others.
        columns: OURS=THEIRS, for columns that are named otherwise in the logs.
    """

    title: str
    logs: tuple[str, ...]
    held_out: tuple[str, ...] | float
    model: tuple[str, ...]
    joint: str | None
    address: str
    licence: str
    controller: str = ""
    remark: str = ""
    assumed: Mapping[str, Presliding] = field(default_factory=dict)
    conditions: str = ""
    refine: bool = True
    units: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    columns: tuple[str, ...] = ()


NO_LICENCE = "none stated"
NOT_SHIPPED = "The logs are not redistributed; these are numbers of a fit."


def damiao(kind: str, full_scale: str, joints: Mapping[str, int]) -> Source:
    """Motors of one kind in the arm AM-D02; which kind is told by the counts of torque."""
    return Source(
        f"Damiao {kind}",
        (),
        0.3,
        ("am_d02.xml",),
        None,
        "https://github.com/YIZHIXIAOCANGSHU/Friction-Identification-for-Manipulators/tree/f9157512",
        NO_LICENCE,
        remark="The repository does not name the motors: steps of torque and speed in the log are "
        f"those of {kind}, full scale {full_scale}. Torque is the motor's own estimate. "
        f"{NOT_SHIPPED}",
        conditions="Joint of a 7-axis arm, the others held; 23 to 27 °C, about 33 Hz over a serial "
        "line.",
        assumed=dict.fromkeys(joints, Presliding(0.1)),
        units={joint: (f"damiao/joint_{i}.csv",) for joint, i in joints.items()},
    )


def ur10e(size: str, *joints: str) -> Source:
    """Joints of one size of a UR10e."""
    return Source(
        f"Universal Robots UR10e, joint {size}",
        ("ur10e/20_02_12-40sec_12harm.csv",),
        ("ur10e/20_01_31-unload.csv",),
        ("ur10e.xml",),
        None,
        "https://github.com/shamilmamedov/dynamic_calibration/tree/11af40e7",
        NO_LICENCE,
        remark="Torque is the motor current times the ratio of the controller's target moment to "
        f"its target current at rest. Held out: another day. {NOT_SHIPPED}",
        conditions="Bare flange, 46 s of an exciting motion at 100 Hz.",
        units=dict.fromkeys(joints, ()),
    )


def fr3(size: str, *joints: str) -> Source:
    """Joints of one size of a Franka Research 3; joint 5 hardly moves in these logs."""
    return Source(
        f"Franka Research 3, actuator {size}",
        ("fr3/162545.csv", "fr3/162853.csv", "fr3/163055.csv"),
        ("fr3/163230.csv",),
        ("fr3.xml",),
        None,
        "https://github.com/shubhamsonkar01/franka_ros2_teleop_data_collection/tree/1c62aa8d",
        "Apache-2.0 by its README",
        remark="Torque was measured behind the gear.",
        assumed=dict.fromkeys(joints, Presliding(0.1)),
        conditions="With hand, following another arm that was led by hand, 10 s each at 1 kHz, "
        "every tenth row.",
        units=dict.fromkeys(joints, ()),
    )


def kr300(axis: int) -> Source:
    """An axis of a KUKA of the KR300 class."""
    return Source(
        f"KUKA KR300 R2500 ultra, axis{axis}",
        ("kuka_kr300/A.csv",),
        ("kuka_kr300/B.csv",),
        ("kuka_kr300.xml",),
        f"axis{axis}",
        "https://github.com/JonasWeigand/Robot_Identification/tree/9e403c07",
        "MIT",
        remark="Position is that of the link." if axis < 4 else "Position is that of the motor.",
        conditions="Payload of 150 kg, 10 s at 250 Hz.",
        columns=()
        if axis < 4
        else tuple(f"axis{i}.position_rad=axis{i}.motor_position_rad" for i in (4, 5, 6)),
    )


SOURCES = {
    "xl330": Source(
        "Dynamixel XL330 servo",
        (
            "xl330/*_10h28m*.json",
            "xl330/*_10h29m04.json",
            "xl330/*_10h29m[45]*.json",
            "xl330/*_10h30m*.json",
        ),
        ("xl330/*_10h29m[123]*.json",),
        ("xl330_pendulum.xml",),
        "pendulum",
        "https://github.com/Rhoban/bam/tree/af2260462471ff45ac18af159b1327ea51d8db15",
        "Apache-2.0",
        conditions="Pendulum of 0.49 kg on 0.1 m, 7.4 V, 28 to 39 °C, 190 Hz.",
        controller="xl330",
        remark="Held out: firmware gain 400. Presliding is below the encoder's count.",
        assumed={"pendulum": Presliding(0.3, 4.4e-4)},
    ),
    "sts3215": Source(
        "Feetech STS3215 servo, 12 V",
        ("sts3215/*_kp4_*.json", "sts3215/*_kp16_*.json", "sts3215/*_kp32_*.json"),
        ("sts3215/*_kp8_*.json",),
        ("m0.535*=sts3215_pendulum.xml", "m0.969*=sts3215_pendulum_heavy.xml"),
        "pendulum",
        "https://github.com/kscalelabs/sysid/tree/addeb83",
        NO_LICENCE,
        conditions="Pendulum of 0.535 kg on 0.1 m and 0.969 kg on 0.15 m, 12 V, 100 Hz.",
        controller="sts3215",
        remark=f"Held out: firmware gain 8. Presliding is below the encoder's count. {NOT_SHIPPED}",
        assumed={"pendulum": Presliding(0.1)},
    ),
    "emps": Source(
        "EMPS, electro-mechanical positioning system",
        ("emps/DATA_EMPS.mat",),
        0.3333,
        ("emps.xml",),
        "carriage",
        "https://github.com/forgi86/sysid-neural-continuous/tree/956aa7ec",
        NO_LICENCE,
        conditions="Horizontal axis, 1 kHz.",
        controller="emps.controller.toml",
        remark=NOT_SHIPPED,
    ),
    "panda": Source(
        "Franka Emika Panda",
        ("panda",),
        0.3,
        ("panda.xml",),
        None,
        "https://github.com/marcocognetti/FrankaEmikaPandaDynModel",
        "GPL-3.0",
        conditions="Bare flange, 21 s at 1 kHz.",
        remark="Torque was measured behind the gear.",
        assumed={"joint1": Presliding(0.1, 1.3e-4), "joint2": Presliding(0.1, 1.3e-4)},
    ),
    "tx40": Source(
        "Staubli TX40",
        ("staubli_tx40",),
        0.3,
        ("staubli_tx40.xml",),
        None,
        "https://github.com/thanhndv212/figaroh-examples/tree/c0b5c7f0",
        "Apache-2.0",
        conditions="Bare flange, 9 s at 5 kHz.",
        assumed={"joint_1": Presliding(0.1, 1.5e-5)},
    ),
    "ur10": Source(
        "Universal Robots UR10",
        ("unisa_ur10/ur10.csv",),
        0.3,
        ("ur10.xml",),
        None,
        "https://github.com/unisa-acg/inverse-dynamics-solver/tree/41e196de",
        "BSD-3-Clause",
        conditions="Bare flange, 27.5 s at 125 Hz.",
    ),
    # joint 2, the other DM-J8009P, lost a quarter of its messages; joint 1 has a ripple of 252 per
    # turn of its rotor, twelve times its 21 pole pairs
    "dm8009": damiao("DM-J8009P-2EC", "54 N m", {"second": 1}),
    "dm4340": damiao("DM-J4340P-2EC", "28 N m", {"fourth": 3}),
    "dm4310": damiao("DM-J4310-2EC", "10 N m", {"sixth": 5, "sixthoutput": 6, "seventh": 7}),
    "ak80_6": Source(
        "T-Motor AK80-6 quasi-direct drive",
        tuple(f"ak80/trajectory_0{i}.csv" for i in (0, 1, 5)),
        tuple(f"ak80/trajectory_0{i}.csv" for i in (2, 4)),
        ("ak80_double_pendulum.xml",),
        None,
        "https://github.com/dfki-ric-underactuated-lab/double_pendulum/tree/1e8544e6",
        "BSD-3-Clause",
        conditions="Double pendulum driven at both joints, 10 s at 500 Hz.",
        units={"joint1": (), "joint2": ()},
    ),
    "ur10e_size4": ur10e("size 4", "j1", "j2"),
    "ur10e_size3": ur10e("size 3", "j3"),
    "ur10e_size2": ur10e("size 2", "j4", "j5"),
    "go2_calf": Source(
        "Unitree Go2, calf",
        ("go2/traj_0.csv",),
        0.3,
        ("go2.xml",),
        "FL_calf_joint",
        "https://github.com/iit-DLSLab/sim2real-robot-identification/tree/06739ea0",
        "BSD-3-Clause",
        controller="go2.controller.toml",
        remark="The log holds target and position; torque is that of the authors' gains, 20 N m "
        "per rad and 1.5 N m s per rad, which this recording does not state. Friction scales with "
        "them.",
        conditions="Base held, legs in the air, 23 s at 200 Hz.",
        refine=False,
    ),
    "so101": Source(
        "SO-101 arm, Feetech STS3215 servo of joint Pitch",
        tuple(f"so101/{x}.csv" for x in ("friction_gravity", "frequency_sweep", "prbs_excitation")),
        ("so101/step_response.csv", "so101/actuator_bandwidth.csv"),
        ("so101.xml",),
        "Pitch",
        "https://github.com/isaac-sim2real/sage/tree/2a7526e0",
        "Apache-2.0",
        controller="so101.controller.toml",
        remark="The logs hold target and position. Torque is the position error times a gain that "
        "they do not state: 14.5 N m/rad here, about 11 by the gravity on three joints in slow "
        "motion, so torques are known to a third. Viscous friction includes back-EMF and the "
        "damping of the servo's controller. Presliding is below the encoder's count.",
        conditions="Whole arm moving by 0.15 rad about one pose, 50 Hz. Supply not stated.",
        refine=False,
    ),
    **{f"kr300_axis{i}": kr300(i) for i in range(1, 7)},
    "sts3250": Source(
        "Feetech STS3250 servo, 12 V",
        tuple(f"sts3250/*_kp{kp}_[lsu]*.json" for kp in (4, 16, 32)),
        ("sts3250/*_kp8_[lsu]*.json",),
        ("m0.535*=sts3215_pendulum.xml", "m0.969*=sts3215_pendulum_heavy.xml"),
        "pendulum",
        "https://github.com/kscalelabs/sysid/tree/addeb83",
        NO_LICENCE,
        controller="sts3215",
        remark="Held out: firmware gain 8. The servo's gain of the duty was measured at its leads, "
        f"0.164 against 0.165 for the STS3215. {NOT_SHIPPED}",
        conditions="Pendulum of 0.535 kg on 0.1 m and 0.969 kg on 0.15 m, 12 V, 100 Hz.",
        refine=False,
    ),
    "kinova_gen3_small": Source(
        "Kinova Gen3, small actuator, joint 7",
        tuple(f"kinova/speed_{v}.csv" for v in ("0.03", "0.09", "0.1", "0.3", "0.7", "1.3", "1.5")),
        tuple(f"kinova/speed_{v}.csv" for v in ("0.05", "0.5", "0.9")),
        ("kinova_gen3_joint7.xml",),
        "joint_7",
        "https://github.com/HBRS-SDP/joint-friction-model/tree/bf1c8d87",
        NO_LICENCE,
        remark="Torque is the motor current times 7.6 N m/A. The joint turns one way only, so "
        "friction and offset cannot be distinguished. The authors saw breakaway at 2.5 to 3.1 N m. "
        f"{NOT_SHIPPED}",
        conditions="Arm upright, joint 7 turning at ten constant speeds, 3 s each at 999 Hz.",
    ),
    "ri50": Source(
        "T-Motor RI50 on an mjbots moteus, no gear",
        ("ri50/17-39-20.csv",),
        0.3,
        ("ri50_motor.xml",),
        "rotor",
        "https://github.com/karthikurs/actuator-dynamometer/tree/1ab6e56f",
        NO_LICENCE,
        remark="Torque is that of the controller less that of the torque sensor behind the motor. "
        f"It turns one way only. {NOT_SHIPPED}",
        assumed={"rotor": Presliding(0.3, 4e-4, flat=True)},
        conditions="Dynamometer, steps of speed to 130 rad/s with the load motor idle, 36 V, 28 to "
        "32 °C, 90 Hz.",
    ),
    "odrive_bldc": Source(
        "Bare brushless motor on an ODrive",
        ("odrive/fit_*.csv",),
        ("odrive/held_*.csv",),
        ("bldc_motor.xml",),
        "rotor",
        "https://github.com/gchenfc/ODrive/tree/54611550",
        "MIT",
        remark="The motor is not named. Its constant was estimated from the inertia that the "
        "authors state, 2.5e-4 kg m²; friction scales with that figure. Cogging was compensated.",
        assumed={"rotor": Presliding(0.3, flat=True)},
        conditions="Spun up by constant currents to 2.4 A, 1 s each at 1.3 kHz, nothing on the "
        "shaft. Held out: another trial.",
    ),
    "fr3_large": fr3("large, joints 1 to 4", "joint2", "joint4"),
    "fr3_small": fr3("small, joints 5 to 7", "joint6", "joint7"),
}
