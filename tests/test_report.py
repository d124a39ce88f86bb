"""The report page holds every part a reader needs, for a find, a miss and nothing at all."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.cli.terminal import show_estimates, show_report
from frictionjoint.diagnose.advice import what_to_record
from frictionjoint.diagnose.report_data import Rms
from frictionjoint.effects.catalogue import CATALOGUE, DRIVE_EFFECTS
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.report import presliding, wording
from frictionjoint.report.page import errors, render

sentence = wording.sentence
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
    )


PARTS = {
    "verdict": 'class="verdict explained"',
    "before and after": "Error before and after",
    "interval": "95% interval",
    "per cent of the torque": "of the measured torque)",
    "name for people": "cogging (position-periodic)",
    "why": "What was added, and why",
    "cause": "cogging, current ripple",
    "ranking": "cross-validated gain",
    "runner-up": ">runner-up</td>",
    "over time": "time, s",
    "velocity plane": ">velocity, rad/s</text>",
    "position plane": "position, rad",
    "presliding loops": "torque of the law, N m",
    "turning points": "displacement since the turning point, rad",
    "residual": "mean, before",
    "unexplained": "What is still unexplained",
    "next": "What to record next",
    "parameters": "breakaway, positive motion",
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


@pytest.fixture(scope="module")
def page(demo_report):
    """The page of the shipped logs."""
    return render(demo_report, COMMAND)


@pytest.mark.parametrize("part", PARTS)
def test_each_part_is_there(page, part):
    assert PARTS[part] in page


def test_nothing_is_loaded_from_elsewhere(page):
    own = page.replace("http://www.w3.org/", "")
    assert not re.search(r"""(?:src|href|url)\s*[=(]\s*["']?(?:https?:)?//""", own)
    assert not re.search("<link|@import|<script", own)


def test_a_page_is_small(page):
    assert len(page.encode()) < 2e6


def test_no_cell_of_a_table_is_empty(page):
    cells = re.findall(r"<td[^>]*>(.*?)</td>", page, flags=re.DOTALL)
    assert len(cells) > 50
    assert all(re.sub("<[^>]*>", "", cell).strip() for cell in cells)
    assert not re.search(r'data-label="unit">1<', page)


def test_identifiers_of_pictures_are_unique(page):
    names = re.findall(r' id="([^"]+)"', page)
    assert names
    assert len(names) == len(set(names))


def test_what_a_log_is_called_cannot_become_markup(found):
    log = replace(found.logs[0], name="<script>alert(1)</script>")
    page = render(replace(found, logs=(log, *found.logs[1:])), "<b>x</b>")
    assert "<script>alert" not in page
    assert "<b>x</b>" not in page


def test_the_terminal_tells_the_same(found, capsys):
    show_report(replace(found, notes=("a thing [to] know",), proposals=("record this",)))
    told = capsys.readouterr().out
    assert wording.interval(found.torque_interval[1]) in told
    assert sentence(found) in told
    assert "* a thing [to] know\n* record this\n" in told


def test_notes_are_shown(found):
    assert "a thing to know" in render(replace(found, notes=("a thing to know",)), COMMAND)


def test_a_page_without_a_find_shows_one_model(nothing):
    page = render(nothing, COMMAND)
    assert 'class="verdict no-effect-found"' in page
    assert "law alone" in page
    assert ">after</text>" not in page
    assert "no effect of the catalogue" in page


def test_without_held_out_log_the_page_speaks_of_fitted_ones(found):
    fit_only = replace(
        found,
        after_torque=replace(found.after_torque, held_out=None),
        before_torque=replace(found.before_torque, held_out=None),
    )
    assert "on fitted data" in wording.sentence(fit_only)
    assert "The intervals are of the fitted logs" in render(fit_only, COMMAND)


def test_the_sentence_owns_up(found, nothing):
    assert re.search(
        r"falls by [89]\d%, from 0\.22\d? to 0\.0[12]\d+ N m "
        r"\(12% to [01]\.\d+% of the measured torque\) "
        "on held-out data",
        sentence(found),
    )
    # with the intervals before and after upon each other, no fall is claimed
    touching = replace(found, torque_interval=((0.1, 0.3), (0.05, 0.12)))
    assert "may be chance" in sentence(touching)
    assert "falls" not in sentence(touching)
    # what the held-out logs contradict is not claimed
    worse = replace(found, after_torque=Rms(0.03, 0.3), torque_interval=((0.2, 0.25), (0.28, 0.33)))
    assert re.search(
        r"held-out ones contradict it: with it the error rises from 0\.22\d? to 0\.3 N m .*"
        "on held-out data, which is no gain",
        sentence(worse),
    )
    assert "chance" not in sentence(worse)
    hardly = replace(worse, torque_interval=((0.2, 0.25), (0.24, 0.33)))
    assert "do not confirm it: with it the error goes from 0.22" in sentence(hardly)
    assert "may be chance" in sentence(hardly)
    astray = replace(found, replay_interval=((0.01, 0.02), (0.03, 0.04)))
    assert sentence(astray).endswith("further off than before.")
    assert "further off" not in sentence(found)
    # a residual far above the noise is not "nothing missing"
    assert "No effect was found" in sentence(nothing)
    assert "times the noise of the instruments" in sentence(nothing)
    quiet = replace(nothing, noise_floor=nothing.before_torque.held_out)
    assert "Nothing is missing" in sentence(quiet)
    missed = replace(nothing, verdict="partly-explained", unexplained=(("arm.velocity", 0.9),))
    assert "depends on velocity of 'arm'" in sentence(missed)


def test_an_error_is_a_part_of_the_drive_of_its_own_model(found):
    """An effect of the drive cuts a torque that nobody measured, and the error before is of all."""
    curves = tuple(replace(c, given=2.0 * c.measured) for c in found.curves)
    made = replace(found, curves=curves, reconstructed=True)
    assert re.search(r"\(6(?:\.\d)?% to [01]\.\d+% of the controller's torque\)", sentence(made))
    page = render(made, COMMAND)
    assert "measured torque" not in page
    cells = r"torque {}</td><td[^>]*>[^<]*</td><td[^>]*>[\d.]+\u00a0N m \({}%\)"
    assert re.search(cells.format("before", r"6(?:\.\d)?"), page)
    assert re.search(cells.format("after", r"[01]\.\d+"), page)


def test_over_an_unknown_gain_of_the_controller_no_current_is_spoken_of(found, capsys):
    over = replace(found, units=("rad", "rad"), reconstructed=True)
    assert "rad (12% to " in sentence(over)
    assert "of the controller's torque over kp)" in sentence(over)
    show_report(over)
    assert "torque over kp rms" in capsys.readouterr().out


def test_the_terminal_shows_how_far_off_whole_logs_are_in_closed_loop(found, capsys):
    show_report(found)
    assert "closed loop" not in capsys.readouterr().out
    loops = tuple(SimpleNamespace(mae=Rms(*pair)) for pair in ((0.0738, 0.0476), (0.0192, 0.0339)))
    show_report(replace(found, closed_loops=loops))
    told = capsys.readouterr().out.replace("│", " ").splitlines()
    assert any("position in closed loop, mean absolute error" in line for line in told)
    rows = [line.split() for line in told]
    assert ["before", "0.0738", "rad", "0.0476", "rad"] in rows
    assert ["after", "0.0192", "rad", "0.0339", "rad"] in rows


def test_a_slide_has_newtons_and_metres(found):
    page = render(replace(found, slide=True, units=("N", "m")), COMMAND)
    assert ">velocity, m/s</text>" in page
    assert re.search(r"force after</td><td[^>]*>[\d.]+\u00a0N \(", page)
    assert re.search(r"position after</td><td[^>]*>[\d.]+\u00a0m<", page)


def test_several_effects_are_listed_without_their_causes(found):
    two = replace(found, added=(found.added[0], replace(found.added[0], effect="spring")))
    both = "lacked cogging (position-periodic) and spring, cable or balancer (spring)"
    assert f"{both}: with them the error falls" in sentence(two)
    lugre = forms_of("lugre")[0].grid(1.0, 1.0)[0].parameters(1.0, 0.1)
    text = sentence(replace(two, laws=(two.laws[0], lugre)))
    law = "and the friction law lugre in place of integrated"
    assert f"{both}: with them, {law}, the error falls" in text


def test_a_tie_is_said_with_the_effect_that_is_named(found):
    step, tie = found.added[0], "which these logs cannot distinguish from torque-gain)"
    for effect, said in (
        ("spring", f"spring, cable or balancer (spring, {tie}"),
        ("end-stop", f"end stop ({tie}"),
    ):
        tied = replace(step, effect=effect, evidence=replace(step.evidence, ties=("torque-gain",)))
        assert f"lacked {said}: with it" in sentence(replace(found, added=(tied,)))


def test_every_look_at_the_candidates_is_drawn(found):
    (first,) = found.rankings
    looks = (first, replace(first, chosen=first.rows[1][0], runner_up=None))
    page = render(replace(found, rankings=looks), COMMAND)
    assert "The candidates, step 2" in page
    assert page.count(">added</td>") == 2


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
    first, folded = render(arm, COMMAND).split("<details>")
    assert "velocity of 'b'" in first
    assert "velocity of 'a'" in folded
    assert "<details>" not in render(found, COMMAND)


def test_intervals_hold_their_rms(found):
    for pair, stages in (
        (found.torque_interval, (found.before_torque, found.after_torque)),
        (found.replay_interval, (found.before_replay, found.after_replay)),
    ):
        for (low, high), rms in zip(pair, stages, strict=True):
            assert low < rms.held_out < high


def test_an_interval_of_next_to_no_samples_is_not_stated(found):
    none = replace(found, torque_interval=None)
    assert "not stated" in {row[3] for row in errors(none)}
    assert "may be chance" in sentence(none)


def test_law_and_rest_of_the_model_make_up_what_is_measured_behind_a_turn(found):
    # the law's torque runs from one Coulomb level to the other behind a turn
    curve = found.curves[0]
    windows = presliding.turns(curve, 6.0 * presliding.length(found.laws[1]))
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
    assert presliding.turns(make, 0.1) == []
    back = np.concatenate([np.linspace(0, 1, 50), np.linspace(1, 0, 50)[1:]])
    t = 0.01 * np.arange(len(back))
    assert len(presliding.turns(found_curve(t, back, 0 * back), 0.1)) == 1
    t[50:] += 1.0
    assert presliding.turns(found_curve(t, back, 0 * back), 0.1) == []


def found_curve(t, q, zero):
    from frictionjoint.diagnose.report_data import Curve

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
    assert "spring from gravity-error" in tie
    assert effect.separating_motion in tie
    assert "load: one motion with two payloads" in unexplained
    assert velocity.startswith("To determine Vs:")
    assert presliding_motion.startswith("To determine stiffness:")
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
        (4.0, None, "4 ± –"),
        (0.0, 0.7, "0.00 ± 0.70"),
        (1.0004, 0.016, "1.000 ± 0.016"),
        (0.00012345, 0.00001, "0.000123 ± 0.000010"),
        (1.4e-13, 0.0066, "0.0000 ± 0.0066"),
        (-2e-5, 0.0036, "0.0000 ± 0.0036"),
    ],
)
def test_values_stand_to_the_second_figure_of_their_error(value, stderr, text):
    assert wording.value(Estimate(value, stderr, "N m"), spread=True) == text.replace(" ", "\u00a0")


def test_the_terminal_states_values_as_far_as_their_errors_go(capsys):
    rows = {
        "Fc_pos": Estimate(1.02345, 0.0123, "N m"),
        "stiffness": Estimate(949.97, 3300.0, "N m/rad"),
        "n": Estimate(1.0, None, "1"),
    }
    show_estimates(list(rows.items()))
    cells = [line.split() for line in capsys.readouterr().out.replace("│", " ").splitlines()]
    assert ["Fc_pos", "1.023", "0.0123", "N", "m"] in cells
    assert ["stiffness", "900", "3300", "N", "m/rad"] in cells
    assert ["n", "1", "–", "none"] in cells
