"""Nothing that a report shows contradicts anything else that it shows.

A dozen contents of report.json, made up to contradict themselves as reports have done, and the
report of the shipped logs, go through the one module that derives what is shown.
"""

import copy
import math
import re

import pytest
from reports import COGGING, LAW, empty, good, robot

from frictionjoint.diagnose.outcome import _alike_hint
from frictionjoint.effects.catalogue import title
from frictionjoint.report.joints import joint_content
from frictionjoint.report.numbers import result_estimates
from frictionjoint.report.robot_summary import RobotSummary
from frictionjoint.report.summary import Summary
from frictionjoint.report.text import summary_text
from frictionjoint.report.wording import percentage, three

WEAK = COGGING["evidence"]
SERVO = {"fit": 0.01, "held_out": 0.012}

REPORTS = {
    "good": good(),
    "noise above the error": good(noise_floor=0.027),
    "noise far above the error": good(noise_floor=0.3),
    "noise of a millionth": good(noise_floor=1e-6),
    "no noise": good(noise_floor=None),
    "empty": empty(),
    "empty at the noise": empty(noise_floor=0.2),
    "empty, mostly at rest": empty(noise_floor=0.2, at_rest=0.76),
    "too short": empty(verdict="too-short-to-tell"),
    "suspected": empty(
        candidates__0__rows=[{"effect": "dwell-time", "gain": 0.28, "p_value": 0.001}]
    ),
    "suspected, but rejected": empty(
        candidates__0__rows=[{"effect": "dwell-time", "gain": 0.9, "p_value": 0.001}]
    ),
    "below the threshold": good(
        added__0__evidence=WEAK | {"held_out_gain": 0.207, "p_value": 0.94}
    ),
    "not even its sign is known": good(
        added__0__evidence=COGGING["evidence"] | {"size_is_open": True}
    ),
    "runner-up ahead": good(
        added__0__evidence=WEAK | {"margin": -0.02},
        candidates__0__rows=[
            {"effect": "gravity-error", "gain": 0.92, "p_value": 0.001},
            {"effect": "position-periodic", "gain": 0.9, "p_value": 0.001},
        ],
    ),
    "tie": good(added__0__evidence=WEAK | {"ties": ["spring"]}),
    "held-out logs contradict": good(
        after__torque_rms={"fit": 0.02, "held_out": 0.3},
        intervals__torque_rms={"before": [0.2, 0.25], "after": [0.28, 0.33]},
        log_errors=[
            {"name": "a", "role": "fit", "before": 0.2, "after": 0.02},
            {"name": "b", "role": "held-out", "before": 0.2, "after": 0.29},
            {"name": "c", "role": "held-out", "before": 0.24, "after": 0.31},
        ],
        verdict="partly-explained",
    ),
    "no motor": good(
        drive__rms={stage: {"fit": 1e-9, "held_out": 1e-9} for stage in ("before", "after")}
    ),
    "another law": good(after__law="static"),
    "unexplained": empty(
        verdict="partly-explained", unexplained=[{"variable": "load", "share": 0.4}]
    ),
    "servo": good(
        before__closed_loop_mae={"fit": 0.05, "held_out": 0.06},
        after__closed_loop_mae=SERVO,
        drive__source="controller",
    ),
    "refined": good(
        refined={
            "taken": True,
            "parameters": {n: x | {"value": 1.1 * x["value"]} for n, x in LAW.items()},
        },
        model={n: 1.1 * x["value"] for n, x in LAW.items() if n != "stiffness"} | {"effects": []},
    ),
    "amperes": good(units={"torque": "A", "position": "rad"}),
}
ROBOT = robot(shoulder=good(), elbow=REPORTS["runner-up ahead"], wrist=REPORTS["amperes"])
REPORTS |= {f"robot, {name}": joint_content(ROBOT, name) for name in ROBOT["joints"]}


@pytest.fixture(params=[*REPORTS, "shipped logs"])
def content(request):
    if request.param == "shipped logs":
        return request.getfixturevalue("demo_report").to_dict()
    return REPORTS[request.param]


def errors_shown(s):
    """Every error of the drive that is shown."""
    rows = [x for e in s.errors if e.unit == s.units[0] for x in e.values.values()]
    rows += [x for log in s.logs for x in (log["before"], log["after"])]
    return [x for x in rows if x is not None]


def line(s, label):
    return dict(s.verdict_lines).get(label, "")


def test_no_error_is_below_the_noise(content):
    s = Summary(content)
    if s.noise_level is None:
        assert "not stated: its estimate" in s.noise or "cannot be determined" in s.noise
        assert "noise of the instruments" not in line(s, "Missing")
        return
    assert s.noise_level <= min(errors_shown(s))
    assert three(s.noise_level) in s.noise
    told = re.search(r"([\d.e+]+) times the noise", line(s, "Missing"))
    if told:
        after = next(e for e in s.errors if e.unit == s.units[0] and e.stage == "after")
        ratio = after.values[s.role] / s.noise_level
        assert float(told[1]) == pytest.approx(ratio, rel=0.06)


def test_what_is_called_missing_is_supported(content):
    s = Summary(content)
    for effect in s.effects:
        named = effect.title in line(s, "Missing").lower().split("; also in the model")[0]
        if effect.p_value > content["thresholds"]["p_value"]:
            assert not named or "not confirmed" in line(s, "Missing").lower()
            assert effect.doubt
        short = effect.gain < content["thresholds"]["gain"]
        assert short <= (effect.title in s.threshold)


def test_no_candidate_is_ahead_of_the_one_that_was_added(content):
    s = Summary(content)
    for step in s.steps:
        added = [c for c in step if c.outcome == "added"]
        assert len(added) <= 1
        for own in added:
            ahead = [c for c in step if c.gain >= own.gain and c is not own]
            assert all(c.outcome == "could also be" for c in ahead)
    for effect in s.effects:
        assert effect.title not in effect.rivals
        if effect.rivals:
            assert all(name in line(s, "Could also be").lower() for name in effect.rivals)
        if effect.next_best:
            assert effect.next_best[1] <= effect.gain


def test_the_headline_is_the_table(content):
    s = Summary(content)
    text = line(s, "Error before and after") or line(s, "Error")
    for row in s.errors:
        value = row.values[s.role]
        if value is not None and not row.quantity.endswith(", rms"):
            assert three(value) in text
        assert row.interval is None or row.interval[0] <= value <= row.interval[1]
    assert s.position_first == text.lower().startswith("position in closed loop")


def test_the_headline_lies_between_its_logs(content):
    s = Summary(content)
    role = s.role.replace("_", "-")
    for row in s.errors:
        own = [x[row.stage] for x in s.logs if x["role"] == role]
        if row.unit == s.units[0] and None not in own:
            assert min(own) * (1 - 1e-9) <= row.values[s.role] <= max(own) * (1 + 1e-9)


def test_a_fraction_is_one_of_the_drive_of_the_same_logs(content):
    s = Summary(content)
    for row in s.errors:
        for role, text in row.fractions.items():
            whole = content["drive"]["rms"][row.stage][role]
            assert text == percentage(row.values[role], whole)
            assert row.values[role] < 10.0 * whole


def test_an_effect_has_one_name(content):
    s = Summary(content)
    for effect in s.effects:
        assert effect.title == title(effect.name)
        chosen = [c.title for step in s.steps for c in step if c.outcome == "added"]
        assert not chosen or effect.title in chosen
        assert effect.title in summary_text(content).lower()
        assert not s.parameters or effect.title in [x.name for x in s.parameters]


def test_the_card_is_what_the_model_contains(content):
    s = Summary(content)
    inside = {x.name: x.text for x in s.parameters}
    for number in s.friction:
        if inside and number.name in inside:
            assert number.text == inside[number.name]
    for name, x in result_estimates(content).items():
        value = content.get("model", {}).get(name)
        assert value is None or math.isclose(value, x.value, rel_tol=1e-6)


def test_a_note_is_said_once_and_the_terminal_has_at_most_five(content):
    notes = [f"log{i}: a gap of {i} s" for i in range(4)] + ["one", "one"]
    notes += [f"thing {'x' * i} to know" for i in range(8)]
    s = Summary(content | {"notes": notes})
    assert len(set(s.notes)) == len(s.notes) == 10
    told = summary_text(content | {"notes": notes}).splitlines()
    assert sum(x.startswith("* ") for x in told) == 6  # with the line that counts the rest


def test_a_verdict_agrees_with_what_was_added(content):
    s = Summary(content)
    missing = line(s, "Missing").lower()
    if s.verdict in ("no-effect-found", "too-short-to-tell"):
        assert not s.effects
        claims_all_found = "nothing was found" in missing
        if claims_all_found:
            assert s.noise_level is not None
            assert not s.suspected
    if s.effects and "rises" not in missing:
        assert all(e.title in missing for e in s.effects)


def test_a_statement_on_logs_mostly_at_rest_is_on_the_moving_part():
    assert "24% of the samples" in line(Summary(REPORTS["empty, mostly at rest"]), "Missing")


def test_an_implausible_noise_is_withheld_with_its_reason():
    assert "cannot be determined" in Summary(REPORTS["noise far above the error"]).noise
    assert "less than instruments resolve" in Summary(REPORTS["noise of a millionth"]).noise
    # within the error of the estimate the noise is at most what remains
    assert Summary(REPORTS["noise above the error"]).noise_level == 0.02


def test_a_candidate_above_the_threshold_says_why_it_was_not_added():
    (row,) = REPORTS["suspected, but rejected"]["candidates"][0]["rows"]
    shares = {0.0: "not once the friction law", 0.95: "a dependence that is no known effect"}
    for share, why in shares.items():
        rest = [{"variable": "time", "share": share}] if share else []
        content = REPORTS["suspected, but rejected"] | {"unexplained": rest}
        ((own, *_),) = Summary(content).steps
        assert own.gain == row["gain"]
        assert own.outcome.startswith(f"not added: {why}")


def test_an_effect_that_hardly_reduces_the_error_is_not_called_missing():
    content = good(added__0__evidence=WEAK | {"held_out_gain": 0.007, "p_value": 0.001})
    said = line(Summary(content), "Missing")
    assert said.startswith("Nothing for certain; also in the model")
    assert "by 0.7% only" in said


def test_causes_that_logs_do_not_tell_apart_are_no_names_of_logs():
    said = Summary(good(notes=[_alike_hint("time", x) for x in ("velocity", "load")])).notes
    assert len(said) == 2


def test_a_robot_has_the_figures_of_its_joints():
    s = RobotSummary(ROBOT)
    for row in s.rows:
        own = Summary(joint_content(ROBOT, row.joint))
        shown = [e.fractions[own.role] for e in own.errors if e.unit == own.units[0]][:2]
        assert row.torque == " → ".join(shown)
        for name, text in zip(("Fc", "Fs", "sigma2", "stiffness"), row.friction, strict=True):
            assert text == next(x.qualified for x in own.friction if x.name == name)
    before = ROBOT["before"]["torque_percent"]["held_out"]
    assert percentage(before, 100.0) in line(s, "Error before and after")
    assert "hand" in line(s, "Missing")
    assert "rotor inertia of elbow" in line(s, "Could also be").lower()
    told = summary_text(ROBOT).splitlines()
    assert sum(x.startswith("* ") for x in told) <= 6


def test_what_a_robot_does_not_call_missing_has_no_rivals_and_is_said_apart():
    content = copy.deepcopy(ROBOT)
    name, own = next((n, x) for n, x in content["joints"].items() if x["added"])
    own["added"][0]["evidence"] |= {"ties": ["spring"]}
    assert f"in {name}, {title('spring')} instead" in line(RobotSummary(content), "Could also be")
    own["added"][0]["evidence"] |= {"p_value": 0.9}
    s = RobotSummary(content)
    assert title("spring") not in line(s, "Could also be")
    (row,) = (x for x in s.rows if x.joint == name)
    missing, unsure = row.effects.split("; in the model, but not supported: ")
    assert "p = 0.9" in unsure
    assert "p = 0.9" not in missing


def test_what_held_out_logs_leave_to_chance_is_said():
    pairs = {"before": [0.02, 0.25], "after": [0.02, 0.24]}
    replay = {"before": [0.001, 0.04], "after": [0.001, 0.04]}
    s = Summary(good(intervals={"torque_rms": pairs, "replay_rms": replay}))
    assert "no more than chance" in line(s, "Missing")
    assert "no more than chance" not in line(Summary(good()), "Missing")
