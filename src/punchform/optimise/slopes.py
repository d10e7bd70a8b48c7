"""Derivatives of the figures of a search by its variables, where the run has tangents; once for each design."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from punchform.case import Case, number, varied
from punchform.errors import InputError
from punchform.optimise.evaluations import Evaluation, Record, designed, evaluate
from punchform.optimise.figures import FIGURES
from punchform.optimise.problem import Question
from punchform.optimise.sensitivity import gradients
from punchform.run import Run, run

Slopes = Callable[[Mapping[str, object]], Mapping[str, Mapping[str, float]] | None]
"""Derivatives {figure: {place: dF/dp}} at a design given by its changes; None where the run has no tangents."""

_STEP = 1e-6
_LATEST = 2


class Kept:
    """Evaluates designs one after the other and keeps the latest runs, whose tangents may be asked for next."""

    def __init__(self, question: Question, record: Record) -> None:
        self._question = question
        self._record = record
        self._runs: dict[str, Run] = {}

    def ask(self, each: Sequence[Mapping[str, object]]) -> list[Evaluation]:
        """Evaluate designs that the record does not hold, and add them to it."""
        return [self._one(changes) for changes in each]

    def slopes(self, changes: Mapping[str, object]) -> Mapping[str, Mapping[str, float]] | None:
        """Derivatives of all asked figures by all variables; they are recorded beside the evaluation."""
        case, places = self._question.case, tuple(one.place for one in self._question.space.variables)
        key = designed(case, changes).key
        name = f"{key} slopes {' '.join((*places, *needed(self._question)))}"
        if name not in self._record:
            base = self._runs.get(key) or run(varied(case, changes))
            try:
                found = gradients(base, places, needed(self._question))
            except InputError as error:
                self._record.add(Evaluation(name, dict(changes), failure=str(error)))
            else:
                flat = {f"{figure} {place}": value for figure, row in found.items() for place, value in row.items()}
                self._record.add(Evaluation(name, dict(changes), flat))
        stored = self._record[name]
        if stored.failed:
            return None
        table: dict[str, dict[str, float]] = {}
        for both, value in stored.figures.items():
            figure, _, place = both.partition(" ")
            assert value is not None, "a slope is a number"
            table.setdefault(figure, {})[place] = value
        return with_own(self._question, changes, self._record[key].figures, table)

    def _one(self, changes: Mapping[str, object]) -> Evaluation:
        case = self._question.case
        key = designed(case, changes).key
        if key not in self._record:

            def keep(done: Run) -> None:
                self._runs[key] = done

            self._record.add(evaluate(case, changes, keep=keep))
            while len(self._runs) > _LATEST:
                del self._runs[next(iter(self._runs))]
        return self._record[key]


def is_slopes(evaluation: Evaluation) -> bool:
    """Whether a row of a record holds the slopes of a design and not its figures."""
    return " " in evaluation.key


def needed(question: Question) -> tuple[str, ...]:
    """The figures of a run that the asked ones are made of."""
    names: list[str] = []
    for name in question.figures:
        if name == "gain_loss":
            names.append("rms_half_path_fitted")
        elif name == "cost" and question.cost is not None:
            names += ["rms_half_path_fitted" if one == "gain_loss" else one for one in question.cost.names]
        else:
            names.append(name)
    return tuple(dict.fromkeys(name for name in names if name in FIGURES))


def with_own(
    question: Question,
    changes: Mapping[str, object],
    figures: Mapping[str, float | None],
    table: Mapping[str, Mapping[str, float]],
) -> dict[str, dict[str, float]]:
    """The derivatives with those of `gain_loss` and `cost`, by the chain rule."""
    told = question.told(changes, figures)
    places = [one.place for one in question.space.variables]
    found = {name: dict(row) for name, row in table.items()}
    error, lost = told.get("rms_half_path_fitted"), told.get("gain_loss")
    if error and lost is not None and "rms_half_path_fitted" in found:
        found["gain_loss"] = {place: 2 * lost / error * found["rms_half_path_fitted"][place] for place in places}
    if question.cost is not None and "cost" in question.figures:
        made = varied(question.case, changes)
        values = {}
        for name in question.cost.names:
            value = told[name] if name in told else number(made, name)
            values[name] = float("nan") if value is None else value
        found["cost"] = {
            place: sum(
                question.cost.slope(values, name)
                * (found[name][place] if name in found else _follows(question.case, changes, name, place))
                for name in question.cost.names
            )
            for place in places
        }
    return found


def _follows(case: Case, changes: Mapping[str, object], name: str, place: str) -> float:
    """How a setting follows a variable: by 1 itself, others as what the case left out does."""
    at = changes[place]
    assert isinstance(at, int | float), "only numbers have slopes"
    apart = _STEP * (abs(at) or 1.0)
    both = [number(varied(case, {**changes, place: at + sign * apart}), name) for sign in (-1, 1)]
    return (both[1] - both[0]) / (2 * apart)
