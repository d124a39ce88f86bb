"""The report page holds every part a reader needs, for a find, a miss and nothing at all."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from frictionjoint.cli.terminal import show_estimates, show_report
from frictionjoint.diagnose.advice import what_to_record
from frictionjoint.effects.catalogue import CATALOGUE, DRIVE_EFFECTS
from frictionjoint.identify.result import Estimate
from frictionjoint.law.presliding import presliding_distance
from frictionjoint.report import charts, turning_points, wording
from frictionjoint.report.joint_report import Rms
from frictionjoint.report.page import render
from frictionjoint.report.write import made

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


def test_nothing_is_loaded_from_elsewhere(page):
    own = page.replace("http://www.w3.org/", "")
    assert not re.search(r"""(?:src|href|url)\s*[=(]\s*["']?(?:https?:)?//""", own)
    assert not re.search("<link|@import|<script src|fetch\\(|XMLHttp", own)


def test_a_page_is_small(page):
    assert len(page.encode()) < 2e6


def test_no_cell_of_a_table_is_empty(page):
    cells = re.findall(r"<td[^>]*>(.*?)</td>", page, flags=re.DOTALL)
    assert len(cells) > 50
    assert all(re.sub("<[^>]*>", "", cell).strip() for cell in cells)


def test_the_data_of_every_chart_can_be_read(page):
    texts = re.findall(r'<script type="application/json">(.*?)</script>', page, re.DOTALL)
    assert len(texts) >= 8
    for text in texts:
        for series in json.loads(text)["series"]:
            assert len(series["x"]) == len(series["y"]) > 0


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
    assert re.search(r"^Record next: +Record this$", told, re.MULTILINE)
    assert re.search(r"Coulomb friction: +1\.\d+\u00a0±", told)


def test_a_page_without_a_find_shows_one_model(nothing):
    page = render(nothing, content(nothing))
    assert 'class="verdict no-effect-found"' in page
    assert "No effect was found" in page
    assert '"name":"after"' not in page
    assert "Nothing was added" in page


def test_a_page_has_no_presliding_where_the_logs_show_none(found):
    final = found.final | {"stiffness": Estimate(5000.0, None, "N m/rad")}
    page = render(replace(found, final=final), content(replace(found, final=final)))
    assert "displacement since the turn" not in page
    assert "assumed" in page


def test_without_held_out_log_the_page_speaks_of_fitted_ones(found):
    fit_only = replace(
        found,
        after_torque=replace(found.after_torque, held_out=None),
        before_torque=replace(found.before_torque, held_out=None),
    )
    assert "(fitted logs" in fit_only.summary()
    assert "Intervals: fitted logs" in render(fit_only, content(fit_only))


def test_the_verdict_owns_up(found, nothing):
    assert re.search(
        r"Torque 0\.22\d? → 0\.0[12]\d+\u00a0N m \(12% → [01]\.\d+%\)", found.summary()
    )
    # with the intervals before and after upon each other, no fall is claimed
    wide = replace(found, torque_interval=((0.1, 0.3), (0.01, 0.12)))
    assert "which may be chance" in wide.summary()
    # what the held-out logs contradict is not claimed
    worse = replace(found, after_torque=Rms(0.03, 0.3), torque_interval=((0.2, 0.25), (0.28, 0.33)))
    assert "held-out logs contradict it" in worse.summary()
    assert "which is worse" in worse.summary()
    hardly = replace(worse, torque_interval=((0.2, 0.25), (0.24, 0.33)))
    assert "held-out logs do not confirm it" in hardly.summary()
    astray = replace(
        found, after_replay=Rms(0.03, 0.035), replay_interval=((0.01, 0.033), (0.034, 0.04))
    )
    assert re.search(r"position .*\u00a0rad, which is worse", astray.summary())
    # a residual far above the noise is not "nothing missing"
    assert "No effect was found" in nothing.summary()
    quiet = replace(nothing, noise_floor=nothing.before_torque.held_out)
    assert "Nothing that these logs can show" in quiet.summary()
    missed = replace(nothing, verdict="partly-explained", unexplained=(("arm.velocity", 0.9),))
    assert "depends on velocity of 'arm' (90%)" in missed.summary()


def test_an_error_is_a_part_of_the_drive_of_its_own_model(found):
    """An effect of the drive cuts a torque that nobody measured, and the error before is of all."""
    curves = tuple(replace(c, given=2.0 * c.measured) for c in found.curves)
    of_controller = replace(found, curves=curves, reconstructed=True)
    assert re.search(r"\(6(?:\.\d)?% → [01]\.\d+%\)", of_controller.summary())
    page = render(of_controller, content(of_controller))
    assert "per cent of the controller’s torque" in page
    assert "measured torque" not in page.partition("<h2>")[0]


def test_a_slide_has_newtons_and_metres(found):
    slide = replace(found, slide=True, units=("N", "m"))
    page = render(slide, content(slide))
    assert '"x_label":"velocity, m/s"' in page
    assert re.search(r"force after</td><td[^>]*>[\d.]+\u00a0N \(", page)
    assert re.search(r"position after</td><td[^>]*>[\d.]+\u00a0m<", page)
    assert "every 0.4" in page  # 14 waves per radian are one every 0.449 m


def test_a_plot_has_friction_torque_and_position(found):
    labels = [axes.get_ylabel() for axes in found.plot().axes]
    assert labels == ["friction, N m", "torque, N m", "N m", "position, rad", "rad"]


def test_a_report_says_in_a_line_what_it_is(found):
    assert repr(found) == "Report(joint='joint', verdict='explained', added: position-periodic)"


def test_the_worst_stretch_is_one_of_the_held_out_log(found):
    stretch = charts.worst_stretch(found)
    assert stretch.curve.role == "held-out"
    error = (stretch.curve.measured - stretch.curve.after)[stretch.window]
    assert np.sqrt(np.mean(error**2)) > 0.9 * found.after_torque.held_out


def test_data_of_the_friction_curve_lie_on_the_law(found):
    data, law = charts.friction_speed(found).series
    off = data.y - np.interp(data.x, law.x, law.y)
    sliding = np.abs(data.x) > 0.2
    assert np.sqrt(np.mean(off[sliding] ** 2)) < 3.0 * found.after_torque.fit


def test_curves_leave_the_residuals_of_the_table(found):
    for stage, rms in (("before", found.before_torque), ("after", found.after_torque)):
        for role, value in (("fit", rms.fit), ("held-out", rms.held_out)):
            own = [c for c in found.curves if c.role == role]
            e = [(c.measured - getattr(c, stage))[c.in_motion] for c in own]
            assert np.sqrt(np.mean(np.concatenate(e) ** 2)) == pytest.approx(value)


def test_neighbours_are_folded_unless_they_explain_something(found):
    curves = tuple(
        replace(c, quantities=c.quantities | {"a.velocity": c.velocity, "b.velocity": c.position})
        for c in found.curves
    )
    arm = replace(found, curves=curves, unexplained=(("b.velocity", 0.3),))
    first, folded = render(arm, content(arm)).split("<details><summary>Other joints")
    assert "Error against velocity of &#39;b&#39;" in first
    assert "Error against velocity of &#39;a&#39;" in folded


def test_intervals_hold_their_rms(found):
    for pair, stages in (
        (found.torque_interval, (found.before_torque, found.after_torque)),
        (found.replay_interval, (found.before_replay, found.after_replay)),
    ):
        for (low, high), rms in zip(pair, stages, strict=True):
            assert low < rms.held_out < high


def test_an_interval_of_next_to_no_samples_is_not_stated(found):
    none = replace(found, torque_interval=None)
    assert ">not stated<" in render(none, content(none))


def test_law_and_rest_of_the_model_make_up_what_is_measured_behind_a_turn(found):
    # the law's torque runs from one Coulomb level to the other behind a turn
    curve = found.curves[0]
    windows = turning_points.turns(curve, 6.0 * presliding_distance(found.laws[1], 0.9))
    assert windows
    law = found.laws[1]
    for w in windows:
        sign = np.sign(curve.position[w.stop - 1] - curve.position[w.start])
        assert sign * curve.friction[w.stop - 1] > 0.9 * law.Fc_pos
        assert (np.diff(curve.position[w]) * sign > 0.0).all()


def test_a_gap_or_a_pause_is_no_turn():
    q = np.concatenate([np.linspace(0, 1, 50), np.full(20, 1.0), np.linspace(1, 2, 50)[1:]])
    zero = np.zeros_like(q)
    t = 0.01 * np.arange(len(q))
    make = found_curve(t, q, zero)
    assert turning_points.turns(make, 0.1) == []
    back = np.concatenate([np.linspace(0, 1, 50), np.linspace(1, 0, 50)[1:]])
    t = 0.01 * np.arange(len(back))
    assert len(turning_points.turns(found_curve(t, back, 0 * back), 0.1)) == 1
    t[50:] += 1.0
    assert turning_points.turns(found_curve(t, back, 0 * back), 0.1) == []


def found_curve(t, q, zero):
    from frictionjoint.report.joint_report import Curve

    return Curve("log", "fit", t, q, *(zero,) * 6, zero == 0.0, {})


def test_advice_names_what_these_logs_leave_open():
    effect = next(e for e in CATALOGUE if e.name == "spring")
    law = {
        "Fs_pos": Estimate(1.0, 0.01, "N m"),
        "Vs_pos": Estimate(0.1, 0.09, "rad/s"),
        "stiffness": Estimate(1e4, None, "N m/rad"),
    }
    tie, unexplained, velocity, presliding_motion, held = what_to_record(
        [(effect, "gravity-error")], [], [("load", 0.3)], law, held_out=False
    )
    assert "spring, cable or balancer from payload or wrong mass" in tie
    assert effect.separating_motion in tie
    assert "load: one motion with two payloads" in unexplained
    assert velocity.startswith("To determine Stribeck velocity:")
    assert presliding_motion.startswith("To determine presliding stiffness:")
    assert "--held-out" in held
    sure = {"Fs_pos": Estimate(1.0, 0.01, "N m")}
    assert what_to_record([], [], [], sure, held_out=True) == ()
    of_error, of_output = (e for e in DRIVE_EFFECTS if e.name == "duty-drop")
    (form,) = what_to_record([], [(of_error, of_output)], [], sure, held_out=True)
    assert of_error.form in form
    assert of_output.form in form
    assert "two gains" in form


@pytest.mark.parametrize(
    ("value", "stderr", "text"),
    [
        (1.24912, 0.0161, "1.249 ± 0.016"),
        (-0.231672, 0.00108, "−0.2317 ± 0.0011"),
        (5605.8, 64.9, "5606 ± 65"),
        (123456.7, 1234.0, "123500 ± 1200"),
        (4.0, None, "4 (fixed)"),
        (0.0, 0.7, "0.00 ± 0.70"),
        (1.0004, 0.016, "1.000 ± 0.016"),
        (0.00012345, 0.00001, "0.000123 ± 0.000010"),
        (1.4e-13, 0.0066, "0.0000 ± 0.0066"),
        (-2e-5, 0.0036, "0.0000 ± 0.0036"),
    ],
)
def test_values_stand_to_the_second_figure_of_their_error(value, stderr, text):
    assert wording.value(Estimate(value, stderr, "N m"), spread=True) == text.replace(
        " ± ", "\u00a0±\u00a0"
    )


def test_the_terminal_states_values_as_far_as_their_errors_go(capsys):
    rows = {
        "Fc_pos": Estimate(1.02345, 0.0123, "N m"),
        "Fc_neg": Estimate(1.02345, 0.0123, "N m"),
        "stiffness": Estimate(949.97, 3300.0, "N m/rad"),
        "n": Estimate(1.0, None, "1"),
    }
    show_estimates(list(rows.items()))
    lines = [
        " ".join(line.replace("│", " ").split()) for line in capsys.readouterr().out.split("\n")
    ]
    assert "Coulomb friction Fc 1.023 ± 0.012 N m" in lines
    assert "presliding stiffness stiffness 900 ± 3300 N m/rad (not determined)" in lines
    assert "exponent of the transition to sliding n 1 (fixed)" in lines
