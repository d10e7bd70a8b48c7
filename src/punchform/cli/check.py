"""`punchform check`: all that can be said about a case without solving it."""

from __future__ import annotations

from punchform.case import parse, read_text
from punchform.cli.exits import Exit
from punchform.cli.talk import say
from punchform.errors import InputError
from punchform.prepare import prepare
from punchform.shell import prepare_shell
from punchform.wire import Hardening


def check(path: str) -> Exit:
    """Check all that can be checked without solving. Raises InputError with everything that is wrong."""
    source = read_text(path)
    case = parse(source)
    try:
        if case.press.ends is not None:
            laid = prepare_shell(case).laid
            print(f"{path}: usable; a gridshell of {sum(map(len, laid.nodes))} wires, {len(case.press.ends)} ends held")
            return Exit.DONE
        ready = prepare(case)
        if case.optimise is not None:
            from punchform.optimise.problem import question_of
            from punchform.optimise.search import way_of

            way_of(question_of(case))
    except InputError as error:
        raise source.placed(error) from None
    grid = ready.grid
    part = "a quarter of them solved" if grid.quarter else "all of them solved"
    whole = round(grid.copies * float(grid.node_weight[grid.crossings].sum()))
    print(f"{path}: usable; {whole} crossings, {part}{_yielding(ready.elements[0].hardening)}")
    for note in (*grid.notes, *(f"{doubt.where}: {doubt.message}" for doubt in ready.doubts)):
        say(f"note: {note}")
    return Exit.DONE


def _yielding(law: Hardening | None) -> str:
    """At what stress the wires yield and when they break, as an ending of a sentence; nothing of elastic wires."""
    if law is None:
        return ""
    breaks = "" if law.breaks_at is None else f" and neck at a true strain of {law.breaks_at:.3f}"
    return f"; wires yield at {law.yield_strength:.4g} MPa{breaks}"
