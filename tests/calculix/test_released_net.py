"""A released and loaded net against nonlinear beams in CalculiX: places, moves and reactions."""

from __future__ import annotations

import shutil
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from released_net import COLUMNS, CROSSINGS, SIDE, answers, by_calculix, our_net, rigidities

from punchform.arrays import Floats
from punchform.load import Loaded
from punchform.mechanics.outcome import Outcome
from punchform.release import Released

ours = cache(our_net)


@cache
def kept(crossing: str) -> dict[str, Floats]:
    """The kept answers: i, j, held (N,), and x, rx, y, ry (N, 3) as COLUMNS says."""
    rows = np.loadtxt(answers(crossing), delimiter=",", skiprows=1)
    return named(rows)


def named(rows: Floats) -> dict[str, Floats]:
    table = dict(zip(COLUMNS, rows.T, strict=True))
    vectors = {kind: np.column_stack([table[f"{kind}_{axis}"] for axis in "123"]) for kind in ("x", "rx", "y", "ry")}
    return {name: table[name] for name in ("i", "j", "held")} | vectors


def assert_agree(found: dict[str, Floats], released: Released, loaded: Loaded) -> None:
    """Moves to 0.5 % of the largest move of the stage, reactions to 1 % of the largest reaction."""
    np.testing.assert_array_equal(np.column_stack((found["i"], found["j"])), released.whole.index)
    moved = found["y"] - found["x"]
    for mine, theirs, size in (
        (released.whole.positions, found["x"], np.linalg.norm(released.moved, axis=1).max()),
        (loaded.moved, moved, loaded.largest_deflection),
    ):
        assert np.linalg.norm(mine - theirs, axis=1).max() < 5e-3 * size
    for reactions, theirs in ((released.reactions, found["rx"]), (loaded.reactions, found["ry"])):
        size = np.linalg.norm(reactions, axis=1).max()
        assert np.linalg.norm(reactions - theirs, axis=1).max() < 1e-2 * size


@pytest.mark.parametrize("crossing", CROSSINGS)
def test_the_net_agrees_with_the_kept_answers_of_calculix(crossing: str) -> None:
    released, loaded = ours(crossing)
    assert released.outcome is loaded.outcome is Outcome.CONVERGED
    assert released.stability.negative == 0
    # Both stages move the net by about the thickness of its wires, which is tilted by up to 9 degrees.
    assert np.linalg.norm(released.moved, axis=1).max() > SIDE
    assert loaded.largest_deflection > 0.8 * SIDE
    found = kept(crossing)
    held = found["held"] == 1
    np.testing.assert_array_equal(held, released.hold.fixed.all(axis=1))
    # The supports stand where they stood when CalculiX ran.
    np.testing.assert_allclose(found["x"][held], released.whole.positions[held], rtol=0, atol=2e-6)
    assert_agree(found, released, loaded)


def test_the_agreement_would_notice_a_wrong_crossing() -> None:
    for crossing, other in (CROSSINGS, CROSSINGS[::-1]):
        with pytest.raises(AssertionError):
            assert_agree(kept(other), *ours(crossing))


def test_the_agreement_would_notice_the_twist_of_the_true_square() -> None:
    """0.141 b⁴ in place of b⁴/6: the resistance to twist matters in these nets."""
    square = replace(rigidities(), GJ=rigidities(0.1406 * SIDE**4).GJ)
    with pytest.raises(AssertionError):
        assert_agree(kept("pinned"), *our_net("pinned", square))


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not on the path")
def test_calculix_repeats_its_answers() -> None:
    rows, _ = by_calculix("welded")
    again = named(rows)
    for name in ("x", "y"):
        np.testing.assert_allclose(again[name], kept("welded")[name], rtol=0, atol=2e-5)
    assert_agree(again, *ours("welded"))
