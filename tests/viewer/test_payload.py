"""What the page is told is what the run found: to half a step, NaN kept, in few bytes."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import stretched
import tiny_dish
from fake_run import fake_run
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from unpacked import Unpacked

from punchform.arrays import Floats, Ints
from punchform.report.viewer import Packed, Scene, pack, scene_of
from punchform.report.viewer.coding import Blob
from punchform.report.viewer.payload import PLACE, SHARE
from punchform.run import Run, run

EDGE = 2**31 - 3
LOADED = '[load]\npressure = "100 Pa"\n'


def unpacked(blob: Blob, header: dict[str, object]) -> Unpacked:
    """A reader of a blob alone."""
    import base64

    text = json.dumps({"size": blob.size, "blob": base64.b64encode(blob.deflated()).decode(), **header})
    return Unpacked(Packed("scene", "", text))


@given(arrays(np.int64, st.integers(0, 40), elements=st.integers(-EDGE, EDGE)))
def test_whole_numbers_come_back_exactly(values: Ints) -> None:
    blob = Blob()
    blob.integers(np.arange(5))
    told = blob.integers(values)
    assert np.array_equal(wrapped(unpacked(blob, {}).whole(told)), values)


def wrapped(values: Ints) -> Ints:
    """Whole numbers as the 32 bits of the page hold them."""
    return (values + 2**31) % 2**32 - 2**31


@settings(max_examples=50)
@given(
    arrays(np.float64, st.integers(1, 40), elements=st.floats(-1e4, 1e4) | st.just(np.nan)),
    st.floats(1e-5, 1.0),
)
def test_numbers_come_back_to_half_a_step_and_nan_as_nan(values: Floats, step: float) -> None:
    blob = Blob()
    told = blob.floats(values, step)
    back = unpacked(blob, {}).floats(told)
    assert np.array_equal(np.isnan(back), np.isnan(values))
    known = ~np.isnan(values)
    assert np.all(np.abs(back - values)[known] <= 0.5 * step * (1 + 1e-9) + 1e-12)


def test_a_number_too_large_for_its_step_is_refused() -> None:
    with pytest.raises(OverflowError, match="too large"):
        Blob().floats(np.array([1.0, 3e9]), 1.0)


def test_a_line_costs_next_to_nothing() -> None:
    blob = Blob()
    blob.integers(7 * np.arange(100_000))
    assert len(blob.deflated()) < 1_000


@pytest.fixture(scope="module")
def dish() -> Run:
    return run(tiny_dish.case(LOADED).model_copy(update={"title": "</script><b>Dish</b>"}))


@pytest.mark.parametrize("made", ["elastic", "yielding"])
def test_every_number_of_a_run_is_in_the_page(made: str, request: pytest.FixtureRequest) -> None:
    scene = scene_of(request.getfixturevalue("dish") if made == "elastic" else stretched.dish())
    back = Unpacked(pack(scene))
    assert np.array_equal(np.column_stack([back.whole(told) for told in back.header["index"]]), scene.index)
    first, away = (back.whole(told) for told in back.header["ends"])
    assert np.array_equal(np.column_stack((first, first + away)), scene.ends)
    for number, pose in enumerate(scene.poses):
        told = back.header["poses"][number]
        assert np.nanmax(np.abs(back.points(told["positions"]) - pose.positions)) <= 0.5 * PLACE * (1 + 1e-6)
        for figure in pose.figures:
            largest = np.nanmax(np.abs(figure.values), initial=0.0)
            found = back.figures(number, figure.key)
            np.testing.assert_allclose(found, figure.values, rtol=0, atol=0.5001 * SHARE * largest + 1e-300)
        for (_, reference), drawn in zip(pose.references, told["references"], strict=True):
            apart = back.points(told["positions"]) + back.points(drawn["away"]) - reference
            assert np.nanmax(np.abs(apart)) <= 0.5 * PLACE * (1 + 1e-6)


def test_figures_have_five_digits_of_their_largest() -> None:
    assert SHARE <= 1e-5


def test_text_cannot_leave_its_script_element(dish: Run) -> None:
    packed = pack(scene_of(dish))
    assert "<" not in packed.text
    assert json.loads(packed.text)["title"] == "</script><b>Dish</b>"


def test_the_same_run_is_the_same_text(dish: Run) -> None:
    assert pack(scene_of(dish)) == pack(scene_of(dish))


def test_a_run_of_five_thousand_nodes_leaves_room_for_its_figures() -> None:
    scene = scene_of(fake_run(step=8.6))
    assert len(scene.index) > 5_000
    assert len(pack(scene).text) < 100 * len(scene.index)


def test_a_scene_with_arrays_that_do_not_fit_is_refused(dish: Run) -> None:
    scene: Scene = scene_of(dish)
    with pytest.raises(AssertionError):
        replace(scene, index=scene.index[:-1])
