"""The report page holds every part a reader needs, for a find, a miss and nothing at all."""

import re
from dataclasses import replace

import numpy as np
import pytest

from frictionjoint.cli.terminal import show_report
from frictionjoint.diagnose.advice import what_to_record
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.drive import DRIVE_EFFECTS
from frictionjoint.identify.result import Estimate
from frictionjoint.report import wording
from frictionjoint.report.folder import made
from frictionjoint.report.joint_report import Rms
from frictionjoint.report.numbers import status_of
from frictionjoint.report.page import render

COMMAND = "frictionjoint close-loop 'my log.csv' --out out"


@pytest.fixture
def found(demo_report):
    return demo_report


@pytest.fixture
def nothing(found):
    """The same report as it would be had nothing been found."""
    laws, curves = (found.laws[0],) * 2, tuple(replace(c, after=c.before) for c in found.curves)
    return replace(
        found,
        added=(),
        verdict="no-effect-found",
        after_torque=found.before_torque,
        torque_interval=(found.torque_interval[0],) * 2,
        laws=laws,
        curves=curves,
        rankings=tuple(replace(x, chosen=None, rows=x.rows[1:]) for x in found.rankings),
    )


PARTS = {
    "verdict": 'class="verdict explained"',
    "missing": "<dt>Missing</dt><dd>Cogging.</dd>",
    "before and after": "<dt>Error before and after</dt><dd>Torque 0.22",
    "rivals": "<dt>Could also be</dt>",
    "next": "<dt>Record next</dt>",
    "friction": "Coulomb friction <span",
    "friction against speed": ">Friction against speed</figcaption>",
    "over time": '"x_label":"time, s"',
    "simulated position": '"y_label":"position, rad"',
    "error panel": "Error (measured − predicted)",
    "whole log": "<summary>The whole log</summary>",
    "interval": "95% interval",
    "evidence": "reduction of the squared residual",
    "smallest effects": "<td>backlash</td>",
    "other laws": "<td>integrated (used)</td>",
    "cause": "cogging, current ripple",
    "wave": "per turn, phase",
    "error against": "Error against position",
    "presliding": "displacement since the turn, rad",
    "model": "What model.xml contains",
    "errors": "\u00a0±\u00a0",
    "units": "N m s/rad",
    "logs": "multisine",
    "command": "frictionjoint close-loop &#39;my log.csv&#39; --out out",
    "versions": "mujoco 3.",
    "dark": "prefers-color-scheme: dark",
    "print": "@media print",
    "phone": "max-width: 700px",
    "labels on a phone": 'data-label="held-out logs"',
}


def content(report):
    return report.to_dict() | {"made": made(COMMAND, 1.0)}


@pytest.fixture(scope="module")
def page(demo_report):
    """The page of the shipped logs."""
    return render(demo_report, content(demo_report))


@pytest.mark.parametrize("part", PARTS)
def test_each_part_is_there(page, part):
    assert PARTS[part] in page


def test_no_cell_of_a_table_is_empty(page):
    cells = re.findall(r"<td[^>]*>(.*?)</td>", page, flags=re.DOTALL)
    assert len(cells) > 50
    assert all(re.sub("<[^>]*>", "", cell).strip() for cell in cells)


def test_what_a_log_is_called_cannot_become_markup(found):
    log = replace(found.logs[0], name="<script>alert(1)</script>")
    named = replace(found, logs=(log, *found.logs[1:]), joint="</script><b>x</b>")
    page = render(named, named.to_dict() | {"made": made("<b>y</b>", 1.0)})
    assert "<script>alert" not in page
    assert "<b>x</b>" not in page
    assert "<b>y</b>" not in page


def test_the_terminal_prints_the_summary(found, capsys):
    noted = replace(found, notes=("a thing [to] know",), proposals=("record this",))
    show_report(noted)
    told = capsys.readouterr().out
    assert told == noted.summary() + "\n"
    assert "* a thing [to] know\n" in told
    assert re.search(r"^Smallest detectable .*: 0\.\d+ .*\), \.\.\., .*N m \(", told, re.MULTILINE)
    assert re.search(r"^Record next: +Record this$", told, re.MULTILINE)
    assert re.search(r"Coulomb friction: +1\.\d+\u00a0±", told)


def test_samples_at_rest_are_counted_on_the_logs_that_a_note_counts(found):
    curves = [replace(c, in_motion=c.in_motion & (c.role == "fit")) for c in found.curves]
    assert any(c.role != "fit" for c in curves)
    moving = np.concatenate([c.in_motion for c in curves if c.role == "fit"])
    stated = replace(found, curves=tuple(curves)).to_dict()["at_rest"]
    assert stated == pytest.approx(1.0 - moving.mean())


def test_a_page_without_a_find_shows_one_model(nothing):
    page = render(nothing, content(nothing))
    assert 'class="verdict no-effect-found"' in page
    assert '"name":"after"' not in page
    assert "Nothing was added" in page


def test_without_held_out_log_the_page_speaks_of_fitted_ones(found):
    fit_only = replace(
        found,
        after_torque=replace(found.after_torque, held_out=None),
        before_torque=replace(found.before_torque, held_out=None),
    )
    assert "(fitted logs" in fit_only.summary()
    assert "Intervals: fitted logs" in render(fit_only, content(fit_only))


def test_the_verdict_owns_up(found, nothing):
    fall = r"Torque 0\.22\d? → 0\.0[12]\d+\u00a0N m \(12% → [01]\.\d+%\)"
    assert re.search(fall, found.summary())
    # with the intervals before and after upon each other, no fall is claimed
    wide = replace(found, torque_interval=((0.1, 0.3), (0.01, 0.12)))
    assert "which may be chance" in wide.summary()
    worse = replace(found, after_torque=Rms(0.03, 0.3), torque_interval=((0.2, 0.25), (0.28, 0.33)))
    assert "held-out logs contradict it" in worse.summary()
    assert "which is worse" in worse.summary()
    hardly = replace(worse, torque_interval=((0.2, 0.25), (0.24, 0.33)))
    assert "held-out logs do not confirm it" in hardly.summary()
    moved = Rms(0.03, 0.035), ((0.01, 0.033), (0.034, 0.04))
    astray = replace(found, after_replay=moved[0], replay_interval=moved[1])
    assert re.search(r"position .*\u00a0rad, which is worse", astray.summary())
    assert "What remains is" in nothing.summary()
    apart = replace(nothing, after_torque=Rms(0.01, 0.25)).summary()
    assert "held-out logs is 25 times that on fitted logs" in apart
    quiet = replace(nothing, noise_floor=nothing.before_torque.held_out)
    assert "Nothing was found; the error is close to the noise" in quiet.summary()
    # no noise above an error that remains is stated
    assert replace(nothing, noise_floor=9.0).to_dict()["noise_floor"] is None
    missed = replace(nothing, verdict="partly-explained", unexplained=(("arm.velocity", 0.9),))
    assert "depends on velocity of 'arm' (90%)" in missed.summary()
    assert "which no known effect explains" in missed.summary()


def test_the_headline_says_the_cause_of_a_dependence_and_what_the_effects_explain(found, nothing):
    cause = {"position": "The logged position seems off by up to 0.04 rad, 1 per turn: look."}
    off = {"unexplained": (("position", 0.9),), "unexplained_causes": cause}
    alone = replace(nothing, verdict="partly-explained", notes=tuple(cause.values()), **off)
    assert "No effect of the catalogue. The logged position seems off by up to" in alone.summary()
    assert alone.summary().count("seems off") == 1, "not once more as a note"
    for report in (alone, replace(found, verdict="partly-explained", **off)):
        assert "1 per turn: look (90% of the squared residual)." in report.summary()
        assert "no known effect explains" not in report.summary()
        page = render(report, content(report))
        assert cause["position"] in page
        assert "No known effect explains it" not in page
    rest = replace(found, verdict="partly-explained", unexplained=(("log", 0.4),))
    assert re.search(
        r"The resulting model removes 9\d% of the squared error\. What remains still depends on "
        r"the recording \(40%\), which no known effect explains\.",
        rest.summary(),
    )


def test_a_plot_has_friction_torque_and_position(found):
    labels = [axes.get_ylabel() for axes in found.plot().axes]
    assert labels == ["friction, N m", "torque, N m", "N m", "position, rad", "rad"]


def test_advice_names_what_these_logs_leave_open():
    effect = next(e for e in CATALOGUE if e.name == "spring")
    law = {
        "Fs_pos": Estimate(1.0, 0.01, "N m"),
        "Vs_pos": Estimate(0.1, 0.09, "rad/s"),
        "stiffness": Estimate(1e4, None, "N m/rad"),
    }
    tie, unexplained, velocity, presliding_motion, held = what_to_record(
        [(effect, "gravity-error")], [], {"load": ""}, law, False, {("Vs_pos",): "a sine"}
    )
    assert "spring or cable from payload or wrong mass" in tie
    assert effect.separating_motion in tie
    assert "load: one motion with two payloads" in unexplained
    assert velocity == "a sine"  # a computed motion replaces the general one
    assert presliding_motion.startswith("To determine presliding stiffness:")
    assert "--held-out" in held
    sure = {"Fs_pos": Estimate(1.0, 0.01, "N m")}
    assert what_to_record([], [], {}, sure, True, {}) == ()
    none = {n: Estimate(1e-12, e, "N m") for n, e in (("Fc_pos", 0.1), ("Fs_pos", None))}
    (slow,) = what_to_record([], [], {}, none, True, {})
    assert slow.startswith("To determine Coulomb friction: constant velocities from very slow")
    assert status_of("Fs_pos", none) == "not determined"
    (of_log,) = what_to_record([], [], {"log": ""}, sure, True, {})
    assert of_log.startswith("To find what depends on the recording: the same motion in every log")
    asked = {"wrist.velocity": "", "oil": "", "position": "The encoder is off its centre."}
    of_joint, of_signal, of_encoder = what_to_record([], [], asked, sure, True, {})
    assert "this joint alone" in of_joint
    assert of_signal.endswith("one motion at low and at high values of it.")
    assert of_encoder == (
        "To find what else depends on position: the same motion, once its cause is corrected."
    )
    (of_drive,) = what_to_record([], [], {"torque": "A drive saturates."}, sure, True, {})
    assert "a motion below the torque that saturates" in of_drive
    of_error, of_output = (e for e in DRIVE_EFFECTS if e.name == "duty-drop")
    (form,) = what_to_record([], [(of_error, of_output)], {}, sure, True, {})
    assert of_error.form in form
    assert of_output.form in form
    assert "two gains" in form


@pytest.mark.parametrize(
    ("value", "stderr", "text"),
    [
        (1.24912, 0.0161, "1.249 ± 0.016"),
        (-0.231672, 0.00108, "−0.2317 ± 0.0011"),
        (4.0, None, "4"),
        (0.0, 0.7, "0 ± 0.70"),
        (1.4e-13, 0.0066, "0.0000 ± 0.0066"),
    ],
)
def test_values_stand_to_the_second_figure_of_their_error(value, stderr, text):
    assert wording.value(Estimate(value, stderr, "N m")) == text.replace(" ± ", "\u00a0±\u00a0")


def test_a_report_shows_itself_in_jupyter(demo_report):
    text = replace(demo_report, joint="<b>elbow</b>")._repr_html_()
    assert "<b>Missing:</b> Cogging." in text
    assert "&lt;b&gt;elbow&lt;/b&gt;" in text
    assert text.count("<img") == 1
    assert "<script" not in text
