"""One design has one key and one result, wherever it is computed, and a record loses and repeats nothing."""

from __future__ import annotations

from pathlib import Path

import pytest
import tiny_dish
from stretched import KEPT, dish

from punchform.case import Case, packaged_cases, read_case, setting, varied
from punchform.errors import InputError, NoEquilibrium
from punchform.optimise import evaluations
from punchform.optimise.evaluations import Evaluation, Record, Task, designed, evaluate, sent, told, work
from punchform.optimise.figures import FIGURES

CASE = tiny_dish.case()


def test_the_key_is_of_what_is_computed() -> None:
    """However a design is written, and whatever the case is called, it is the same; any other number is another."""
    key = designed(CASE, {"wire.diameter": "0.8 mm"}).key
    assert designed(CASE, {"wire.diameter": 0.8}).key == designed(CASE, {"wire.diameter": "0.0008 m"}).key == key
    assert designed(varied(CASE, {"wire.diameter": 0.8}), {}).key == key
    assert designed(CASE.model_copy(update={"title": "another"}), {"wire.diameter": 0.8}).key == key
    assert designed(CASE, {"wire.diameter": 0.8000000001}).key != key
    assert designed(CASE, {"wire.diameter": 0.8}).changes == {"wire.diameter": 0.8}
    assert designed(CASE, {"grid.step": "9 mm"}).changes == {"grid.step": 9.0}


def test_the_key_knows_the_version(monkeypatch: pytest.MonkeyPatch) -> None:
    before = designed(CASE, {}).key
    monkeypatch.setattr(evaluations, "__version__", "0.0.0")
    assert designed(CASE, {}).key != before


@pytest.mark.parametrize("name", packaged_cases())
def test_a_worker_gets_the_same_case(name: str) -> None:
    """What the file left out is left out for the worker too, so that it follows what is changed there."""
    case = read_case(f"packaged:{name}")
    there = Case.model_validate_json(sent(case))
    assert there == case
    assert designed(there, {}).key == designed(case, {}).key
    if case.punch is not None and setting(case, "wire.diameter") is not None:
        changes = {"wire.diameter": "1.1 mm"}
        assert designed(there, changes) == designed(case, changes)


@pytest.mark.parametrize("yields", [False, True])
def test_a_worker_on_one_core_finds_the_same_figures(yields: bool) -> None:
    """Also where the answers of wires that yield are found in two threads."""
    case = dish(hold=KEPT).case if yields else CASE
    changes = {"wire.diameter": 0.8}
    here, there = evaluate(case, changes), work(Task(sent(case), changes))
    assert here.failure is None
    assert set(here.figures) == set(FIGURES)
    assert ((here.figures["max_plastic_strain"] or 0.0) > 0.01) == yields
    assert (there.key, there.changes, there.figures) == (here.key, here.changes, here.figures)


def test_failures_are_recorded_not_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = evaluate(CASE, {"wire.diameter": "-1 mm"})
    assert wrong.failed
    assert wrong.failure == "wire.diameter: must be more than 0, not '-1 mm'"
    assert wrong.figures == {}

    def lost(case: Case) -> None:
        raise NoEquilibrium("the step limit was reached")

    monkeypatch.setattr(evaluations, "run", lost)
    assert evaluate(CASE, {}).failure == "no equilibrium: the step limit was reached"
    assert told(ZeroDivisionError("by\nzero")) == "ZeroDivisionError: by zero"


def test_a_record_goes_on_where_it_was_cut(tmp_path: Path) -> None:
    """Half a line is what a crash leaves of an evaluation: it is as if it had not been made."""
    path = tmp_path / "record.jsonl"
    first, second = (Evaluation(key, {"grid.step": 1 / 3}, {"rms": 0.1 + 0.2, "mass": None}, 0.5) for key in "ab")
    with Record(path) as record:
        assert record.add(first)
        assert not record.add(first)
        assert record.add(second)
    whole = path.read_bytes()
    for cut in range(len(whole) // 2 + 1, len(whole)):
        path.write_bytes(whole[:cut])
        with Record(path) as record:
            assert list(record) == [first]
            record.add(second)
        assert path.read_bytes() == whole


def test_a_design_is_computed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = []

    def counted(case: Case, changes: dict[str, object]) -> Evaluation:
        made.append(changes)
        return Evaluation(designed(case, changes).key, changes, {"rms": 1.0})

    monkeypatch.setattr(evaluations, "evaluate", counted)
    for _ in range(2):
        with Record(tmp_path / "record.jsonl") as record:
            one = record.evaluated(CASE, {"wire.diameter": "0.8 mm"})
            assert record.evaluated(CASE, {"wire.diameter": 0.8}) == one
            assert len(record) == 1
            assert one.key in record
    assert len(made) == 1


def test_another_file_is_no_record(tmp_path: Path) -> None:
    path = tmp_path / "record.jsonl"
    path.write_text('{"key": "a", "changes": {}}\n[1, 2]\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"record.jsonl:2: the record of evaluations is damaged"):
        Record(path)
