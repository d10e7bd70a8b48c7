"""The arguments of all commands: nothing heavy is imported here, so that `punchform --help` answers at once."""

from __future__ import annotations

import argparse
from typing import NoReturn

from punchform import __version__
from punchform.cli.exits import Exit
from punchform.cli.talk import say
from punchform.export.formats import FORMATS

CASE_HELP = (
    "case file, or packaged:check, packaged:paper, packaged:stretch, packaged:gridshell, packaged:design for a case "
    "that comes with the program"
)


class _Parser(argparse.ArgumentParser):
    """Says what is wrong with the arguments in the style of all other errors."""

    def error(self, message: str) -> NoReturn:
        # argparse takes -30deg for an option; behind an equals sign it is a value.
        option = message.split()[1].rstrip(":") if message.endswith("expected one argument") else ""
        hint = f"; a value that begins with a minus follows an equals sign: {option}=-..." if option else ""
        say(f"error: {message}\n  hint: see `{self.prog} --help`{hint}")
        raise SystemExit(int(Exit.UNUSABLE_INPUT))


def parser() -> argparse.ArgumentParser:
    """The parser of the whole command line."""
    codes = "\n".join(f"  {code.value:>3}  {code.sentence}" for code in Exit)
    whole = _Parser(
        prog="punchform",
        description="Predicts how a flat grid of wires becomes a shell when it is pressed over a punch.",
        epilog=f"exit codes:\n{codes}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    whole.add_argument("--version", action="version", version=f"punchform {__version__}")
    commands = whole.add_subparsers(dest="command", metavar="COMMAND", required=True)

    _add_run(commands.add_parser("form", help="press the grid of a case over its punch, or move its wire ends"))

    drape = commands.add_parser("drape", help="lay the grid over the punch with wires of constant length, no solve")
    _add_run(drape)
    drape.add_argument("--origin", metavar="X,Y", help="where the axis of the grid lies, such as '10 mm, 0 mm'")
    drape.add_argument("--direction", metavar="ANGLE", help="direction of the first wires in plan, such as '30 deg'")
    drape.add_argument(
        "--shear-limit", metavar="ANGLE", help="shear at which the net locks (where neighbouring wires touch)"
    )

    _add_compare(commands.add_parser("compare", help="hold measured points against the target and a run"))
    _add_compensate(commands.add_parser("compensate", help="find the punch whose released shape is the target"))

    _add_sensitivity(commands.add_parser("sensitivity", help="which numbers matter, and what tolerance each needs"))
    _add_punch(commands.add_parser("punch", help="the punch as files for the workshop: tables, drawing, solid"))
    _add_export(commands.add_parser("export", help="a run as files for the workshop and other programs"))
    _add_sweep(commands.add_parser("sweep", help="evaluate many designs of a case, into one table"))
    _add_optimise(commands.add_parser("optimise", help="search for the best design, as [optimise] of the case asks"))
    _add_tolerances(commands.add_parser("tolerances", help="what the scatter of wire, grid and tool does to accuracy"))

    element = commands.add_parser("element", help="the stiffness of one wire between two crossings")
    element.add_argument("path", metavar="CASE", help=CASE_HELP)
    element.add_argument(
        "--axes",
        choices=("element", "paper"),
        default="element",
        help="axes of the matrices",
    )
    element.add_argument("--json", dest="as_json", action="store_true", help="print the matrices and checks as JSON")
    element.add_argument("--plot", metavar="FILE", help="draw the wire and its deflections (png, svg or pdf)")

    materials = commands.add_parser(
        "materials", help="what wires are made of: all materials, or one with its flow curve"
    )
    materials.add_argument("name", metavar="NAME", nargs="?", help="a material, such as '304 annealed'")
    materials.add_argument("--json", dest="as_json", action="store_true", help="print numbers and flow curves as JSON")
    materials.add_argument("-o", "--output", dest="plot", metavar="FILE", help="draw the flow curve (png, svg or pdf)")

    new = commands.add_parser("new", help="write a commented case file to start from")
    new.add_argument("file", metavar="FILE", help="file to write")
    new.add_argument("--overwrite", action="store_true", help="replace the file")

    check = commands.add_parser("check", help="check a case file without running it")
    check.add_argument("path", metavar="CASE", help=CASE_HELP)

    commands.add_parser("schema", help="print the JSON schema of the case file")
    commands.add_parser("about", help="versions, platform, linear solver, cores, memory")
    return whole


def _add_run(command: argparse.ArgumentParser) -> None:
    """The arguments of a command that turns a case into a folder of results."""
    command.add_argument("path", metavar="CASE", help=CASE_HELP)
    command.add_argument("-o", "--output", metavar="DIR", required=True, help="folder for the results")
    command.add_argument("--overwrite", action="store_true", help="replace an earlier run in that folder")
    command.add_argument("--quiet", action="store_true", help="no progress and no notes")
    command.add_argument("--json", dest="as_json", action="store_true", help="print result.json instead of a summary")


def _add_sensitivity(command: argparse.ArgumentParser) -> None:
    """The arguments of `sensitivity`."""
    command.add_argument("path", metavar="CASE", help=CASE_HELP)
    command.add_argument("-o", "--output", metavar="DIR", help="folder for table, figure and report; none without it")
    command.add_argument(
        "--of", metavar="FIGURE", action="append", default=[], help="such as rms, apex, max_shear; rms when left out"
    )
    command.add_argument(
        "--vary",
        metavar="PLACE",
        action="append",
        default=[],
        help="a number of the case, such as wire.diameter; all of them when left out",
    )
    command.add_argument(
        "--allowed", metavar="LENGTH", help="the rms that must be kept, such as '0.5 mm'; else the target's tolerance"
    )
    command.add_argument(
        "--workers", metavar="N", type=int, help="processes for complete runs, where they are needed; one for each core"
    )
    command.add_argument("--overwrite", action="store_true", help="replace an earlier answer in that folder")
    command.add_argument("--quiet", action="store_true", help="no progress and no notes")
    command.add_argument("--json", dest="as_json", action="store_true", help="print result.json instead of a table")


def _add_punch(command: argparse.ArgumentParser) -> None:
    """The arguments of `punch`."""
    _add_run(command)
    command.add_argument("--radius", metavar="LENGTH", help="how far the files reach (1.1 times the rim's)")
    command.add_argument("--step", metavar="LENGTH", help="distance of the points of the height field (a round one)")
    command.add_argument("--tolerance", metavar="LENGTH", help="how far facets may be from the punch (0.02 mm)")


def _add_export(command: argparse.ArgumentParser) -> None:
    """The arguments of `export`."""
    command.add_argument("run", metavar="RUN", help="folder that `punchform form` wrote")
    formats = (*FORMATS, "all")
    command.add_argument(
        "--to", nargs="+", choices=formats, metavar="FORMAT", required=True, help=f"any of {', '.join(formats)}"
    )
    command.add_argument("-o", "--output", metavar="DIR", required=True, help="folder for the files")
    command.add_argument("--overwrite", action="store_true", help="replace earlier files in that folder")
    command.add_argument("--quiet", action="store_true", help="no talk")
    command.add_argument("--json", dest="as_json", action="store_true", help="print the list of files as JSON")


def _add_compare(command: argparse.ArgumentParser) -> None:
    """The arguments of `compare`."""
    command.add_argument("run", metavar="RUN", help="folder that `punchform form` wrote")
    command.add_argument("points", metavar="POINTS", help="measured points: csv, txt, xyz, asc, ply or stl")
    command.add_argument("-o", "--output", metavar="DIR", required=True, help="folder for the results")
    command.add_argument(
        "--units", choices=("mm", "cm", "m", "in"), help="unit of the points, where the file is silent"
    )
    command.add_argument(
        "--align",
        choices=("best-fit", "rim", "as-given"),
        default="best-fit",
        help="best-fit: least squares; rim: plane and circle of the rim points (3-2-1); as-given: not at all",
    )
    command.add_argument(
        "--fit-to",
        choices=("nodes", "target", "prediction"),
        help="what a best fit goes to; else nodes where points are named i:j, else the target, else the prediction",
    )
    command.add_argument(
        "--rim-points", metavar="NAMES", help="names of the points on the rim, such as 'R1,R2,R3' or 'R*'"
    )
    command.add_argument("--clock", metavar="NAME=ANGLE", help="direction of one point in plan, such as 'P7=90 deg'")
    command.add_argument(
        "--tolerance", metavar="LENGTH", help="largest rms, and band of the table, such as '0.5 mm'; else the target's"
    )
    command.add_argument(
        "--skip-bad-rows", action="store_true", help="leave out rows that cannot be read, and say which"
    )
    command.add_argument("--drop-outliers", action="store_true", help="leave outliers out of fit and statistics")
    command.add_argument("--overwrite", action="store_true", help="replace an earlier comparison in that folder")
    command.add_argument("--quiet", action="store_true", help="no notes")
    command.add_argument(
        "--json", dest="as_json", action="store_true", help="print comparison.json instead of a summary"
    )


def _add_sweep(command: argparse.ArgumentParser) -> None:
    """The arguments of `sweep`."""
    command.add_argument("path", metavar="CASE", help=CASE_HELP)
    command.add_argument(
        "--over",
        metavar="PLACE=VALUES",
        action="append",
        required=True,
        help="a setting and its values: 'wire.diameter=0.5 mm,0.6 mm' or 'grid.step=5 mm:10 mm:6' (low, high, count); "
        "several give all combinations; with --samples also 'grid.step=5 mm:10 mm'",
    )
    command.add_argument(
        "--samples", metavar="N", type=int, help="instead of all combinations so many designs of a Latin hypercube"
    )
    _add_sampling(command)
    _add_many(command)


def _add_tolerances(command: argparse.ArgumentParser) -> None:
    """The arguments of `tolerances`."""
    command.add_argument("path", metavar="CASE", help=CASE_HELP + "; its [scatter] says what varies")
    command.add_argument(
        "--samples", metavar="N", type=int, default=200, help="how many samples; more go on from fewer; 200 when absent"
    )
    _add_sampling(command)
    _add_many(command)


def _add_optimise(command: argparse.ArgumentParser) -> None:
    """The arguments of `optimise`."""
    command.add_argument("path", metavar="CASE", help=CASE_HELP)
    _add_many(command)


def _add_sampling(command: argparse.ArgumentParser) -> None:
    """The arguments of a command that draws designs and tabulates them."""
    command.add_argument("--seed", metavar="S", type=int, default=1, help="of the samples; 1 when absent")
    command.add_argument(
        "--format", choices=("csv", "parquet"), default="csv", help="parquet: table.parquet beside table.csv"
    )


def _add_many(command: argparse.ArgumentParser) -> None:
    """The arguments of a command that evaluates many designs in a folder that it can go on with."""
    command.add_argument(
        "-o",
        "--output",
        metavar="DIR",
        required=True,
        help="folder for the results; one that was begun is gone on with",
    )
    command.add_argument("--workers", metavar="N", type=int, help="processes on this machine; one for each core")
    command.add_argument(
        "--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers compute instead, such as tcp://host:8786"
    )
    command.add_argument("--overwrite", action="store_true", help="begin anew in a folder that was begun")
    command.add_argument("--quiet", action="store_true", help="no progress and no notes")
    command.add_argument(
        "--json", dest="as_json", action="store_true", help="print the result as JSON instead of a summary"
    )


def _add_compensate(command: argparse.ArgumentParser) -> None:
    """The arguments of `compensate`."""
    _add_run(command)
    command.add_argument(
        "--surface",
        choices=("field", "revolution", "lobes"),
        default="field",
        help="what the punch may become: field: any smooth surface; revolution: what a lathe makes; lobes: the same "
        "with four lobes added",
    )
    command.add_argument(
        "--solves", metavar="N", default="6", help="presses and releases at most, that of the given punch included"
    )
    command.add_argument(
        "--relaxation", metavar="SHARE", default="1", help="which part of the error a step answers, above 0 up to 1"
    )
    command.add_argument("--to", metavar="LENGTH", help="rms to reach, such as '0.05 mm'; else the target's tolerance")
    command.add_argument(
        "--compare", action="store_true", help="search the other kinds of surface to their end too, with as many solves"
    )
    command.add_argument(
        "--response", action="store_true", help="measure which part of the error the punch can reach; takes more solves"
    )
