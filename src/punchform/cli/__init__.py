"""The command line: parse, call one function, print, exit.

Results go to stdout, talk and progress to stderr. Whatever is heavy is imported inside the commands, so that
`punchform --help` answers at once.
"""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Sequence
from errno import ENOSPC
from importlib import import_module
from io import TextIOWrapper
from time import perf_counter
from typing import Any

from punchform.cli.exits import Exit
from punchform.cli.parser import parsed
from punchform.cli.stopping import Left, Stop, Terminated, stoppable
from punchform.cli.talk import say
from punchform.cli.voice import Voice
from punchform.errors import InputError, NoEquilibrium

COMMANDS = {
    "form": "form:form",
    "drape": "drape:drape_case",
    "report": "report:report",
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
    "examples": "examples:examples",
    "check": "check:check",
    "schema": "cases:schema",
    "about": "about:about",
    "completion": "completion:completion",
}
"""The module and function of every command; a module is imported when its command is given."""
REPORT_IT = "please report it with the case file and the command; --verbose shows where it happened"


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line `argv` (sys.argv without the program's name when None); returns the exit code."""
    # A console of another encoding shows a question mark for a letter it lacks, instead of a traceback.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")
    with stoppable() as stop:
        try:
            chosen = parsed(sys.argv[1:] if argv is None else argv)
        except SystemExit as ending:
            return ending.code if isinstance(ending.code, int) else Exit.DONE
        except KeyboardInterrupt as ending:
            return int(_ended_by(ending, Left({})))
        return int(_guarded(chosen, stop))


def _guarded(chosen: dict[str, Any], stop: Stop) -> Exit:
    """Run the chosen command; what goes wrong on the user's side becomes words and an exit code."""
    left = Left(chosen)
    try:
        code = _run(chosen)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt as ending:
        return _ended_by(ending, left)
    except InputError as error:
        say(str(error))
        return Exit.UNUSABLE_INPUT
    except NoEquilibrium as error:
        say(f"error: {error}")
        return Exit.NO_EQUILIBRIUM
    except BrokenPipeError:
        # The reader has seen enough; Python must not complain about the rest when it exits.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return Exit.DONE
    except MemoryError:
        say("error: the memory is not enough\n  hint: take a larger grid.step or a smaller blank")
        return Exit.UNUSABLE_INPUT
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        full = "\n  hint: free some space, or name another place" if error.errno == ENOSPC else ""
        say(f"error: {place}{error.strerror or error}{full}")
        return Exit.UNUSABLE_INPUT
    except Exception as fault:
        # An interrupt inside a library may come out as something else.
        if stop.asked:
            return _ended_by(KeyboardInterrupt(), left)
        if chosen.get("verbose"):
            traceback.print_exception(fault)
        say(f"error: a fault of punchform itself: {type(fault).__name__}: {fault}\n  hint: {REPORT_IT}")
        return Exit.FAULT


def _ended_by(ending: KeyboardInterrupt, left: Left) -> Exit:
    code = Exit.TERMINATED if isinstance(ending, Terminated) else Exit.INTERRUPTED
    say(left.words(code))
    return code


def _run(chosen: dict[str, Any]) -> Exit:
    """Call the function of the chosen command with the arguments by their names."""
    begun = perf_counter()
    given = chosen.copy()
    module, _, function = COMMANDS[given.pop("command")].partition(":")
    if "verbose" in given:
        given["voice"] = Voice.of(quiet=given.pop("quiet"), verbose=given.pop("verbose"))
    if "scheduler" in given:
        from punchform.cli.sweeping import Means

        given["means"] = Means(given.pop("workers"), given.pop("scheduler"), given.pop("voice"))
    code: Exit = getattr(import_module(f"punchform.cli.{module}"), function)(**given)
    if chosen.get("verbose"):
        say(f"{perf_counter() - begun:8.2f} s in all")
    return code
