"""The answer of a coarser grid as the start behind a clamped rim."""

from __future__ import annotations

import numpy as np
import pytest

from punchform.case import CircleBlank, GridCase, ParaboloidProfile, PressCase, PunchCase, StraightLine, WireCase
from punchform.coarse import COARSEST, coarsened, doubled, refined
from punchform.grid import lay
from punchform.press import clamped, press
from punchform.punch import surface
from punchform.start import flat_start
from punchform.wire import stiffness

WIRE = WireCase(diameter=0.75, youngs_modulus=210e3, centreline=StraightLine())
DEEP = surface(PunchCase(profile=ParaboloidProfile(focal_length=60.0), rim_radius=120.0, fillet=20.0))


def case(step: float, symmetry: str = "quarter", centre: str = "node") -> GridCase:
    return GridCase(step=(step, step), blank=CircleBlank(radius=150.0), symmetry=symmetry, centre=centre, weave="same")


@pytest.mark.parametrize("symmetry", ["quarter", "full"])
def test_every_second_wire_is_the_grid_of_twice_the_step(symmetry: str) -> None:
    coarse, laid = coarsened(lay(case(4.0, symmetry))), lay(case(8.0, symmetry))
    assert coarse is not None
    order = np.lexsort(coarse.index.T[::-1])
    np.testing.assert_array_equal(coarse.index[order], laid.index)
    np.testing.assert_allclose(coarse.flat[order], laid.flat)
    back = np.append(np.argsort(order), -1)
    np.testing.assert_array_equal(back[coarse.neighbours[order]], laid.neighbours)
    assert coarse.elements == laid.elements
    assert coarse.weight.sum() == laid.weight.sum()
    assert set(zip(back[coarse.start], back[coarse.end], strict=True)) == set(zip(laid.start, laid.end, strict=True))


def test_small_grids_start_by_themselves() -> None:
    small = lay(case(12.0))
    assert small.nodes < COARSEST
    assert coarsened(small) is None


def test_a_grid_with_a_cell_on_the_axis_starts_from_a_coarser_one_too() -> None:
    laid, wires = lay(case(6.0, centre="cell")), stiffness(WIRE, (6.0, 6.0))
    formed = press(laid, wires, DEEP, PressCase(rim="clamp"))
    assert formed.outcome.name == "CONVERGED"
    assert formed.factorisations <= 12


def test_a_straight_wire_of_twice_the_length_is_that_of_twice_the_step() -> None:
    slender = WIRE.model_copy(update={"diameter": 0.05, "shear_factor": 1.0})
    once, twice = stiffness(slender, (4.0, 4.0))[0], stiffness(slender, (8.0, 8.0))[0]
    np.testing.assert_allclose(doubled(once).C, twice.C, rtol=1e-3, atol=1e-6 * twice.C.max())


def test_a_field_is_carried_over_to_the_order_of_its_interpolation() -> None:
    fine = lay(case(4.0))
    coarse = coarsened(fine)
    assert coarse is not None
    held = clamped(fine, DEEP)
    begun = refined(fine, flat_start(fine, DEEP), coarse, flat_start(coarse, DEEP), DEEP, held)
    # The flat start is u_x = u_y = 0 on both grids, so only the return to the surface moves a node.
    wanted = flat_start(fine, DEEP)
    assert np.abs(begun.positions - wanted.positions).max() < 0.25
    assert np.abs(DEEP.distance(begun.positions[~held])).max() < 1e-9
    np.testing.assert_array_equal(begun.positions[held], wanted.positions[held])
    np.testing.assert_allclose(np.linalg.norm(begun.tangents, axis=2), 1.0)
    np.testing.assert_allclose(np.einsum("nwc,nc->nw", begun.tangents, begun.normals), 0.0, atol=1e-12)


def test_behind_a_clamped_rim_the_steps_do_not_grow_with_the_grid_and_the_answer_is_the_same() -> None:
    steps = []
    for step in (10.0, 5.0, 2.5):
        laid, wires = lay(case(step)), stiffness(WIRE, (step, step))
        formed = press(laid, wires, DEEP, PressCase(rim="clamp"))
        flat = press(laid, wires, DEEP, PressCase(rim="clamp", start="flat")) if step > 3 else None
        assert formed.outcome.name == "CONVERGED"
        if flat is not None:
            assert formed.energy == pytest.approx(flat.energy, rel=1e-9)
        steps.append(formed.factorisations)
    assert steps[-1] <= steps[1] + 1 <= 12
