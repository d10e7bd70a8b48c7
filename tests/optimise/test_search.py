"""Searches with known answers, and what they do with failures, interrupts and their record."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from tiny_dish import case

from punchform.errors import InputError, NoEquilibrium
from punchform.optimise.asking import Ask, evaluator
from punchform.optimise.evaluations import Evaluation, Record
from punchform.optimise.pools import InOrder, given
from punchform.optimise.problem import Question, question_of
from punchform.optimise.search import Found, search, way_of
from punchform.optimise.slopes import Kept

FOCAL = '"punch.profile.focal_length" = { from = "50 mm", to = "75 mm" }'
DIAMETER = '"wire.diameter" = { from = "0.5 mm", to = "1 mm" }'
CROSSING = '"grid.crossing" = { among = ["pinned", "welded"] }'
SPRINGBACK = 1.07
"""By this factor a dish is flatter than its punch."""


def asked(variables: Sequence[str], more: str = "") -> Question:
    """The question of the tiny dish with such variables."""
    return question_of(case(f"[optimise]\nvariables = {{ {', '.join(variables)} }}\n{more}"))


def told(figures: Callable[[Mapping[str, object]], Mapping[str, float]]) -> Ask:
    """Evaluations made of closed forms; a design whose figures are empty has failed."""

    def ask(each: Sequence[Mapping[str, object]]) -> list[Evaluation]:
        found = [(changes, figures(changes)) for changes in each]
        return [Evaluation("", dict(changes), one, 0.0, None if one else "it fails") for changes, one in found]

    return ask


def number_of(changes: Mapping[str, object], place: str) -> float:
    """A setting that is a number."""
    value = changes[place]
    assert isinstance(value, int | float)
    return float(value)


def flatter(changes: Mapping[str, object]) -> dict[str, float]:
    """A dish whose focal length is that of its punch times the springback factor: the best punch has 60 mm over it."""
    focal = number_of(changes, "punch.profile.focal_length")
    return {"rms": 0.05 * abs(SPRINGBACK * focal - 60.0)}


def focal_of(found: Found) -> float:
    """The focal length of the best punch."""
    return number_of(found.best.evaluation.changes, "punch.profile.focal_length")


def test_the_punch_for_a_linear_springback_is_found_in_ten_evaluations() -> None:
    found = search(asked([FOCAL]), told(flatter))
    assert len(found.answers) <= 10
    assert focal_of(found) == pytest.approx(60.0 / SPRINGBACK, abs=0.01)


@pytest.mark.parametrize("tangents", [True, False])
def test_the_punch_of_a_real_dish_is_found_in_ten_evaluations(tangents: bool) -> None:
    """By tangents, an evaluation a step, and by differences: the same punch, and no better one beside it."""
    question, record = asked([FOCAL]), Record()
    kept = Kept(question, record)
    found = search(question, kept.ask, slopes=kept.slopes if tangents else None)
    assert found.way == "gradient"
    assert len(found.answers) <= (6 if tangents else 10)
    best = found.best.told["rms"]
    beside = kept.ask([{"punch.profile.focal_length": focal_of(found) + apart} for apart in (-0.1, 0.1)])
    for one in beside:
        rms = one.figures["rms"]
        assert best is not None
        assert rms is not None
        assert best < rms
    if tangents:
        by_differences = search(question, kept.ask)
        assert focal_of(by_differences) == pytest.approx(focal_of(found), abs=0.02)


def test_a_constraint_binds_and_the_cost_follows_the_chain_rule() -> None:
    """The cheapest wire that keeps the energy: the constraint holds it, by tangents and by differences alike."""
    more = 'objectives = ["cost"]\ncost = "40 * wire.diameter ** 2 + gain_loss + 0.1 * max_shear"\nfrequency = 10'
    question = asked([FOCAL, DIAMETER], f"{more}\nconstraints = {{ energy = {{ least = 600 }} }}")
    kept = Kept(question, Record())
    found = [search(question, kept.ask, slopes=slopes) for slopes in (kept.slopes, None)]
    assert found[0].binding == ("energy at least 600 mJ",)
    for name in question.figures:
        assert found[0].best.told[name] == pytest.approx(found[1].best.told[name], rel=1e-3)
    assert len(found[0].answers) < len(found[1].answers)


def test_slopes_agree_with_differences() -> None:
    question = asked(
        [FOCAL, DIAMETER],
        'objectives = ["cost"]\nfrequency = 10\nconstraints = { gain_loss = { most = 9 } }\n'
        'cost = "push * wire.height + gain_loss"',
    )
    kept = Kept(question, Record())
    at = {"punch.profile.focal_length": 61.0, "wire.diameter": 0.8}
    kept.ask([at])
    slopes = kept.slopes(at)
    assert slopes is not None
    for place in at:
        ends = kept.ask([{**at, place: at[place] * (1 + sign * 1e-4)} for sign in (-1, 1)])
        values = [question.told(one.changes, one.figures) for one in ends]
        for name in question.figures:
            below, above = values[0][name], values[1][name]
            assert below is not None
            assert above is not None
            assert slopes[name][place] == pytest.approx((above - below) / (2e-4 * at[place]), rel=1e-4)


def bowl(changes: Mapping[str, object]) -> dict[str, float]:
    """Two bowls, of the pinned and of the welded grid; the welded one is deeper. Thick wires fail beside their rim."""
    focal, wire = number_of(changes, "punch.profile.focal_length"), number_of(changes, "wire.diameter")
    if wire > 0.9 and focal > 70:
        return {}
    welded = changes["grid.crossing"] == "welded"
    away = ((focal - (55 if welded else 66)) / 25) ** 2 + ((wire - (0.85 if welded else 0.6)) / 0.5) ** 2
    return {"rms": 0.5 + away - 0.1 * welded, "mass": wire, "push": 10 * wire - away}


def test_among_choices_the_deeper_bowl_is_found() -> None:
    found = search(asked([FOCAL, DIAMETER, CROSSING], "evaluations = 50"), told(bowl))
    assert found.way == "global"
    assert found.best.evaluation.changes["grid.crossing"] == "welded"
    assert found.best.told["rms"] == pytest.approx(0.4, abs=1e-3)


def test_what_is_asked_to_be_large_is_made_large_within_its_limit() -> None:
    more = 'objectives = [{ maximise = "push" }]\nconstraints = { mass = { most = 0.7 } }\nevaluations = 50'
    found = search(asked([FOCAL, DIAMETER, CROSSING], more), told(bowl))
    assert found.best.evaluation.changes["grid.crossing"] == "pinned"
    assert found.best.told["push"] == pytest.approx(6.96, abs=0.02)
    assert found.binding == ("mass at most 0.7 kg",)


def test_the_path_is_the_same_again_and_another_with_another_seed() -> None:
    paths = [
        search(asked([FOCAL, DIAMETER, CROSSING], f"evaluations = 30\nseed = {seed}"), told(bowl)).answers
        for seed in (1, 1, 2)
    ]
    designs = [np.array([answer.design for answer in path]) for path in paths]
    np.testing.assert_array_equal(designs[0], designs[1])
    assert (designs[0] != designs[2]).any()


def test_all_designs_are_tried_where_there_are_few() -> None:
    few = ['"wire.diameter" = { among = [0.6, 0.7, 0.8] }', '"grid.subdivide" = { from = 1, to = 2 }', CROSSING]

    def figures(changes: Mapping[str, object]) -> dict[str, float]:
        return {"rms": number_of(changes, "wire.diameter")}

    found = search(asked(few), told(figures))
    assert len(found.answers) == 12
    assert found.ended == "all designs are known"


def test_a_constraint_that_nothing_keeps_is_missed_by_least() -> None:
    found = search(asked([FOCAL], "constraints = { rms = { least = 9 } }\nevaluations = 12"), told(flatter))
    assert not found.best.allowed
    assert focal_of(found) == pytest.approx(75.0)
    assert found.front == ()


def test_where_everything_fails_the_first_reason_is_told() -> None:
    for method in ("gradient", "global"):
        question = asked([FOCAL], f'method = "{method}"\nevaluations = 12')
        with pytest.raises(NoEquilibrium, match="it fails"):
            search(question, told(lambda _: {}))


def test_the_method_follows_from_what_may_change() -> None:
    step = '"grid.step" = { from = "8 mm", to = "12 mm" }'
    for variables, more, way in (
        ([FOCAL], "", "gradient"),
        ([FOCAL], 'method = "global"', "global"),
        ([FOCAL, CROSSING], "", "global"),
        ([step], "", "global"),
        ([step], 'method = "gradient"', "gradient"),
        ([FOCAL], 'objectives = ["rms", "mass"]', "global"),
    ):
        assert way_of(asked(variables, more))[0] == way


def test_a_search_goes_on_where_it_was_stopped(tmp_path: Path) -> None:
    """Stopped in the middle of a batch: the designs before it are kept, and the path ends where it would have."""
    question = asked([FOCAL, CROSSING], "evaluations = 12")
    path = tmp_path / "record.jsonl"

    class Stopping(InOrder):
        left = 7

        def submit(self, *args: object, **kwargs: object) -> object:  # type: ignore[override]
            Stopping.left -= 1
            if Stopping.left < 0:
                raise KeyboardInterrupt
            return super().submit(*args, **kwargs)  # type: ignore[arg-type]

    with (
        pytest.raises(KeyboardInterrupt),
        Record(path) as record,
        evaluator(question.case, record, given(Stopping(), at_once=1)) as ask,
    ):
        search(question, ask)
    with Record(path) as record:
        assert len(record) == 7
        Stopping.left = 5
        with evaluator(question.case, record, given(Stopping(), at_once=1)) as ask:
            again = search(question, ask)
        assert len(record) == 12
    with evaluator(question.case, Record(), given(InOrder(), at_once=1)) as ask:
        whole = search(question, ask)
    for one, other in zip(again.answers, whole.answers, strict=True):
        assert one.evaluation.figures == other.evaluation.figures


def test_the_same_design_is_not_asked_for_twice() -> None:
    counts: list[str] = []

    def figures(changes: Mapping[str, object]) -> dict[str, float]:
        counts.append(repr(changes))
        return bowl(changes)

    found = search(asked([FOCAL, DIAMETER, CROSSING], "evaluations = 40"), told(figures))
    assert len(counts) == len(set(counts)) == len(found.answers) == 40


def test_a_variable_at_its_end_is_told() -> None:
    found = search(asked([FOCAL], 'objectives = [{ maximise = "rms" }]\nevaluations = 10'), told(flatter))
    assert found.at_end == (("punch.profile.focal_length", "largest"),)


def test_gradients_and_levels_exclude_each_other() -> None:
    with pytest.raises(InputError, match="it goes in steps"):
        way_of(asked(['"grid.subdivide" = { from = 1, to = 3 }'], 'method = "gradient"'))
