"""`punchform check`: all that can be said about a case without solving it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from punchform import __version__
from punchform.case import Case, parse, read_text
from punchform.cli.exits import Exit
from punchform.cli.talk import notes
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.prepare import prepare
from punchform.shell import prepare_shell
from punchform.wire import Hardening


@dataclass(frozen=True)
class Checked:
    """What is known of a usable case: a sentence, the same as numbers, and notes."""

    words: str
    numbers: dict[str, Any]
    notes: tuple[str, ...] = ()


def check(path: str, *, voice: Voice, as_json: bool) -> Exit:
    """Check all that can be checked without solving. Raises InputError with everything that is wrong."""
    source = read_text(path)
    case = parse(source)
    try:
        found = _gridshell(case) if case.press.ends is not None else _pressed(case)
    except InputError as error:
        raise source.placed(error) from None
    if as_json:
        head = {"schema": 1, "version": __version__, "case": path, "case_title": case.title, "usable": True}
        content = {**head, **found.numbers, "notes": list(found.notes)}
        print(json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False))
    else:
        print(f"{path}: usable; {found.words}")
    notes(found.notes, voice)
    return Exit.DONE


def _gridshell(case: Case) -> Checked:
    laid, ends = prepare_shell(case).laid, case.press.ends or ()
    wires = sum(map(len, laid.nodes))
    return Checked(f"a gridshell of {wires} wires, {len(ends)} ends held", {"wires": wires, "ends_held": len(ends)})


def _pressed(case: Case) -> Checked:
    ready = prepare(case)
    if case.optimise is not None:
        from punchform.optimise.problem import question_of
        from punchform.optimise.search import way_of

        way_of(question_of(case))
    grid, law = ready.grid, ready.elements[0].hardening
    part = "a quarter of them solved" if grid.quarter else "all of them solved"
    whole = round(grid.copies * float(grid.node_weight[grid.crossings].sum()))
    numbers = {
        "crossings": whole,
        "quarter_solved": grid.quarter,
        "yield_strength_MPa": None if law is None else law.yield_strength,
        "necks_at_true_strain": None if law is None else law.breaks_at,
    }
    told = (*grid.notes, *(f"{doubt.where}: {doubt.message}" for doubt in ready.doubts))
    return Checked(f"{whole} crossings, {part}{_yielding(law)}", numbers, told)


def _yielding(law: Hardening | None) -> str:
    """At what stress the wires yield and when they break, as an ending of a sentence; nothing of elastic wires."""
    if law is None:
        return ""
    breaks = "" if law.breaks_at is None else f" and neck at a true strain of {law.breaks_at:.3f}"
    return f"; wires yield at {law.yield_strength:.4g} MPa{breaks}"
