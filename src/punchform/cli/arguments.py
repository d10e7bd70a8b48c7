"""The arguments of every command."""

from __future__ import annotations

from argparse import ArgumentParser

from punchform.cli import options
from punchform.export.formats import FORMATS


def form(command: ArgumentParser) -> None:
    """The arguments of `form`."""
    options.case(command)
    options.folder(command)
    options.manners(command)


def drape(command: ArgumentParser) -> None:
    """The arguments of `drape`."""
    options.case(command)
    command.add_argument("--origin", metavar="X,Y", help="where the axis of the grid lies, such as '10 mm, 0 mm'")
    command.add_argument("--direction", metavar="ANGLE", help="direction of the first wires in plan, such as '30 deg'")
    command.add_argument(
        "--shear-limit", metavar="ANGLE", help="shear at which the net locks (where neighbouring wires touch)"
    )
    options.folder(command)
    options.manners(command)


def report(command: ArgumentParser) -> None:
    """The arguments of `report`."""
    command.add_argument("runs", metavar="RUN", nargs="+", help="folder that `punchform form` wrote; several: one page")
    group = command.add_argument_group("results")
    group.add_argument(
        "-o", "--output", metavar="FILE", help="page to write; without it one run gets its report.html, several a table"
    )
    group.add_argument("--overwrite", action="store_true", help="replace the file")
    options.manners(command, json="print the comparison as JSON, of one run its result.json")


def compare(command: ArgumentParser) -> None:
    """The arguments of `compare`."""
    command.add_argument("run", metavar="RUN", help="folder that `punchform form` wrote")
    command.add_argument("points", metavar="POINTS", help="measured points: csv, txt, xyz, asc, ply or stl")
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
    options.folder(command, overwrite="replace an earlier comparison in that folder")
    options.manners(command, json="print comparison.json instead of a summary")


def compensate(command: ArgumentParser) -> None:
    """The arguments of `compensate`."""
    options.case(command)
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
    options.folder(command)
    options.manners(command)


def sensitivity(command: ArgumentParser) -> None:
    """The arguments of `sensitivity`."""
    options.case(command)
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
    options.folder(
        command,
        required=False,
        output="folder for table, figure and report; none without it",
        overwrite="replace an earlier answer in that folder",
    )
    options.manners(command, json="print result.json instead of a table")


def punch(command: ArgumentParser) -> None:
    """The arguments of `punch`."""
    options.case(command)
    command.add_argument("--radius", metavar="LENGTH", help="how far the files reach (1.1 times the rim's)")
    command.add_argument("--step", metavar="LENGTH", help="distance of the points of the height field (a round one)")
    command.add_argument("--tolerance", metavar="LENGTH", help="how far facets may be from the punch (0.02 mm)")
    options.folder(command)
    options.manners(command)


def sweep(command: ArgumentParser) -> None:
    """The arguments of `sweep`."""
    options.case(command)
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
    options.sampling(command)
    options.growing_folder(command)
    options.manners(command, json="print sweep.json instead of a summary")


def tolerances(command: ArgumentParser) -> None:
    """The arguments of `tolerances`."""
    options.case(command, "; its [scatter] says what varies")
    command.add_argument(
        "--samples", metavar="N", type=int, default=200, help="how many samples; more go on from fewer; 200 when absent"
    )
    options.sampling(command)
    options.growing_folder(command)
    options.manners(command)


def optimise(command: ArgumentParser) -> None:
    """The arguments of `optimise`."""
    options.case(command, "; its [optimise] says what is wanted")
    options.growing_folder(command)
    options.manners(command)


def element(command: ArgumentParser) -> None:
    """The arguments of `element`."""
    options.case(command)
    command.add_argument("--axes", choices=("element", "paper"), default="element", help="axes of the matrices")
    command.add_argument("--plot", metavar="FILE", help="draw the wire and its deflections (png, svg or pdf)")
    options.manners(command, json="print the matrices and checks as JSON")


def materials(command: ArgumentParser) -> None:
    """The arguments of `materials`."""
    command.add_argument("name", metavar="NAME", nargs="?", help="a material, such as '304 annealed'")
    command.add_argument("-o", "--output", dest="plot", metavar="FILE", help="draw the flow curve (png, svg or pdf)")
    options.manners(command, json="print numbers and flow curves as JSON")


def export(command: ArgumentParser) -> None:
    """The arguments of `export`."""
    command.add_argument("run", metavar="RUN", help="folder that `punchform form` wrote")
    named = "; ".join(f"{name}: {format.what}" for name, format in FORMATS.items())
    command.add_argument(
        "--to", nargs="+", choices=(*FORMATS, "all"), metavar="FORMAT", required=True, help=f"{named}; or all of them"
    )
    options.folder(command, output="folder for the files", overwrite="replace earlier files in that folder")
    options.manners(command, json="print the list of files as JSON")


def new(command: ArgumentParser) -> None:
    """The arguments of `new`."""
    command.add_argument("file", metavar="FILE", help="file to write")
    command.add_argument("--overwrite", action="store_true", help="replace the file")
    options.manners(command, json=None)


def examples(command: ArgumentParser) -> None:
    """The arguments of `examples`."""
    command.add_argument("name", metavar="EXAMPLE", nargs="?", help="the one to copy; without it all are listed")
    command.add_argument("--all", dest="every", action="store_true", help="copy all of them into the folder -o")
    command.add_argument(
        "-o", "--output", metavar="FILE", help="file to copy to, or with --all the folder; NAME.toml here when absent"
    )
    command.add_argument("--overwrite", action="store_true", help="replace files")
    options.manners(command, json="print the list as JSON")


def check(command: ArgumentParser) -> None:
    """The arguments of `check`."""
    options.case(command)
    options.manners(command, json="print what is known of the case as JSON")


def schema(command: ArgumentParser) -> None:
    """`schema` takes none."""


def about(command: ArgumentParser) -> None:
    """The arguments of `about`."""
    command.add_argument("--json", dest="as_json", action="store_true", help="print them as JSON")


def completion(command: ArgumentParser) -> None:
    """The arguments of `completion`."""
    command.add_argument("shell", choices=("bash", "zsh", "fish"), help="the shell that is to complete")
