"""Sensitivities told as tables: what one per cent of each number does, and how far each may be off."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from punchform import __version__
from punchform.optimise.figures import FIGURES
from punchform.optimise.sensitivity import Sensitivities, Sensitivity

PER_CENT = 0.01
UNVARIED = "cannot vary"
"""How the remark on a number begins that can have no other value."""
NEGLIGIBLE = 1e-9
"""An effect below this part of the largest one is none but rounding."""


@dataclass(frozen=True)
class Row:
    """One number as the tables tell it.

    effect: change of the figure, in its unit, by one per cent of the number, None where there is no slope; shape: rms
    of the move of the judged nodes by that [mm]; alone: how far the number may be off, to either side, if nothing else
    is; together: if all numbers with an effect are off at random; in the unit of the number, infinite without effect.
    """

    of: Sensitivity
    effect: float | None
    shape: float | None
    alone: float | None
    together: float | None

    @property
    def matters(self) -> bool:
        """Whether the number does anything to the figure."""
        return bool(self.effect)


@dataclass(frozen=True)
class Table:
    """The rows, what matters most first; figure: whose; rms [mm]: of the run; allowed [mm]: of it; None without target.

    compensated: tolerances are those of the shape once its mean error is gone, since that is too large already.
    """

    whole: Sensitivities
    figure: str
    rows: tuple[Row, ...]
    rms: float | None
    allowed: float | None
    compensated: bool


def table(whole: Sensitivities, figure: str, allowed: float | None) -> Table:
    """The table of one figure; allowed: the rms [mm] that must be kept, for the tolerances."""
    rms = whole.seen.figures["rms"]
    beyond = rms is not None and allowed is not None and rms >= allowed
    kept = None if rms is None or allowed is None else (0.0 if beyond else rms, allowed)
    shapes = _cleared([_by_per_cent(one, one.shape) for one in whole.rows])
    limits = [
        None if kept is None else math.inf if shape == 0.0 else one.tolerance(*kept)
        for one, shape in zip(whole.rows, shapes, strict=True)
    ]
    share = math.sqrt(max(sum(limit is not None and math.isfinite(limit) for limit in limits), 1))
    effects = _cleared(
        [None if one.how == "a step apart" else _by_per_cent(one, one.slopes.get(figure)) for one in whole.rows]
    )
    rows = [
        Row(one, effect, shape, limit, None if limit is None else limit / share)
        for one, effect, shape, limit in zip(whole.rows, effects, shapes, limits, strict=True)
    ]
    rows.sort(key=lambda row: -(abs(row.effect) if row.effect is not None else -1.0))
    return Table(whole, figure, tuple(rows), rms, allowed, beyond)


def csv(of: Table) -> str:
    """The table as CSV, units in the columns that need them."""
    unit = FIGURES[of.figure].unit
    head = f"place,value,unit,slope_{of.figure},change_by_1_percent_{unit or '-'},shape_by_1_percent_mm"
    lines = [f"{head},tolerance_alone,tolerance_together,how,remark"]
    for row in of.rows:
        cells = (row.of.slopes.get(of.figure), row.effect, row.shape, row.alone, row.together)
        numbers = (_cell(value) for value in cells)
        lines.append(
            ",".join((row.of.place, repr(row.of.value), row.of.unit, *numbers, row.of.how, f'"{row.of.remark}"'))
        )
    return "\n".join(lines) + "\n"


def result(tables: tuple[Table, ...]) -> dict[str, object]:
    """What result.json tells: plain values, None for what is not known or not finite."""
    first = tables[0]
    return {
        "schema": 1,
        "version": __version__,
        "kind": "sensitivity",
        "case_title": first.whole.case.title,
        "rms_mm": first.rms,
        "allowed_mm": first.allowed,
        "once_compensated": first.compensated,
        "figures": {name: first.whole.seen.figures[name] for name in first.whole.figures},
        "units": {name: FIGURES[name].unit for name in first.whole.figures},
        "runs": first.whole.runs,
        "factorisations": first.whole.factorisations,
        "why_differences": first.whole.why_differences,
        "numbers": [_plain(row) for row in first.rows],
    }


def _plain(row: Row) -> dict[str, object]:
    return {
        "place": row.of.place,
        "value": row.of.value,
        "unit": row.of.unit,
        "slopes": {name: _finite(slope) for name, slope in row.of.slopes.items()},
        "shape_mm_per_unit": row.of.shape,
        "tolerance_alone": _finite(row.alone),
        "tolerance_together": _finite(row.together),
        "how": row.of.how,
        "remark": row.of.remark,
    }


def _by_per_cent(one: Sensitivity, slope: float | None) -> float | None:
    return None if slope is None else PER_CENT * slope * (abs(one.value) or 1.0)


def _cleared(effects: list[float | None]) -> list[float | None]:
    """The effects without those that are rounding of larger ones."""
    least = NEGLIGIBLE * max((abs(effect) for effect in effects if effect is not None), default=0.0)
    return [0.0 if effect is not None and abs(effect) < least else effect for effect in effects]


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _cell(value: float | None) -> str:
    return "" if value is None else repr(value)


def without_effect(of: Table) -> tuple[str, ...]:
    """The places of numbers that do nothing to the figure."""
    return tuple(row.of.place for row in of.rows if row.effect is not None and not row.matters)


def shown(of: Table) -> Iterator[Row]:
    """The rows that matter or are not known, without those that cannot vary."""
    return (row for row in of.rows if row.matters or (row.effect is None and not row.of.remark.startswith(UNVARIED)))
