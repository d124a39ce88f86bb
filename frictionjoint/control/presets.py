"""Controllers of common servos and legs; values that differ between units are read from the log."""

import math

from frictionjoint.control.controller import Controller

_COUNT = 2.0 * math.pi / 4096.0

PRESETS = {
    # The firmware's PWM is kp (goal - position in counts) / 256, 885 is full duty.
    "xl330": Controller(
        output="duty",
        kp="log:kp",
        gain_unit=1.0 / (_COUNT * 256.0 * 885.0),
        supply_v="log:vin",
        limit=1.0,
        count_rad=_COUNT,
        source="ROBOTIS e-manual, XL330-M288 (position P gain over 128 on a scale of 885 in units "
        "of half a count); agrees with the PWM register of BAM's logs to 0.5%",
    ),
    "sts3215": Controller(
        output="duty",
        kp="log:kp",
        gain_unit=0.164890901,
        supply_v=12.0,
        limit=0.9625,
        count_rad=_COUNT,
        source="kscalelabs/sysid and BAM (Rhoban), actuator sts3215: gain of the duty and largest "
        "duty, by oscilloscope at the motor's leads",
    ),
    "unitree": Controller(
        output="torque_nm",
        kp="log:kp",
        kd="log:kd",
        source="Unitree SDK 2, LowCmd: tau + kp (q - q_now) + kd (dq - dq_now) on the motor's own "
        "board",
    ),
    "mit": Controller(
        output="torque_nm",
        kp="log:kp",
        kd="log:kd",
        source="Katz, A low cost modular actuator for dynamic robots (MIT, 2018), section 4: "
        "joint PD with feed-forward at the motor",
    ),
}
