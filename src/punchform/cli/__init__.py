"""The command line: parse, call one function, print, exit.

Results go to stdout, talk and progress to stderr. Whatever is heavy is imported inside the commands, so that
`punchform --help` answers at once.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from io import TextIOWrapper
from typing import TYPE_CHECKING

from punchform.cli.exits import Exit
from punchform.cli.parser import parser
from punchform.cli.talk import say
from punchform.errors import InputError, NoEquilibrium

if TYPE_CHECKING:
    from punchform.cli.sweeping import Means


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line `argv` (sys.argv without the program's name when None); returns the exit code."""
    # A console of another encoding shows a question mark for a letter it lacks, instead of a traceback.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        arguments = parser().parse_args(argv)
    except SystemExit as ending:
        return ending.code if isinstance(ending.code, int) else Exit.DONE
    return int(_guarded(arguments))


def _guarded(arguments: argparse.Namespace) -> Exit:
    """Run the chosen command; what goes wrong on the user's side becomes words and an exit code."""
    try:
        code = _run(arguments)
        sys.stdout.flush()
        return code
    except InputError as error:
        say(str(error))
        return Exit.UNUSABLE_INPUT
    except NoEquilibrium as error:
        say(f"error: {error}")
        return Exit.NO_EQUILIBRIUM
    except KeyboardInterrupt:
        say("interrupted")
        return Exit.INTERRUPTED
    except BrokenPipeError:
        # The reader has seen enough; Python must not complain about the rest when it exits.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return Exit.DONE
    except MemoryError:
        say("error: the memory is not enough\n  hint: take a larger grid.step or a smaller blank")
        return Exit.UNUSABLE_INPUT
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        say(f"error: {place}{error.strerror or error}")
        return Exit.UNUSABLE_INPUT


def _run(arguments: argparse.Namespace) -> Exit:
    match arguments.command:
        case "form":
            from punchform.cli.form import form

            return form(
                arguments.case,
                arguments.output,
                overwrite=arguments.overwrite,
                quiet=arguments.quiet,
                as_json=arguments.json,
            )
        case "drape":
            from punchform.cli.drape import drape_case

            return drape_case(
                arguments.case,
                arguments.output,
                overwrite=arguments.overwrite,
                quiet=arguments.quiet,
                as_json=arguments.json,
                origin=arguments.origin,
                direction=arguments.direction,
                shear_limit=arguments.shear_limit,
            )
        case "compare":
            from punchform.cli.compare import compare_points

            return compare_points(
                arguments.run,
                arguments.points,
                arguments.output,
                units=arguments.units,
                align=arguments.align,
                fit_to=arguments.fit_to,
                rim_points=arguments.rim_points,
                clock=arguments.clock,
                tolerance=arguments.tolerance,
                skip_bad_rows=arguments.skip_bad_rows,
                drop_outliers=arguments.drop_outliers,
                overwrite=arguments.overwrite,
                quiet=arguments.quiet,
                as_json=arguments.json,
            )
        case "compensate":
            from punchform.cli.compensate import compensate_punch

            return compensate_punch(
                arguments.case,
                arguments.output,
                surface=arguments.surface,
                solves=arguments.solves,
                relaxation=arguments.relaxation,
                to=arguments.to,
                compare=arguments.compare,
                response=arguments.response,
                overwrite=arguments.overwrite,
                quiet=arguments.quiet,
                as_json=arguments.json,
            )
        case "sensitivity":
            from punchform.cli.sensitivity import sensitivity

            return sensitivity(
                arguments.case,
                arguments.output,
                of=arguments.of,
                vary=arguments.vary,
                allowed=arguments.allowed,
                overwrite=arguments.overwrite,
                quiet=arguments.quiet,
                as_json=arguments.json,
            )
        case "punch":
            from punchform.cli.punch import punch_case

            return punch_case(
                arguments.case,
                arguments.output,
                overwrite=arguments.overwrite,
                quiet=arguments.quiet,
                as_json=arguments.json,
                radius=arguments.radius,
                step=arguments.step,
                tolerance=arguments.tolerance,
            )
        case "sweep":
            from punchform.cli.sweep import sweep_case

            return sweep_case(
                arguments.case,
                arguments.output,
                over=arguments.over,
                samples=arguments.samples,
                seed=arguments.seed,
                means=_means(arguments),
                format=arguments.format,
                overwrite=arguments.overwrite,
                as_json=arguments.json,
            )
        case "optimise":
            from punchform.cli.optimise import optimise_case

            return optimise_case(
                arguments.case,
                arguments.output,
                means=_means(arguments),
                overwrite=arguments.overwrite,
                as_json=arguments.json,
            )
        case "tolerances":
            from punchform.cli.tolerances import tolerances_of

            return tolerances_of(
                arguments.case,
                arguments.output,
                samples=arguments.samples,
                seed=arguments.seed,
                means=_means(arguments),
                format=arguments.format,
                overwrite=arguments.overwrite,
                as_json=arguments.json,
            )
        case "element":
            from punchform.cli.element import element

            return element(arguments.case, axes=arguments.axes, as_json=arguments.json, plot=arguments.plot)
        case "materials":
            from punchform.cli.materials import materials_command

            return materials_command(arguments.name, as_json=arguments.json, plot=arguments.output)
        case "new":
            from punchform.cli.cases import new

            return new(arguments.file, overwrite=arguments.overwrite)
        case "check":
            from punchform.cli.check import check

            return check(arguments.case)
        case "schema":
            from punchform.cli.cases import schema

            return schema()
        case _:
            from punchform.cli.about import about

            return about()


def _means(arguments: argparse.Namespace) -> Means:
    from punchform.cli.sweeping import Means

    return Means(arguments.workers, arguments.scheduler, arguments.quiet)
