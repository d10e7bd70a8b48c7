"""The command line: parse, call one function, print, exit.

Results go to stdout, talk and progress to stderr. Whatever is heavy is imported inside the commands, so that
`punchform --help` answers at once.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from io import TextIOWrapper

from punchform.cli.exits import Exit
from punchform.cli.parser import parser
from punchform.cli.talk import say
from punchform.errors import InputError, NoEquilibrium

COMMANDS = {
    "form": "form:form",
    "drape": "drape:drape_case",
    "compare": "compare:compare_points",
    "compensate": "compensate:compensate_punch",
    "sensitivity": "sensitivity:sensitivity",
    "punch": "punch:punch_case",
    "export": "export:export_run",
    "sweep": "sweep:sweep_case",
    "optimise": "optimise:optimise_case",
    "tolerances": "tolerances:tolerances_of",
    "element": "element:element",
    "materials": "materials:materials_command",
    "new": "cases:new",
    "check": "check:check",
    "schema": "cases:schema",
    "about": "about:about",
}
"""The module and function of every command; a module is imported when its command is given."""


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
    """Call the function of the chosen command with the arguments by their names."""
    chosen = vars(arguments).copy()
    module, _, function = COMMANDS[chosen.pop("command")].partition(":")
    if "scheduler" in chosen:
        from punchform.cli.sweeping import Means

        chosen["means"] = Means(chosen.pop("workers"), chosen.pop("scheduler"), chosen.pop("quiet"))
    code: Exit = getattr(import_module(f"punchform.cli.{module}"), function)(**chosen)
    return code
