"""`punchform element`: the 6 x 6 stiffness of one wire between two crossings."""

from __future__ import annotations

import json
from typing import Literal

from punchform.case import parse, read_text
from punchform.cli.exits import Exit
from punchform.cli.pictures import picture_file
from punchform.cli.talk import say
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.wire import Element, describe, plot_element, stiffness


def element(path: str, *, axes: Literal["element", "paper"], as_json: bool, plot: str | None, voice: Voice) -> Exit:
    """Print stiffness, flexibility and checks of the wire of a case; both families when they differ.

    The JSON has the wire along x at the top and, when the steps differ, the one along y in `second_family`.
    """
    image = None if plot is None else picture_file(plot, "such as --plot wire.png")
    source = read_text(path)
    case = parse(source)
    try:
        elements = _distinct(*stiffness(case.wire, case.grid.step))
    except InputError as error:
        raise source.placed(error) from None
    reports = [describe(one, axes=axes) for one in elements]
    if as_json:
        content = reports[0].json_ready()
        if len(reports) > 1:
            content["second_family"] = reports[1].json_ready()
        print(json.dumps(content, indent=2, allow_nan=False))
    else:
        print("\n\n".join(report.text() for report in reports))
    if image is not None:
        for number, one in enumerate(elements):
            target = image if number == 0 else image.with_stem(f"{image.stem}-y")
            plot_element(one, target)
            if voice is not Voice.QUIET:
                say(f"drew {target}")
    return Exit.DONE


def _distinct(first: Element, second: Element) -> tuple[Element, ...]:
    return (first,) if second is first else (first, second)
