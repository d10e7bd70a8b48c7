"""The parser of the whole command line: nothing heavy is imported here, so that `punchform --help` answers at once."""

from __future__ import annotations

import argparse
import re
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, NoReturn

from punchform import __version__
from punchform.cli import arguments
from punchform.cli.exits import Exit
from punchform.cli.talk import say
from punchform.cli.usage import FIRST_STEPS, examples_of


@dataclass(frozen=True)
class Command:
    """A command: what it does, in a line, and what gives it its arguments."""

    does: str
    add: Callable[[argparse.ArgumentParser], None]


GROUPS: dict[str, dict[str, Command]] = {
    "start": {
        "new": Command("write a commented case file to start from", arguments.new),
        "examples": Command("list the cases that come with the program, or copy them", arguments.examples),
        "check": Command("check a case file without running it", arguments.check),
        "materials": Command("what wires are made of: all materials, or one with its flow curve", arguments.materials),
        "element": Command("the stiffness of one wire between two crossings", arguments.element),
    },
    "form": {
        "form": Command("press the grid of a case over its punch, or move its wire ends", arguments.form),
        "drape": Command("lay the grid over the punch with wires of constant length, no solve", arguments.drape),
    },
    "judge": {
        "report": Command("the report of a run anew, or several runs side by side", arguments.report),
        "compare": Command("hold measured points against the target and a run", arguments.compare),
        "sensitivity": Command("which numbers matter, and what tolerance each needs", arguments.sensitivity),
        "tolerances": Command("what the scatter of wire, grid and tool does to accuracy", arguments.tolerances),
    },
    "improve": {
        "compensate": Command("find the punch whose released shape is the target", arguments.compensate),
        "sweep": Command("evaluate many designs of a case, into one table", arguments.sweep),
        "optimise": Command("search for the best design, as [optimise] of the case asks", arguments.optimise),
    },
    "export": {
        "punch": Command("the punch as files for the workshop: tables, drawing, solid", arguments.punch),
        "export": Command("a run as files for the workshop and other programs", arguments.export),
    },
    "about the program": {
        "schema": Command("print the JSON schema of the case file", arguments.schema),
        "about": Command("versions, platform, linear solver, cores, memory", arguments.about),
        "completion": Command("print the script with which a shell completes commands", arguments.completion),
    },
}
"""The commands, by what one wants to do."""


class _Parser(argparse.ArgumentParser):
    """Says what is wrong with the arguments in the style of all other errors."""

    def error(self, message: str) -> NoReturn:
        wrong = re.match(r"argument (.+?): invalid choice: '?(.*?)'? \(choose from (.*)\)", message)
        if wrong is not None:
            what, given, known = wrong[1], wrong[2], re.findall(r"[^\s',]+", wrong[3])
            said = f"there is no command '{given}'" if what == "COMMAND" else f"{what} {given}: no such choice"
            self.refuse(said, near(given, known) or f"there are: {', '.join(known)}")
        # argparse takes -30deg for an option; behind an equals sign it is a value.
        option = message.split()[1].rstrip(":") if message.endswith("expected one argument") else ""
        self.refuse(
            message, f"a value that begins with a minus follows an equals sign: {option}=-..." if option else ""
        )

    def refuse(self, message: str, hint: str = "") -> NoReturn:
        """Say what is wrong, what may have been meant and where to look, and end."""
        say(f"error: {message}\n  hint: {hint}{'; ' if hint else ''}see `{self.prog} --help`")
        raise SystemExit(int(Exit.UNUSABLE_INPUT))

    @property
    def option_names(self) -> list[str]:
        """All long and short options."""
        return [name for action in self._actions for name in action.option_strings]


class _Whole(_Parser):
    """The parser of the whole command line, whose help is ordered by what one wants to do."""

    commands: dict[str, _Parser]

    def format_help(self) -> str:
        width = self._get_formatter()._width
        column = 2 + max(len(name) for group in GROUPS.values() for name in group)
        parts = [f"usage: {self.prog} COMMAND ...\n", textwrap.fill(self.description or "", width) + "\n"]
        for title, group in GROUPS.items():
            parts.append(f"{title}:")
            for name, command in group.items():
                first = f"    {name:<{column}}"
                parts.append(textwrap.fill(first + command.does, width, subsequent_indent=" " * len(first)))
            parts.append("")
        parts += ["options:", "    -h, --help    show this help; `punchform COMMAND --help` tells all of a command"]
        parts += ["    --version     show the version", "", FIRST_STEPS, "", "exit codes:"]
        parts += [f"  {code.value:>3}  {code.sentence}" for code in Exit]
        return "\n".join(parts) + "\n"


def parser() -> _Whole:
    """The parser of the whole command line."""
    whole = _Whole(
        prog="punchform",
        description="Predicts how a flat grid of wires becomes a shell when it is pressed over a punch.",
    )
    whole.add_argument("--version", action="version", version=f"punchform {__version__}")
    commands = whole.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=_Parser)
    whole.commands = {}
    for group in GROUPS.values():
        for name, command in group.items():
            whole.commands[name] = commands.add_parser(
                name,
                help=command.does,
                description=f"{command.does[0].upper()}{command.does[1:]}.",
                epilog=examples_of(name),
                formatter_class=argparse.RawDescriptionHelpFormatter,
            )
            command.add(whole.commands[name])
    return whole


def parsed(argv: Sequence[str]) -> dict[str, Any]:
    """The arguments by their names, with the "command". Raises SystemExit, with an exit code, for all that cannot be
    run: help, wrong arguments, or none at all."""
    whole = parser()
    if not argv:
        say(f"{whole.description}\n\n{FIRST_STEPS}\n\nAll commands: punchform --help")
        raise SystemExit(int(Exit.UNUSABLE_INPUT))
    _refuse_unknown_options(whole, argv)
    found, left = whole.parse_known_args(argv)
    if left:
        whole.commands[found.command].refuse(f"{left[0]}: an argument too many")
    return vars(found)


def _refuse_unknown_options(whole: _Whole, argv: Sequence[str]) -> None:
    """A misspelt option is told before what is missing because of it."""
    command = next((whole.commands[word] for word in argv if word in whole.commands), None)
    if command is None:
        return
    known = command.option_names
    for word in argv:
        name = word.partition("=")[0]
        if word == "--":
            return
        if word.startswith("--") and not any(option.startswith(name) for option in known):
            command.refuse(f"there is no option {name}", near(name, known))


def near(given: str, known: Sequence[str]) -> str:
    """What may have been meant, as a hint; nothing where nothing is near.

    >>> near("frm", ["form", "drape"])
    'did you mean `form`?'
    """
    found = get_close_matches(given, known, n=1)
    return f"did you mean `{found[0]}`?" if found else ""
