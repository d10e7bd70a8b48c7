"""Examples for the help of every command; the tests parse each of them and run those that take no time."""

from __future__ import annotations

from dataclasses import dataclass

FIRST_STEPS = """\
first steps:
    punchform new dish.toml                      a commented case to start from; edit it
    punchform check dish.toml                    is it usable? all that is wrong, line by line
    punchform form dish.toml -o runs/dish        press it; then open runs/dish/report.html
    punchform examples                           cases to look at and to copy"""


@dataclass(frozen=True)
class Example:
    """A line as it is typed, and what it is for."""

    line: str
    gives: str


EXAMPLES: dict[str, tuple[Example, ...]] = {
    "new": (
        Example("punchform new dish.toml", "a first dish; every setting stands in it with a comment"),
        Example("punchform new dish.toml --overwrite", "again from the beginning"),
    ),
    "examples": (
        Example("punchform examples", "what comes with the program, and how long each takes"),
        Example("punchform examples check -o my_dish.toml", "a copy of one, to change"),
        Example("punchform examples --all -o cases", "all of them, into the folder cases"),
    ),
    "check": (
        Example("punchform check dish.toml", "every problem of the file at once, each with its line"),
        Example("punchform check packaged:check --json", "crossings and doubts, for a program"),
    ),
    "materials": (
        Example("punchform materials", "the table of all materials"),
        Example("punchform materials '304 annealed'", "one with its flow curve and where its numbers come from"),
        Example("punchform materials '304 annealed' -o curve.png", "its flow curve drawn"),
    ),
    "element": (
        Example("punchform element dish.toml", "stiffness, flexibility and checks of a wire between two crossings"),
        Example("punchform element dish.toml --plot wire.png", "the wire and its deflections drawn"),
        Example("punchform element packaged:paper --axes paper --json", "the matrices of the paper, for a program"),
    ),
    "form": (
        Example("punchform form dish.toml -o runs/dish", "the run folder; open its report.html first"),
        Example("punchform form dish.toml -o runs/dish --overwrite", "again after the case was changed"),
        Example("punchform form packaged:check -o runs/check --verbose", "with every step of every stroke"),
        Example("punchform form dish.toml -o runs/dish2 --quiet --json", "result.json, for a program"),
    ),
    "drape": (
        Example("punchform drape dish.toml -o runs/net", "positions, shear and the flat outline, in a moment"),
        Example("punchform drape dish.toml -o runs/net45 --direction '45 deg'", "wires laid across the axes"),
        Example("punchform drape dish.toml -o runs/lock --shear-limit '30 deg'", "a mesh that locks at 30 degrees"),
    ),
    "report": (
        Example("punchform report runs/dish", "its report anew, from what the run folder keeps"),
        Example("punchform report runs/dish runs/fine", "a table of both, and which is nearer to the wanted shape"),
        Example("punchform report runs/dish runs/fine -o both.html", "the same as a page, with the figures"),
    ),
    "compare": (
        Example("punchform compare runs/dish points.csv -o runs/part", "measured points, laid over by a best fit"),
        Example(
            "punchform compare runs/dish scan.stl -o runs/scan --units mm --tolerance '0.5 mm'",
            "a scan, judged by a tolerance",
        ),
        Example(
            "punchform compare runs/dish points.csv -o runs/rim --align rim --rim-points 'R*' --clock 'P7=90 deg'",
            "aligned by the rim, as on a turning table",
        ),
    ),
    "compensate": (
        Example("punchform compensate dish.toml -o runs/punch", "any smooth punch, for a milling machine"),
        Example("punchform compensate dish.toml -o runs/lathe --surface revolution", "a punch that a lathe makes"),
        Example("punchform compensate dish.toml -o runs/fine --to '0.05 mm' --solves 10", "nearer, with more solves"),
    ),
    "sensitivity": (
        Example("punchform sensitivity dish.toml", "all numbers of the case, on the rms"),
        Example("punchform sensitivity dish.toml --vary wire.diameter --vary grid.step -o runs/two", "two of them"),
        Example("punchform sensitivity dish.toml --of max_shear --of apex --json", "other figures, for a program"),
    ),
    "sweep": (
        Example(
            "punchform sweep dish.toml --over 'wire.diameter=0.5 mm:0.9 mm:5' -o runs/wires", "five wires in one table"
        ),
        Example(
            "punchform sweep dish.toml --over 'grid.step=8 mm,10 mm' --over grid.crossing=pinned,welded -o runs/grids",
            "all four combinations",
        ),
        Example(
            "punchform sweep dish.toml --over 'wire.diameter=0.5 mm:0.9 mm' --samples 50 --workers 4 -o runs/cloud",
            "fifty samples in four processes; stopped, the same command goes on",
        ),
    ),
    "tolerances": (
        Example("punchform tolerances dish.toml -o runs/scatter", "200 samples of [scatter]: the share of good parts"),
        Example("punchform tolerances dish.toml -o runs/scatter --samples 1000", "800 more, in the same folder"),
    ),
    "optimise": (
        Example("punchform optimise packaged:design -o runs/design", "the design that [optimise] of the case asks for"),
        Example("punchform optimise packaged:design -o runs/design2 --workers 4 --json", "in four processes"),
    ),
    "export": (
        Example("punchform export runs/dish --to vtp -o files", "the wires with all their fields, for ParaView"),
        Example("punchform export runs/dish --to all -o files --json", "every format, and the list of files as JSON"),
    ),
    "punch": (
        Example("punchform punch dish.toml -o runs/tool", "tables, drawing (DXF) and solid (STL) of the punch"),
        Example("punchform punch dish.toml -o runs/fine --tolerance '5 um' --step '1 mm'", "finer facets and points"),
    ),
    "schema": (
        Example("punchform schema", "the keys of a case file with their limits and meaning"),
        Example("punchform schema > case.schema.json", "for an editor that completes TOML"),
    ),
    "about": (
        Example("punchform about", "what a report of a fault should contain"),
        Example("punchform about --json", "the same for a program"),
    ),
    "completion": (
        Example("punchform completion bash > ~/.local/share/bash-completion/completions/punchform", "for bash"),
        Example("punchform completion zsh > ~/.zfunc/_punchform", "for zsh, where ~/.zfunc is in $fpath"),
        Example("punchform completion fish > ~/.config/fish/completions/punchform.fish", "for fish"),
    ),
}
"""The examples of every command."""


def examples_of(command: str) -> str:
    """The examples of a command as the end of its help."""
    lines = [f"  {one.line}\n      {one.gives}" for one in EXAMPLES[command]]
    return "\n".join(["examples:", *lines])
