"""What an energy of wires that yield asks them: each state once, and the next from what the last has found."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from small_grids import PUNCH

from punchform.case import CircleBlank, CosineLine, GridCase, PressCase, WireCase
from punchform.grid import lay
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.frames import State
from punchform.mechanics.history import Response, Yielding
from punchform.press import energy_of, press
from punchform.start import flat_start
from punchform.wire import stiffness

STEP = 10.0
WIRE = WireCase(material="304 annealed", diameter=1.0, centreline=CosineLine(height=1.0))
CLAMP = PressCase(rim="clamp", frame="chord", strokes=2)


def made() -> tuple[Energy, State]:
    """A small grid under a clamp, on the punch, whose wires flow there."""
    grid = lay(GridCase(step=(STEP, STEP), blank=CircleBlank(radius=5.2 * STEP), symmetry="quarter"), rim_radius=40.0)
    elements = stiffness(WIRE, (STEP, STEP))
    state = flat_start(grid, PUNCH)
    return energy_of(grid, elements, PUNCH, CLAMP, start=state), state


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Response]:
    """The answers of all searches for end forces."""
    answers: list[Response] = []
    respond = Yielding.respond

    def noted(self: Yielding, *arguments: Any) -> Response:
        answers.append(respond(self, *arguments))
        return answers[-1]

    monkeypatch.setattr(Yielding, "respond", noted)
    return answers


def test_a_state_is_asked_for_once(asked: list[Response]) -> None:
    energy, state = made()
    energy.at(state)
    model = energy.model(energy.kinematics.chart(state), Hessian.EXACT)
    F = energy.elastic(state)[1]
    settled = energy.settled(state)
    assert len(asked) == 1
    assert model.energy == pytest.approx(energy.at(state), rel=1e-12)
    np.testing.assert_array_equal(F, asked[0].F)
    energy.at(settled)
    assert len(asked) > 1


def test_what_is_remembered_belongs_to_its_bars(asked: list[Response]) -> None:
    energy, state = made()
    energy.at(state)
    law = energy.bars.yielding
    assert law is not None
    stronger = replace(law, curve=law.curve * (1.0, 100.0))
    elastic = replace(energy, bars=replace(energy.bars, yielding=stronger))
    assert elastic.at(state) > energy.at(state)
    assert len(asked) == 3


def test_a_press_asks_about_once_for_every_evaluation(asked: list[Response]) -> None:
    energy, _ = made()
    formed = press(energy.grid, stiffness(WIRE, (STEP, STEP)), PUNCH, CLAMP)
    # A settled state once more for every stroke, and what a cut step asks in vain.
    assert len(asked) <= 1.5 * formed.factorisations + 2 * len(formed.strokes)


def test_the_answer_after_a_stroke_is_foretold() -> None:
    energy, state = made()
    settled = energy.settled(state)
    begin = energy.recall.begin
    assert begin is not None
    assert settled.history is not None
    modes = np.einsum("mab,mb->ma", settled.history.B, begin.forces[:, :6])
    np.testing.assert_array_equal(begin.modes, modes)
    # The end forces of a wire stay; where nothing flowed to the last digits.
    still = ~(settled.history.past != 0.0).any(axis=(1, 2))
    np.testing.assert_allclose(energy.elastic(settled)[0][still], modes[still], atol=1e-9)
