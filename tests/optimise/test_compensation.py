"""The iteration alone, on dishes that answer linearly: its rate, its memory, its safeguard, and when it stops."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from linear_dishes import LinearDish, only, space_of, sum_of

from punchform.errors import InputError, NoEquilibrium
from punchform.optimise.acceleration import Tried, next_step
from punchform.optimise.compensation import Compensation, Ending, Limits, compensate, one_rms
from punchform.optimise.correction_space import Term
from punchform.optimise.reach import PROBES, analysed, probing
from punchform.progress import Progress

FIELD = space_of("field")
MANY = only(FIELD, (Term(0, 0), -1.0), (Term(2, 0), 0.4), (Term(4, 4), 0.3), (Term(8, 8), 0.05))


def found(response: float, limits: Limits | None = None) -> Compensation:
    dish = LinearDish(FIELD, sum_of(FIELD, MANY), response * np.eye(len(MANY)))
    return compensate(dish.press, FIELD, limits or Limits(1e-9))


@pytest.mark.parametrize("response", [0.5, 0.9, 1.0, 1.3])
def test_the_first_step_leaves_one_less_the_response(response: float) -> None:
    first, second, *_ = found(response).solves
    assert one_rms(second) / one_rms(first) == pytest.approx(abs(1 - response), abs=1e-4)
    assert second.follows == pytest.approx(response, rel=1e-4)


@pytest.mark.parametrize("response", [0.3, 0.6, 1.4])
def test_the_memory_knows_a_uniform_response_after_two_solves(response: float) -> None:
    third = found(response).solves[2]
    assert one_rms(third) < 2e-3 * one_rms(found(response).first)


def test_the_memory_beats_the_plain_step_where_shapes_answer_differently() -> None:
    shares = np.linspace(0.4, 1.2, len(MANY))
    dish = LinearDish(FIELD, sum_of(FIELD, MANY), np.diag(shares))
    with_it = compensate(dish.press, FIELD, Limits(1e-9, 5))
    numbers = np.zeros(len(MANY))
    for _ in range(4):
        numbers = numbers - dish.press(numbers).answer(FIELD)
    assert one_rms(with_it.best) < 0.2 * dish.press(numbers).rms


def test_relaxation_answers_a_part_of_the_error() -> None:
    first, second, *_ = found(1.0, Limits(1e-9, relaxation=0.5)).solves
    assert one_rms(second) == pytest.approx(0.5 * one_rms(first), rel=1e-3)


@pytest.mark.parametrize("response", [2.5, 3.5])
def test_a_response_beyond_two_is_caught_by_half_the_step(response: float) -> None:
    done = found(response, Limits(1e-3))
    rms = [one_rms(one) for one in done.solves]
    assert rms[1] > rms[0]
    assert not done.solves[1].kept
    assert rms[2] < rms[0]
    assert done.ending is Ending.WITHIN


def test_the_best_solve_is_kept_and_the_kept_ones_only_improve() -> None:
    kept = [one_rms(one) for one in found(2.5, Limits(1e-3)).solves if one.kept]
    assert all(after < before for before, after in pairwise(kept))
    assert one_rms(found(2.5, Limits(1e-3)).best) == kept[-1]


@pytest.mark.parametrize("response", [0.0, -0.8])
def test_a_shape_that_does_not_follow_is_told_after_two_solves(response: float) -> None:
    done = found(response)
    assert done.ending is Ending.UNMOVED
    assert len(done.solves) == 2
    assert done.best is done.first
    assert done.solves[1].follows == pytest.approx(response, abs=1e-9)


def test_a_turned_punch_cannot_answer_lobes_and_says_so_before_it_tries() -> None:
    lobes, turned = only(FIELD, (Term(4, 4), 1.0)), space_of("revolution")
    dish = LinearDish(turned, sum_of(FIELD, lobes), np.eye(len(turned.terms)))
    done = compensate(dish.press, turned, Limits(1e-6))
    assert done.ending is Ending.FLOOR
    assert len(dish.pressed) == 1
    assert done.floor == pytest.approx(one_rms(done.first), rel=1e-3)
    milled = space_of("lobes")
    dish = LinearDish(milled, sum_of(FIELD, lobes), np.eye(len(milled.terms)))
    assert compensate(dish.press, milled, Limits(1e-3)).ending is Ending.WITHIN


def test_the_floor_of_a_turned_punch_is_what_is_not_round() -> None:
    mixed = only(FIELD, (Term(0, 0), -1.0), (Term(4, 4), 0.3))
    turned = space_of("revolution")
    dish = LinearDish(turned, sum_of(FIELD, mixed), np.eye(len(turned.terms)))
    done = compensate(dish.press, turned, Limits(1e-6))
    lobes = LinearDish(turned, sum_of(FIELD, only(FIELD, (Term(4, 4), 0.3))), np.eye(len(turned.terms)))
    assert done.ending is Ending.FLOOR
    assert done.floor == pytest.approx(lobes.press(np.zeros(len(turned.terms))).rms, rel=1e-3)
    assert one_rms(done.best) == pytest.approx(done.floor, rel=1e-3)


def test_it_stops_within_the_tolerance_and_at_the_limit() -> None:
    assert len(found(1.0, Limits(10.0)).solves) == 1
    done = found(0.9, Limits(0.3))
    assert done.ending is Ending.WITHIN
    assert one_rms(done.best) <= 0.3
    assert len(done.solves) == 2
    short = found(0.5, Limits(1e-9, 2))
    assert short.ending is Ending.LIMIT
    assert len(short.solves) == 2


def test_without_a_tolerance_it_goes_on_to_the_floor() -> None:
    assert found(0.9, Limits(None, 20)).ending is Ending.FLOOR


def test_a_press_that_fails_counts_and_halves_the_step() -> None:
    dish = LinearDish(
        FIELD, sum_of(FIELD, MANY), np.eye(len(MANY)), fails=lambda numbers: float(np.abs(numbers).max()) > 0.6
    )
    done = compensate(dish.press, FIELD, Limits(0.01, 4))
    failed, half = done.solves[1], done.solves[2]
    assert failed.misfit is None
    assert failed.failure == "press: no way down"
    np.testing.assert_allclose(half.numbers, 0.5 * failed.numbers)
    assert one_rms(half) < one_rms(done.first)
    assert len(done.solves) == 4


def test_a_punch_over_which_nothing_can_be_pressed_is_told() -> None:
    dish = LinearDish(FIELD, sum_of(FIELD, MANY), np.eye(len(MANY)), fails=lambda numbers: bool(numbers.any()))
    done = compensate(dish.press, FIELD, Limits(1e-3))
    assert done.ending is Ending.UNPRESSED
    assert done.best is done.first


def test_the_first_press_must_not_fail() -> None:
    dish = LinearDish(FIELD, sum_of(FIELD, MANY), np.eye(len(MANY)), fails=lambda numbers: True)
    with pytest.raises(NoEquilibrium):
        compensate(dish.press, FIELD, Limits(1e-3))


def test_a_correction_that_no_case_can_hold_counts_as_a_failed_press() -> None:
    dish = LinearDish(FIELD, sum_of(FIELD, MANY), np.eye(len(MANY)))

    def press(numbers):  # type: ignore[no-untyped-def]
        if np.abs(numbers).max() > 0.6:
            raise InputError.of("too sharp a bend")
        return dish.press(numbers)

    failed = compensate(press, FIELD, Limits(0.01, 3)).solves[1]
    assert failed.failure == "too sharp a bend"


def test_it_begins_where_it_is_told_and_takes_what_is_known() -> None:
    dish = LinearDish(FIELD, sum_of(FIELD, MANY), np.eye(len(MANY)))
    known = dish.press(-0.5 * MANY)
    dish.pressed.clear()
    done = compensate(dish.press, FIELD, Limits(1e-3), start=-0.5 * MANY, known=known)
    assert done.first.misfit is known
    assert len(dish.pressed) == len(done.solves) - 1
    assert done.ending is Ending.WITHIN


def test_every_solve_is_told_of() -> None:
    told: list[Progress] = []
    dish = LinearDish(FIELD, sum_of(FIELD, MANY), 0.9 * np.eye(len(MANY)))
    done = compensate(dish.press, FIELD, Limits(0.2), observe=told.append)
    assert [one.message.partition(":")[0] for one in told] == [
        f"field, solve {number} of at most 6" for number in range(1, len(done.solves) + 1)
    ]


def test_the_step_of_the_memory_is_the_secant_of_a_line() -> None:
    # The wish falls by 0.4 per unit: from 1 at 0 it is nil at 2.5.
    here, other = Tried(np.array([1.0]), np.array([0.6])), Tried(np.array([0.0]), np.array([1.0]))
    step = next_step(here, [other], np.eye(1))
    assert 1.0 + step[0] == pytest.approx(2.5, rel=1e-4)


def test_a_step_is_never_much_longer_than_the_wish() -> None:
    here, other = Tried(np.array([1.0]), np.array([0.999])), Tried(np.array([0.0]), np.array([1.0]))
    assert abs(next_step(here, [other], np.eye(1))[0]) <= 5.0


def test_singular_values_are_one_for_a_shape_that_follows_and_shares_are_those_of_the_error() -> None:
    probes = probing(FIELD)
    error = sum_of(FIELD, only(FIELD, (Term(0, 0), -1.0), (Term(4, 4), 0.5)))
    response = np.diag([0.0 if term.m == 4 else 1.0 for term in PROBES])
    dish = LinearDish(probes, error, response)
    here = dish.press(np.zeros(len(PROBES)))
    columns = np.column_stack([dish.press(one).deviation - here.deviation for one in np.eye(len(PROBES))])
    found = analysed(columns, here, probes, solves=len(PROBES))
    np.testing.assert_allclose(found.values, [1.0] * 5 + [0.0] * 2, atol=1e-9)
    lobes = LinearDish(probes, sum_of(FIELD, only(FIELD, (Term(4, 4), 0.5))), response).press(np.zeros(len(PROBES)))
    assert found.left == pytest.approx(lobes.rms, rel=1e-6)
    assert max(found.lobes, key=lambda m: found.lobes[m]) == 4
    assert found.beyond == pytest.approx((found.left / found.rms) ** 2)


def test_a_dish_that_follows_wholly_has_only_ones() -> None:
    probes = probing(FIELD)
    dish = LinearDish(probes, sum_of(FIELD, MANY), np.eye(len(PROBES)))
    here = dish.press(np.zeros(len(PROBES)))
    columns = probes.columns(here.places)
    found = analysed(columns, here, probes, solves=0)
    np.testing.assert_allclose(found.values, 1.0, rtol=1e-9)
    assert found.left < 0.1 * found.rms
