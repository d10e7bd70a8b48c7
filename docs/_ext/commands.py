"""The commands and their options as tables, from the parser of the command line."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from punchform.cli.parser import parser


def markdown() -> str:
    """One heading, one line of usage and one table for every command."""
    return "\n".join(_lines(parser()))


def _lines(whole: argparse.ArgumentParser) -> Iterator[str]:
    (commands,) = (action for action in whole._actions if isinstance(action, argparse._SubParsersAction))
    told = {choice.dest: choice.help for choice in commands._choices_actions}
    yield from ("| command | what it does |", "|---|---|")
    for name in commands.choices:
        yield f"| [`{name}`](#command-{name}) | {_cell(told.get(name) or '')} |"
    yield ""
    for name, command in commands.choices.items():
        yield from (f"(command-{name})=", f"## `punchform {name}`", "")
        sentence = command.description or told.get(name) or ""
        yield from (_cell(sentence[:1].upper() + sentence[1:].rstrip(".") + "."), "")
        yield from ("```text", _usage(command), "```", "")
        yield from _table(command)
        if command.epilog:
            yield from ("```text", command.epilog.strip().replace("%(prog)s", command.prog), "```", "")


def _usage(command: argparse.ArgumentParser) -> str:
    return " ".join(command.format_usage().removeprefix("usage: ").split())


def _table(command: argparse.ArgumentParser) -> Iterator[str]:
    actions = [action for action in command._actions if action.help != argparse.SUPPRESS and action.dest != "help"]
    if not actions:
        return
    yield from ("| argument | what it does |", "|---|---|")
    for action in actions:
        text = (action.help or "") % {**vars(action), "prog": command.prog}
        yield f"| {_signature(action)} | {_cell(text)}{_rest(action)} |"
    yield ""


def _signature(action: argparse.Action) -> str:
    choices = "{" + ",".join(map(str, action.choices)) + "}" if action.choices else ""
    value = "" if action.nargs == 0 else str(action.metavar or choices or action.dest.upper())
    names = ", ".join(action.option_strings)
    return f"`{' '.join(part for part in (names, value) if part)}`"


def _rest(action: argparse.Action) -> str:
    """What the help does not say: that an option is required, and a default that is a plain value."""
    said = " **Required.**" if action.option_strings and action.required else ""
    plain = isinstance(action.default, str | int | float) and not isinstance(action.default, bool)
    if plain and action.default and str(action.default) not in (action.help or ""):
        said += f" `{action.default}` when absent."
    return said


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*").replace("[", "\\[")
