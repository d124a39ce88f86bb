"""Trials are judged by what their plants hide: names, ties, nothing else, quantities."""

import json
from dataclasses import replace

import numpy as np
import pytest
from judging import Answer, judged, read_answer, tables

from frictionjoint.measured.lowpass import gentle


def answer(accept, variable=()):
    return Answer("family", tuple(accept), accept, tuple(variable), None)


def row(*names, ties=None, **unexplained):
    return {
        "plant": "somewhere/000",
        "added": list(names),
        "ties": [list(t) for t in ties or [()] * len(names)],
        "unexplained": unexplained,
    }


SPRING = {"spring": ("spring",)}
NAMED, ALONE = "named right", "named right, and nothing else"
FIRM = "named right, without a tie's help"


@pytest.mark.parametrize(
    ("found", "named", "alone", "firm"),
    [
        (row("spring"), True, True, True),
        (row("gravity-error", ties=[("spring",)]), True, True, False),
        (row("spring", "inertia-error"), True, False, True),
        (row("inertia-error"), False, False, False),
        (row(), False, False, False),
        (row("spring") | {"error": "LogError: none"}, False, False, False),
    ],
)
def test_one_effect(found, named, alone, firm):
    assert judged(answer(SPRING), found) == {NAMED: named, ALONE: alone, FIRM: firm}


def test_what_the_law_takes_needs_no_name():
    marks = judged(answer({"direction-asymmetry": ("direction-asymmetry", "none")}), row())
    assert marks[NAMED]
    assert marks[ALONE]


def test_two_effects_need_a_finding_each():
    pair = answer({"spring": ("spring",), "torque-bias": ("torque-bias", "spring")})
    both, alone = "both named", "both named, and nothing else"
    assert judged(pair, row("torque-bias", "spring"))[alone]
    assert not judged(pair, row("spring"))[both]
    three = judged(pair, row("torque-bias", "backlash", "spring"))
    assert three[both]
    assert not three[alone]


def test_what_a_kind_brings_with_it_is_right_beside_it():
    mass = answer({"gravity-error": ("gravity-error", "inertia-error")})
    mass = replace(mass, brings=("inertia-error",))
    assert judged(mass, row("gravity-error", "inertia-error"))[ALONE]
    assert not judged(mass, row("gravity-error", "spring"))[ALONE]
    assert not judged(mass, row("spring", "torque-gain"))[NAMED]


def test_nothing_hidden():
    marks = judged(answer({}), row(position=0.2))
    assert marks == {"nothing added": True, "nor a quantity named": False}
    assert not judged(answer({}), row("spring"))["nothing added"]


def test_outside_the_catalogue():
    coupled = answer({"joint-coupling": ("spring",)}, ("other.position",))
    right = {"other.position": 0.3}
    assert judged(coupled, row("spring") | {"unexplained": right})["both"]
    assert not judged(coupled, row("backlash") | {"unexplained": right})["not misnamed"]
    assert not judged(coupled, row(time=0.3))["right quantity reported"]


@pytest.mark.parametrize(
    ("kind", "group", "accept"),
    [
        ("none", "none", {}),
        ("periodic-friction", "one", {"periodic-friction": ("position-periodic",)}),
        ("unknown-time", "outside", {"unknown-time": ()}),
    ],
)
def test_answers_of_one_kind(tmp_path, kind, group, accept):
    (tmp_path / "answer.json").write_text(json.dumps({"kind": kind, "noise": 0.1}))
    read = read_answer(tmp_path)
    assert (read.group, read.accept, read.noise) == (group, accept, 0.1)


def test_what_a_true_model_leaves_is_the_noise_behind_the_filter(tmp_path):
    rng = np.random.default_rng(0)
    n, dt, corner = 2**16, 1e-3, 20.0
    frequency = np.fft.rfftfreq(n, dt)
    spectrum = np.fft.rfft(rng.normal(0.0, 0.3, n)) * gentle(frequency / corner)
    white = Answer("family", (), {}, (), 0.3)
    assert white.left(corner, dt) == pytest.approx(np.fft.irfft(spectrum).std(), rel=0.02)
    coloured = Answer("family", (), {}, (), 0.3, coloured=1.0, corner=0.1)
    assert coloured.left(corner, dt) == pytest.approx(0.3, rel=0.02)


def test_tables_count_by_family():
    text = tables([(answer(SPRING), row("spring")), (answer(SPRING), row("backlash"))])
    assert "family: 2 plants" in text
    assert "1 of 2" in text
    assert "spring: backlash" in text
