"""The help: every command shows examples, each of them parses, and those that take no time run as they stand."""

from __future__ import annotations

import argparse
import re
import shlex
from pathlib import Path

import pytest

from punchform.cli import COMMANDS, main
from punchform.cli.exits import Exit
from punchform.cli.parser import GROUPS, parser
from punchform.cli.usage import EXAMPLES, Example

ALL = [(name, example) for name, examples in EXAMPLES.items() for example in examples]
CHEAP = ("new", "examples", "check", "materials", "element", "schema", "about", "completion", "punch")


def words(example: Example) -> list[str]:
    """The arguments of an example, without where the shell writes the output to."""
    first, *rest = shlex.split(example.line.partition(" > ")[0])
    assert first == "punchform"
    return rest


def test_every_command_stands_in_one_group_and_has_examples() -> None:
    grouped = [name for group in GROUPS.values() for name in group]
    assert sorted(grouped) == sorted(COMMANDS)
    assert set(EXAMPLES) == set(COMMANDS)
    assert all(2 <= len(examples) <= 4 for examples in EXAMPLES.values())


@pytest.mark.parametrize(("name", "example"), ALL, ids=lambda one: one if isinstance(one, str) else one.line[10:])
def test_an_example_parses(name: str, example: Example, capsys: pytest.CaptureFixture[str]) -> None:
    assert parser().parse_args(words(example)).command == name
    assert main([name, "--help"]) == Exit.DONE
    shown = capsys.readouterr().out
    assert f"  {example.line}\n      {example.gives}" in shown
    assert len(example.line) <= 112


def test_cheap_examples_run_as_they_stand(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in CHEAP:
        for example in EXAMPLES[name]:
            assert main(words(example)) == Exit.DONE, example.line
            assert not re.search("error|Traceback", capsys.readouterr().err), example.line


@pytest.mark.parametrize("command", COMMANDS)
def test_options_stand_in_groups_and_metavars_tell(command: str) -> None:
    for action in parser().commands[command]._actions:
        assert action.help, action
        if action.nargs != 0 and action.choices is None:
            assert isinstance(action.metavar, str), action
            assert action.metavar == action.metavar.upper()
    groups = {group.title for group in parser().commands[command]._action_groups}
    if "-o" in parser().commands[command].option_names and command not in ("materials", "examples"):
        assert "results" in groups
    quiet = any(action.dest == "quiet" for action in parser().commands[command]._actions)
    assert ("what is said" in groups) is quiet


def test_commands_that_talk_can_be_quiet_and_verbose() -> None:
    silent = {name for name, command in parser().commands.items() if "--quiet" not in command.option_names}
    assert silent == {"schema", "about", "completion"}
    assert all(
        {"-q", "-v", "--verbose"} <= set(command.option_names)
        for name, command in parser().commands.items()
        if name not in silent
    )


def test_without_arguments_it_says_what_to_do_first(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == Exit.UNUSABLE_INPUT
    printed = capsys.readouterr()
    assert printed.out == ""
    for line in ("punchform new dish.toml", "punchform form dish.toml -o runs/dish", "punchform --help"):
        assert line in printed.err


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("frm dish.toml", "error: there is no command 'frm'\n  hint: did you mean `form`?; see `punchform --help`"),
        ("sweeep", "did you mean `sweep`?"),
        ("qqq", "error: there is no command 'qqq'\n  hint: there are: new, examples,"),
        ("form dish.toml --outptu out", "error: there is no option --outptu\n  hint: did you mean `--output`?"),
        ("form dish.toml --quite -o out", "did you mean `--quiet`?; see `punchform form --help`"),
        ("sweep dish.toml --sampels=5", "there is no option --sampels\n  hint: did you mean `--samples`?"),
        ("element dish.toml --axes papper", "error: --axes papper: no such choice\n  hint: did you mean `paper`?"),
        ("check one.toml two.toml", "error: two.toml: an argument too many\n  hint: see `punchform check --help`"),
        ("form dish.toml -o out -q -v", "not allowed with argument -q/--quiet"),
        ("sweep dish.toml --over a=1 -o out --samples few", "invalid int value: 'few'"),
        ("drape dish.toml -o out --direction -30deg", "follows an equals sign: --direction=-..."),
    ],
)
def test_what_is_misspelt_is_told_with_what_was_meant(line: str, told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(line.split()) == Exit.UNUSABLE_INPUT
    printed = capsys.readouterr()
    assert printed.out == ""
    assert told in printed.err


def test_abbreviated_options_go_on_working() -> None:
    chosen = parser().parse_args(["form", "dish.toml", "--out", "x", "--quie"])
    assert isinstance(chosen, argparse.Namespace)
    assert chosen.output == "x"
    assert chosen.quiet
