"""The report of sensitivities: what matters most, and the tolerance that each number needs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from punchform.optimise.figures import FIGURES, in_its_tool
from punchform.optimise.tolerance_table import Row, Table, shown, without_effect
from punchform.report.figures.files import save
from punchform.report.figures.picture import Picture
from punchform.report.figures.tornado import draw_tornado
from punchform.report.page import FIGURES as FOLDER
from punchform.report.page import PAGE, render
from punchform.report.section import Matrix, Section
from punchform.report.words import size
from punchform.run import Run

UNCRITICAL = 0.5
"""A number that may be off by this part of itself needs no tolerance; a slope says nothing so far away."""


def write_sensitivity_report(tables: tuple[Table, ...], folder: Path) -> None:
    """Write `folder`/figures/tornado_*.png and `folder`/report.html. Raises OSError when the disk refuses."""
    (folder / FOLDER).mkdir(parents=True, exist_ok=True)
    images = []
    for table in tables:
        path = folder / FOLDER / f"tornado_{table.figure}.png"
        save(draw_tornado(table), path)
        figure = FIGURES[table.figure]
        caption = (
            f"How much {table.figure} ({figure.words}) changes when one number grows by one per cent. The top bars are "
            "what to hold tightly, or to change on purpose; numbers without a bar may be chosen by price."
        )
        title = f"What {table.figure} depends on"
        images.append((Picture(path.stem, title, caption, _drawn(table), wide=True, section="tolerances"), path))
    first = tables[0]
    html = render(
        first.whole.case,
        subtitle="Which numbers of the case matter, and how exactly each must be kept",
        good=first.rms is None or first.allowed is None or first.rms < first.allowed,
        verdict=words(first),
        sections=(Section("tolerances", "Tolerances", matrices=tuple(map(_matrix, tables))),),
        results=(),
        details_title="How it was found",
        details=(("Effort", _effort(first)),),
        images=tuple(images),
        notes=_remarks(first),
        beside="sensitivity.csv (the table), result.json, case.toml",
    )
    (folder / PAGE).write_text(html, encoding="utf-8", newline="\n")


def _drawn(table: Table) -> Callable[[Run], Figure]:
    return lambda _: draw_tornado(table)


def words(table: Table) -> tuple[str, ...]:
    """What to conclude, in sentences."""
    told = []
    ranked = [row for row in table.rows if row.matters]
    if ranked:
        first, unit = ranked[0], FIGURES[table.figure].unit
        step = _amount(0.01 * first.of.value, first)
        change = f"{_signed(first.effect or 0.0)} {unit}".rstrip()
        more = f"1 % more of it ({step}) changes it by {change}"
        told.append(f"The figure {table.figure} depends most on {first.of.place}: {more}.")
    if table.rms is None or table.allowed is None:
        told.append("The case has no [target], so no tolerances follow.")
    elif table.compensated:
        told.append(
            f"The rms of {size(table.rms, 'mm')} is beyond the {size(table.allowed, 'mm')} that is allowed, whatever "
            "the tolerances: first bring the shape in (`punchform compensate`). The tolerances here are those of a "
            "punch that is compensated until next to nothing is left; of its `case.toml` those that remain are told."
        )
    else:
        told += _tightest(table, table.rms, table.allowed)
    if table.rms is not None and table.rms < max((row.shape or 0.0 for row in table.rows), default=0.0):
        told.append("The rms is so small that it has no slope; how far 1 % moves the shape says what a number does.")
    told += [f"{sentence[0].upper()}{sentence[1:]}." for sentence in in_its_tool(table.whole.case)]
    idle = without_effect(table)
    if idle:
        told.append(f"Without effect: {', '.join(idle)}.")
    return tuple(told)


def _tightest(table: Table, rms: float, allowed: float) -> list[str]:
    """Which number needs the smallest part of its value, and how much that is."""
    known = [(row.alone / abs(row.of.value), row) for row in table.rows if row.alone is not None and row.of.value]
    if not known:
        return []
    part, row = min(known, key=lambda pair: pair[0])
    if part >= UNCRITICAL:
        return []
    return [
        f"The rms of {size(rms, 'mm')} may grow to {size(allowed, 'mm')}: the tightest number is {row.of.place}, "
        f"which may be off by {_off(row.alone, row)} if all others are right."
    ]


def lines(table: Table) -> list[str]:
    """The table as text, with bars: a tornado for the terminal."""
    rows = list(shown(table))
    most = max((abs(row.effect or 0.0) for row in rows), default=0.0) or 1.0
    unit = FIGURES[table.figure].unit
    heads = ("number", "value", f"{table.figure} by +1 %" + (f" [{unit}]" if unit else ""), "", "may be off by", "")
    cells = [heads]
    for row in rows:
        effect = _effect(row)
        bar = ("+" if (row.effect or 0.0) > 0 else "-") * round(24 * abs(row.effect or 0.0) / most)
        cells.append((row.of.place, _amount(row.of.value, row), effect, bar, _off(row.alone, row), row.of.remark))
    widths = [max(len(line[column]) for line in cells) for column in range(5)]
    return [
        "  " + "  ".join((*(cell.ljust(w) for cell, w in zip(line, widths, strict=False)), line[5])).rstrip()
        for line in cells
    ]


def _matrix(table: Table) -> Matrix:
    unit = FIGURES[table.figure].unit
    head = (
        "number", "value", f"change by +1 %{f' [{unit}]' if unit else ''}", "shape by 1 % [mm]",
        "may be off by, alone", "with all others off",
    )  # fmt: skip
    rows = tuple(
        (
            row.of.place,
            _amount(row.of.value, row),
            _effect(row),
            "not known" if row.shape is None else f"{row.shape:.3g}",
            _off(row.alone, row),
            _off(row.together, row),
        )
        for row in shown(table)
    )
    note = (
        "Shape: rms of how far the judged crossings move. Alone: the rms stays within what is allowed if only this "
        "number is off; with all others off: if all are, at random."
    )
    return Matrix(f"What {table.figure} depends on", head, rows, note=note, wide=True)


def _effort(table: Table) -> tuple[tuple[str, str], ...]:
    whole = table.whole
    rows = [("Factorisations beyond the run itself", f"{whole.factorisations}"), ("Runs beside it", f"{whole.runs}")]
    if whole.why_differences:
        rows.append(("Complete runs on both sides, because", whole.why_differences))
    return tuple(rows)


def _remarks(table: Table) -> tuple[str, ...]:
    return tuple(f"{row.of.place}: {row.of.remark}" for row in table.rows if row.of.remark)


def _effect(row: Row) -> str:
    if row.effect is not None:
        return _signed(row.effect)
    return "in steps" if row.of.how == "a step apart" else "not known"


def _off(value: float | None, row: Row) -> str:
    if value is None:
        return "not known"
    return "more than half" if value >= UNCRITICAL * abs(row.of.value) else f"± {_amount(value, row)}"


def _amount(value: float, row: Row) -> str:
    return f"{value:.4g} {row.of.unit}".rstrip()


def _signed(value: float) -> str:
    return f"{value:+.3g}"
