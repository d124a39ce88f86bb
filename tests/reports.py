"""Contents of report.json for tests: a good report, and what goes wrong with reports."""

import copy
from typing import Any


def estimate(value: float, stderr: float | None, unit: str = "N m") -> dict[str, Any]:
    return {"value": value, "stderr": stderr, "unit": unit}


LAW = {
    **{f"Fs_{s}": estimate(1.5, 0.05) for s in ("pos", "neg")},
    **{f"Fc_{s}": estimate(1.0, 0.02) for s in ("pos", "neg")},
    **{f"Vs_{s}": estimate(0.05, 0.01, "rad/s") for s in ("pos", "neg")},
    **{f"sigma2_{s}": estimate(0.3, 0.01, "N m s/rad") for s in ("pos", "neg")},
    "n": estimate(4.0, None, "1"),
    "stiffness": estimate(5000.0, 100.0, "N m/rad"),
}
COGGING = {
    "effect": "position-periodic",
    "cause": "cogging, current ripple, eccentric gears: fixed in angle",
    "parameters": {
        "sin": estimate(-0.3, 0.002),
        "cos": estimate(0.4, 0.002),
        "N": estimate(14.0, 0.01, "1/rad"),
    },
    "evidence": {
        "held_out_gain": 0.9,
        "p_value": 0.001,
        "selection_frequency": 1.0,
        "runner_up": "gravity-error",
        "margin": 0.85,
    },
    "torque_rms": {"fit": 0.02, "held_out": 0.025},
}
_GOOD: dict[str, Any] = {
    "schema": "frictionjoint/report-1",
    "joint": "elbow",
    "units": {"torque": "N m", "position": "rad"},
    "slide": False,
    "logs": [
        {"name": "a", "samples": 1000, "duration_s": 10.0, "role": "fit"},
        {"name": "b", "samples": 1000, "duration_s": 10.0, "role": "held-out"},
        {"name": "c", "samples": 1000, "duration_s": 10.0, "role": "held-out"},
    ],
    "log_errors": [
        {"name": "a", "role": "fit", "before": 0.2, "after": 0.02},
        {"name": "b", "role": "held-out", "before": 0.2, "after": 0.022},
        {"name": "c", "role": "held-out", "before": 0.24, "after": 0.028},
    ],
    "drive": {
        "source": "measured",
        "rms": {stage: {"fit": 2.0, "held_out": 2.5} for stage in ("before", "after")},
    },
    "intervals": {
        "torque_rms": {"before": [0.2, 0.25], "after": [0.02, 0.03]},
        "replay_rms": {"before": [0.02, 0.04], "after": [0.001, 0.003]},
    },
    "bandwidth_hz": 20.0,
    "at_rest": 0.1,
    "base": {"law": "integrated", "parameters": LAW},
    "before": {
        "torque_rms": {"fit": 0.2, "held_out": 0.22},
        "replay_rms": {"fit": 0.03, "held_out": 0.03},
    },
    "added": [COGGING],
    "after": {
        "law": "integrated",
        "parameters": LAW,
        "torque_rms": {"fit": 0.02, "held_out": 0.025},
        "replay_rms": {"fit": 0.001, "held_out": 0.002},
    },
    "model": {
        "law": "integrated",
        **{name: x["value"] for name, x in LAW.items() if name != "stiffness"},
        "sigma1": 0.0,
        "knots": [[0.0002, 1.0], [0.001, 3.0]],
        "variant": "ganseman1997",
        "effects": [
            {"effect": "position-periodic", "form": 11, "N": 14.0, "sin": -0.3, "cos": 0.4}
        ],
    },
    "thresholds": {"gain": 0.33, "p_value": 0.05},
    "candidates": [
        {
            "chosen": "position-periodic",
            "runner_up": "gravity-error",
            "rows": [
                {"effect": "position-periodic", "gain": 0.9, "p_value": 0.001},
                {"effect": "gravity-error", "gain": 0.05, "p_value": 0.4},
                {"effect": "spring", "gain": 0.01, "p_value": 1.0},
            ],
        }
    ],
    "noise_floor": 0.01,
    "unexplained": [],
    "proposals": ["To determine Fs: slow motion."],
    "notes": ["The torque is held from one sample to the next. The fit accounts for it."],
    "verdict": "explained",
}


def good(**changes: Any) -> dict[str, Any]:
    """The content of a good report; keys "a.b" change what lies deeper."""
    content = copy.deepcopy(_GOOD)
    for key, value in changes.items():
        put(content, key.replace("__", "."), value)
    return content


def put(content: dict[str, Any], path: str, value: Any) -> None:
    """Change one entry; numbers in the path are places in a list."""
    *parents, last = path.split(".")
    place: Any = content
    for name in parents:
        place = place[int(name)] if isinstance(place, list) else place[name]
    if isinstance(place, list):
        place[int(last)] = value
    else:
        place[last] = value


def empty(**changes: Any) -> dict[str, Any]:
    """The content of a report that found nothing."""
    content = good()
    content["added"] = []
    content["verdict"] = "no-effect-found"
    for key in ("torque_rms", "replay_rms"):
        content["after"][key] = dict(content["before"][key])
        pair = content["intervals"][key]
        pair["after"] = list(pair["before"])
    for row in content["log_errors"]:
        row["after"] = row["before"]
    content["model"]["effects"] = []
    content["candidates"] = [
        {"chosen": None, "runner_up": None, "rows": content["candidates"][0]["rows"][1:]}
    ]
    for key, value in changes.items():
        put(content, key.replace("__", "."), value)
    return content


def robot(**joints: dict[str, Any]) -> dict[str, Any]:
    """The content of a robot's report, of its joints' contents."""
    own = {}
    for name, content in joints.items():
        left = ("schema", "joint", "logs")
        own[name] = {k: v for k, v in content.items() if k not in left} | {"worse": []}

    def percent(stage: str) -> dict[str, float]:
        return {
            role: sum(
                100.0 * x[stage]["torque_rms"][role] / x["drive"]["rms"][stage][role]
                for x in own.values()
            )
            / len(own)
            for role in ("fit", "held_out")
        }

    return {
        "schema": "frictionjoint/report-2",
        "logs": good()["logs"],
        "joints": own,
        "failed": {"hand": "the torque is zero: check its column"},
        "shared": [
            {
                "cause": "payload",
                "body": "gripper",
                "parameters": {
                    "mass": estimate(0.812, 0.02, "kg"),
                    "inertia": estimate(0.001, None, "kg m^2"),
                },
                "evidence": COGGING["evidence"] | {"ties": ["rotor-inertia of elbow"]},
                "joints": {
                    name: {
                        stage: {"torque_rms": x[stage]["torque_rms"]}
                        for stage in ("before", "after")
                    }
                    for name, x in own.items()
                },
            }
        ],
        "undetermined": [],
        "before": {
            "torque_percent": percent("before"),
            "replay_rms": {"fit": 0.01, "held_out": 0.011},
        },
        "after": {
            "torque_percent": percent("after"),
            "replay_rms": {"fit": 0.003, "held_out": 0.0031},
        },
        "proposals": [],
        "notes": [f"joint {i}: something to know" for i in range(7)] + ["a", "b", "c", "d"],
        "verdict": "partly-explained",
    }
