"""The options that several commands share, each added in one place, so that they read and behave alike."""

from __future__ import annotations

from argparse import ArgumentParser

CASE_HELP = "case file, or packaged:NAME for one that comes with the program (`punchform examples` lists them)"


def case(command: ArgumentParser, more: str = "") -> None:
    """The case that a command works on; more: words to add to its help."""
    command.add_argument("path", metavar="CASE", help=CASE_HELP + more)


def folder(
    command: ArgumentParser,
    *,
    required: bool = True,
    output: str = "folder for the results",
    overwrite: str = "replace an earlier run in that folder",
) -> None:
    """Where the results go: -o/--output and --overwrite."""
    group = command.add_argument_group("results")
    group.add_argument("-o", "--output", metavar="DIR", required=required, help=output)
    group.add_argument("--overwrite", action="store_true", help=overwrite)


def growing_folder(command: ArgumentParser) -> None:
    """The folder of a command that evaluates many designs and can go on with them; and who computes them."""
    folder(
        command,
        output="folder for the results; one that was begun is gone on with",
        overwrite="begin anew in a folder that was begun",
    )
    group = command.add_argument_group("computing")
    group.add_argument("--workers", metavar="N", type=int, help="processes on this machine; one for each core")
    group.add_argument(
        "--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers compute instead, such as tcp://host:8786"
    )


def sampling(command: ArgumentParser) -> None:
    """How designs are drawn and tabulated: --seed and --format."""
    command.add_argument("--seed", metavar="S", type=int, default=1, help="of the samples; 1 when absent")
    command.add_argument(
        "--format", choices=("csv", "parquet"), default="csv", help="parquet: table.parquet beside table.csv"
    )


def manners(command: ArgumentParser, *, json: str | None = "print result.json instead of a summary") -> None:
    """What is said: --quiet or --verbose, and --json with its help; None where a command prints no numbers."""
    group = command.add_argument_group("what is said")
    loudness = group.add_mutually_exclusive_group()
    loudness.add_argument("-q", "--quiet", action="store_true", help="results and errors only: no progress, no notes")
    loudness.add_argument("-v", "--verbose", action="store_true", help="tell every step, and the seconds it took")
    if json is not None:
        group.add_argument("--json", dest="as_json", action="store_true", help=json)
