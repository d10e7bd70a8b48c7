"""The yielding element against elastic-plastic solids: a crimped wire pulled, a straight wire stretched and bent."""

from __future__ import annotations

import csv
import shutil
from functools import lru_cache

import crimped_pull
import numpy as np
import pytest
import straight_bent
from crimped_wire_solids import DIAMETER, HEIGHT, STEP
from scipy.optimize import brentq

from punchform.arrays import Floats
from punchform.case import PressCase
from punchform.mechanics import chord, fibres
from punchform.mechanics.section import SectionLaw
from punchform.solved import bars_of
from punchform.wire import Element, along, axial_compliance, cosine_line, round_section, straight_line
from punchform.wire.hardening import linear

SUBSTROKES = 4
"""Strokes from one kept pull to the next: levers and thinning follow a stroke late."""
FIBRES = (3, 8)
"""The bundle that a case has when it asks for fibres."""


def answers(path: str) -> dict[str, Floats]:
    """The columns of kept answers."""
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


PULLED = answers(str(crimped_pull.ANSWERS))
BENT = answers(str(straight_bent.ANSWERS))


def wire(height: float, section: tuple[int, int] | None) -> Element:
    """The steel wire of the solids."""
    E, nu = crimped_pull.YOUNGS_MODULUS, crimped_pull.POISSON
    round_wire = round_section(DIAMETER, youngs_modulus=E, poisson=nu, shear_factor=6 * (1 + nu) / (7 + 6 * nu))
    hardening = linear(crimped_pull.YIELD, E, modulus=crimped_pull.TANGENT)
    line = cosine_line(height, STEP, segments=400) if height else straight_line(STEP)
    made = along(line, round_wire, hardening=hardening)
    return Element(**{**vars(made), "fibres": section})


@lru_cache(maxsize=8)
def pull(height: float, section: tuple[int, int] | None, *, held: bool) -> tuple[Floats, Floats]:
    """Forces along x [N] and heights left [mm] at the kept pulls: frames at both ends stay along x."""
    bars = bars_of((wire(height, section),), PressCase(frame="chord", offset="lower"))
    law = bars.yielding
    assert law is not None
    kind = np.zeros(1, dtype=np.int64)
    history, begin = law.virgin(kind), law.beginning(1)
    x, y, z = np.eye(3)

    def at(u: float, rise: float) -> tuple[Floats, Floats]:
        line = ((STEP + u, 0.0, rise), tuple(x), tuple(y), tuple(z), tuple(z), tuple(x), 1.0, height, height, STEP)
        D, g, J, K = np.empty(6), np.empty(12), np.empty((6, 12)), np.empty((12, 12))
        chord.chord_modes(*line, history.measures[0], D)
        F = law.respond(history, kind, D[None].copy(), begin, 1).F[0]
        chord.expand_chord(*line, history.measures[0], law.C[0], True, False, D, F, g, J, K)
        return D, g[6:9]

    forces, heights, reached = [], [], 0.0
    for u in PULLED["u"]:
        for part in np.linspace(reached, u, SUBSTROKES + 1)[1:]:
            rise = height
            if height and not held:
                rise = brentq(lambda h, part=part: at(part, h)[1][2], -0.2 * height, 1.1 * height, xtol=1e-12)
            D, force = at(part, rise)
            history = law.settled(history, kind, D[None], begin)
        reached = u
        forces.append(force[0])
        heights.append(rise)
    return np.array(forces), np.array(heights)


@pytest.mark.parametrize(("held", "most"), [(False, 0.05), (True, 0.02)])
def test_a_crimped_wire_straightens_as_the_solids_do(held: bool, most: float) -> None:
    forces, heights = pull(HEIGHT, FIBRES, held=held)
    solid = PULLED["held_force" if held else "free_force"]
    assert np.abs(forces / solid - 1).max() < most
    if not held:
        assert np.abs(heights - PULLED["free_height"]).max() < 0.03


@pytest.mark.parametrize(("held", "most", "late"), [(False, 0.2, 0.02), (True, 0.06, 0.01)])
def test_resultants_straighten_it_with_too_much_force_and_agree_after(held: bool, most: float, late: float) -> None:
    """The law of resultants counts the strain of unbending as if it hardened all of the section."""
    forces, _ = pull(HEIGHT, None, held=held)
    off = forces / PULLED["held_force" if held else "free_force"] - 1
    assert off.min() > -0.02
    assert off.max() < most
    assert np.abs(off[PULLED["u"] > 0.025 * STEP]).max() < late


def test_it_begins_with_its_elastic_stiffness_and_ends_as_the_bare_wire() -> None:
    forces, _ = pull(HEIGHT, FIBRES, held=False)
    element = wire(HEIGHT, FIBRES)
    first = PULLED["u"][0]
    assert first / forces[0] == pytest.approx(axial_compliance(element) * STEP, rel=3e-3)
    # It is straight when it has grown by what its arc is longer than its step.
    slack = element.wire_length - STEP
    assert slack / STEP == pytest.approx(0.00614, abs=2e-5)
    bare, _ = pull(0.0, FIBRES, held=False)
    late = PULLED["u"] > 0.03 * STEP
    followed = np.interp(PULLED["u"][late] - slack, PULLED["u"], bare)
    np.testing.assert_allclose(forces[late], followed, rtol=6e-3)


def section(points: Floats | None) -> SectionLaw:
    E, nu = crimped_pull.YOUNGS_MODULUS, crimped_pull.POISSON
    curve = linear(crimped_pull.YIELD, E, modulus=crimped_pull.TANGENT).curve
    return SectionLaw(np.array([E, E / (2 + 2 * nu), DIAMETER]), curve, 0.0, points)


def kept(law: SectionLaw, stretch: float, curvature: float, *, bent_first: bool) -> float:
    """Share of the curvature that stays when a straight wire is let go."""
    strain, past = np.log1p(stretch), law.start()
    bend = curvature / (1 + stretch)
    free = np.nan if bent_first else strain
    steps = [[free, 0.0, 0.0, 0.0]] if not bent_first else []
    steps += [[free, part * bend, 0.0, 0.0] for part in (0.25, 0.5, 0.75, 1.0)]
    if bent_first and stretch:
        steps += [[part * strain, bend, 0.0, 0.0] for part in (0.25, 0.5, 0.75, 1.0)]
    for step in steps:
        past = law.at(np.array(step), past).past
    return float(law.under(np.zeros(4), past).strain[1] / bend)


@pytest.mark.parametrize("row", range(len(BENT["curvature"])))
def test_a_straight_wire_stretched_and_bent_springs_back_as_the_solids_do(row: int) -> None:
    stretch, curvature = BENT["stretch"][row], BENT["curvature"][row]
    share = BENT["curvature_kept"][row] / curvature
    found = kept(section(fibres.round_points(8, 32)), stretch, curvature, bent_first=bool(BENT["bent_first"][row]))
    assert found == pytest.approx(share, abs=0.01)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
def test_calculix_still_gives_the_kept_answer() -> None:
    found = straight_bent.bend(0.0, 100.0, bent_first=False, cuts=2)
    row = np.flatnonzero((np.abs(BENT["stretch"]) < 1e-5) & (np.abs(BENT["curvature"] * 100.0 - 1) < 0.02))[0]
    assert found[4] == pytest.approx(BENT["moment"][row], rel=0.01)
    assert found[6] == pytest.approx(BENT["curvature_kept"][row], abs=0.01 * BENT["curvature"][row])
