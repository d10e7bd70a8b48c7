"""`punchform completion`: the script with which a shell completes commands, options, packaged cases and files.

The script is made from the parser and asks nothing of the program when Tab is pressed: docs/decisions/completion.md.
"""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Iterator
from dataclasses import dataclass

from punchform.case import PREFIX, TEMPLATE, packaged_cases
from punchform.cli.exits import Exit
from punchform.cli.parser import parser

FOLDERS = ("DIR", "RUN")
FILES = ("FILE", "POINTS")


@dataclass(frozen=True)
class Word:
    """What may stand at one place: fixed words, files, folders or cases; nothing that is known where all are empty.
    again: whether more of the same may follow."""

    words: tuple[str, ...] = ()
    kind: str = "none"
    again: bool = False


@dataclass(frozen=True)
class Completed:
    """A command as shells complete it: what it does, its options (all names, help, and the value that follows or None),
    and what stands in its places without a name."""

    name: str
    does: str
    options: tuple[tuple[tuple[str, ...], str, Word | None], ...]
    places: tuple[Word, ...]

    def names(self, *, with_value: bool = False) -> list[str]:
        """The names of all options, or of those that a value follows."""
        return [name for names, _, value in self.options if value is not None or not with_value for name in names]


def completion(shell: str) -> Exit:
    """Print the script for a shell: "bash", "zsh" or "fish"."""
    commands = tuple(completed())
    print({"bash": bash, "zsh": zsh, "fish": fish}[shell](commands))
    return Exit.DONE


def completed() -> Iterator[Completed]:
    """Every command as shells complete it."""
    for name, command in parser().commands.items():
        options, places = [], []
        for action in command._actions:
            if action.option_strings:
                value = None if action.nargs == 0 else _word(action)
                options.append((tuple(action.option_strings), action.help or "", value))
            else:
                places.append(_word(action))
        yield Completed(name, (command.description or "").rstrip("."), tuple(options), tuple(places))


def _word(action: argparse.Action) -> Word:
    if action.choices is not None:
        return Word(tuple(map(str, action.choices)), again=action.nargs == "+")
    metavar = str(action.metavar)
    if metavar == "CASE":
        return Word(tuple(PREFIX + case for case in packaged_cases()), "file")
    if metavar == "EXAMPLE":
        return Word(tuple(case for case in packaged_cases() if case != TEMPLATE))
    kind = "folder" if metavar in FOLDERS else "file" if metavar in FILES else "none"
    return Word((), kind, again=action.nargs == "+")


def bash(commands: tuple[Completed, ...]) -> str:
    """The script for bash. It puts words with a colon together again, which bash takes apart."""
    offered, taking, values, places = [], [], [], []
    for one in commands:
        offered.append(f"{one.name}) words={shlex.quote(' '.join(one.names()))} ;;")
        taking.append(f"{one.name}) taking={shlex.quote(' '.join(one.names(with_value=True)))} ;;")
        for names, _, value in one.options:
            if value is not None:
                values.append(f"{'|'.join(f'{one.name}:{name}' for name in names)}) {_bash_word(value)} ;;")
        for number, word in enumerate(one.places):
            places.append(f"{one.name}:{'*' if word.again else number}) {_bash_word(word)} ;;")
    first = shlex.quote(" ".join([*(one.name for one in commands), "--help", "--version"]))
    return f"""# Completion of punchform for bash: `source` this, or keep it as
# ~/.local/share/bash-completion/completions/punchform
_punchform() {{
    local line current before word words= kind= command= taking= place=0 skip=
    local -a typed=()
    line=${{COMP_LINE:0:COMP_POINT}}
    # Bash splits words at colons and equals signs; here they are split at blanks alone.
    read -r -a typed <<< "$line"
    [[ $line == *[[:space:]] ]] && typed+=("")
    current=${{typed[-1]}}
    before=${{typed[-2]:-}}
    COMPREPLY=()
    if (( ${{#typed[@]}} <= 2 )); then
        words={first}
        COMPREPLY=($(compgen -W "$words" -- "$current"))
        return
    fi
    command=${{typed[1]}}
    case $command in
{_lines(taking)}
    esac
    for word in "${{typed[@]:2:${{#typed[@]}}-3}}"; do
        if [[ $skip ]]; then skip=
        elif [[ $word == -* ]]; then [[ " $taking " == *" $word "* ]] && skip=yes
        else place=$((place + 1)); fi
    done
    if [[ $skip ]]; then case $command:$before in
{_lines(values)}
    esac
    elif [[ $current == -* ]]; then case $command in
{_lines(offered)}
    esac
    else case $command:$place in
{_lines(places)}
    esac
    fi
    COMPREPLY=($(compgen -W "$words" -- "$current"))
    if [[ $kind ]]; then
        # Among file names bash would put a backslash before the colon of packaged:NAME.
        (( ${{#COMPREPLY[@]}} )) || compopt -o filenames 2>/dev/null
        while IFS= read -r word; do COMPREPLY+=("$word"); done < <(compgen -$kind -- "$current")
    fi
    # What stands before the last colon is on the line already.
    if [[ $current == *:* && $COMP_WORDBREAKS == *:* ]]; then
        COMPREPLY=("${{COMPREPLY[@]#"${{current%"${{current##*:}}"}}"}}")
    fi
}}
complete -F _punchform punchform"""


def _lines(branches: list[str]) -> str:
    return "\n".join(f"        {branch}" for branch in branches)


def _bash_word(word: Word) -> str:
    kind = {"file": " kind=f", "folder": " kind=d"}.get(word.kind, "")
    return f"words={shlex.quote(' '.join(word.words))}{kind}"


def zsh(commands: tuple[Completed, ...]) -> str:
    """The script for zsh, with what each command and option does."""
    does = "\n".join(f"        {_zsh_quoted(f'{one.name}:{one.does}')}" for one in commands)
    cases = []
    for one in commands:
        specs = []
        for names, about, value in one.options:
            first = f"({' '.join(names)}){{{','.join(names)}}}" if len(names) > 1 else names[0]
            specs.append(_zsh_option(first, about, value))
        for number, word in enumerate(one.places, start=1):
            specs.append(_zsh_quoted(f"{'*' if word.again else number}:{_zsh_kind(word)}"))
        cases.append(f"        {one.name})\n            _arguments -s " + " \\\n                ".join(specs) + " ;;")
    body = "\n".join(cases)
    packaged = " ".join((PREFIX + case).replace(":", "\\\\:") for case in packaged_cases())
    return f"""#compdef punchform
# Completion of punchform for zsh: keep it as _punchform in a folder of $fpath.
_punchform_case() {{
    local -a packaged=({packaged})
    _alternative "packaged:packaged case:($packaged)" 'files:case file:_files'
}}
_punchform() {{
    local -a commands=(
{does}
    )
    if (( CURRENT == 2 )); then
        _describe command commands
        return
    fi
    local command=$words[2]
    shift words
    (( CURRENT-- ))
    case $command in
{body}
    esac
}}
if [ "$funcstack[1]" = "_punchform" ]; then
    _punchform "$@"
else
    compdef _punchform punchform
fi"""


def _zsh_option(first: str, about: str, value: Word | None) -> str:
    told = about.replace("[", "(").replace("]", ")").replace(":", " -")
    ending = "" if value is None else f":{_zsh_kind(value)}"
    names, brace, rest = first.partition("{")
    # Braces are expanded by the shell, so they stand outside of the quotes.
    return (
        f"{_zsh_quoted(names)}{brace}{rest}{_zsh_quoted(f'[{told}]{ending}')}"
        if brace
        else _zsh_quoted(f"{first}[{told}]{ending}")
    )


def _zsh_kind(word: Word) -> str:
    if word.words and word.kind == "file":
        return "case:_punchform_case"
    if word.words:
        return f"value:({' '.join(word.words)})"
    return {"file": "file:_files", "folder": "folder:_files -/"}.get(word.kind, "value: ")


def _zsh_quoted(text: str) -> str:
    return "'" + text.replace("'", "'\\''") + "'"


def fish(commands: tuple[Completed, ...]) -> str:
    """The script for fish, with what each command and option does."""
    lines = [
        "# Completion of punchform for fish: keep it as ~/.config/fish/completions/punchform.fish",
        "complete -c punchform -f",
    ]
    for one in commands:
        about = _fish_quoted(one.does)
        lines.append(f"complete -c punchform -n __fish_use_subcommand -a {one.name} -d {about}")
        here = f"complete -c punchform -n '__fish_seen_subcommand_from {one.name}'"
        for names, told, value in one.options:
            flags = " ".join(f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}" for name in names)
            lines.append(f"{here} {flags} -d {_fish_quoted(told)}{_fish_value(value)}")
        for word in one.places:
            if word.words:
                lines.append(f"{here} -a {_fish_quoted(' '.join(word.words))}")
            if word.kind == "file":
                lines.append(f"{here} -F")
            elif word.kind == "folder":
                lines.append(f"{here} -a '(__fish_complete_directories)'")
    return "\n".join(lines)


def _fish_value(value: Word | None) -> str:
    if value is None:
        return ""
    if value.words:
        return f" -x -a {_fish_quoted(' '.join(value.words))}"
    return {"file": " -r -F", "folder": " -x -a '(__fish_complete_directories)'"}.get(value.kind, " -x")


def _fish_quoted(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"
