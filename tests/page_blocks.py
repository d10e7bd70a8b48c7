"""The pages of the documentation, executed: the blocks of a page run in order in one empty folder.

What a fenced block is, its language says, and remarks in HTML comments above it, which no reader sees:

    console   every "$ " line is run; what the page shows below it must be printed, in this order; "..." leaves out
    toml      a whole case is checked; `<!-- file: dish.toml -->` writes it; `<!-- in: dish.toml -->` puts its sections
              in place of those of that case (or of `packaged:NAME`, as a copy), which must then be usable
    python    is run; `<!-- file: NAME.py -->` writes it instead, for a command of the page to run
    csv       is written, `<!-- file: NAME.csv -->`
    text      is read by people only; under `<!-- printed -->` it is what the program above it prints

`<!-- run: COMMAND -->` runs a command that the page need not show, `<!-- begins with: how_to/index.md -->` writes the
files of that page first, `<!-- held by: tests/X.py::test_name -->` leaves a block to that test, which reads the page.
"""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FENCE = re.compile(r"^```([^\n`]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
REMARK = re.compile(r"^<!-- (run|begins with|file|in|printed|held by)(?:: (.*?))? -->$", re.MULTILINE)
HEADER = re.compile(r"^\[([\w.\"]+)\]", re.MULTILINE)
LANGUAGES = ("console", "toml", "python", "csv", "text")
DIRECTIVES = ("{eval-rst}", "{include}", "{literalinclude}", "{toctree}", "{figure}", "{note}", "{tip}", "{warning}")
SECONDS = 600


@dataclass(frozen=True)
class Block:
    """A fenced block of a page, or a remark that runs a command: language, text, first line, what is said above it."""

    language: str
    text: str
    line: int
    remarks: dict[str, str]
    hidden: bool = False


def pages() -> list[Path]:
    """All pages of the repository."""
    found = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
    return sorted(page for page in found if "_build" not in page.parts)


def blocks(text: str) -> list[Block]:
    """The fenced blocks of a page in order, and its hidden commands as console blocks."""
    return sorted(_blocks(text), key=lambda block: block.line)


def _blocks(text: str) -> Iterator[Block]:
    for fence in FENCE.finditer(text):
        above = re.search(r"(?:^<!-- .* -->\n)*\Z", text[: fence.start()], re.MULTILINE)
        remarks = {found[1]: found[2] or "" for found in REMARK.finditer(above[0] if above else "")}
        yield Block(fence[1].strip(), fence[2], text[: fence.start()].count("\n") + 1, remarks)
    plain = FENCE.sub(lambda fence: "\n" * fence[0].count("\n"), text)
    for found in REMARK.finditer(plain):
        line = plain[: found.start()].count("\n") + 1
        if found[1] == "run":
            yield Block("console", f"$ {found[2]}\n", line, {}, hidden=True)
        elif found[1] == "begins with":
            yield Block("begins with", found[2], line, {}, hidden=True)


def commands(text: str) -> list[tuple[str, list[str]]]:
    """The lines after "$ ", each with the lines that the page shows under it."""
    found: list[tuple[str, list[str]]] = []
    for line in text.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif line.strip():
            assert found, f"a console block begins with `$ `, not with {line!r}"
            found[-1][1].append(line)
    return found


def missing(shown: list[str], printed: str) -> str:
    """The first line of what a page shows that is not printed, in order; empty when all are."""
    # Units are kept beside their numbers by spaces that do not break.
    lines = iter([line.strip() for line in printed.replace("\N{NO-BREAK SPACE}", " ").splitlines()])
    for line in (line.replace("\N{NO-BREAK SPACE}", " ") for line in shown):
        if line.strip() == "...":
            continue
        pattern = re.compile(".*".join(re.escape(part) for part in line.strip().split("...")))
        if not any(pattern.fullmatch(other) for other in lines):
            return line
    return ""


def with_sections(case: str, sections: str) -> str:
    """A case file in which sections (and keys before the first one) stand in place of those of the same name."""
    top, *parts = _split(sections)
    names = [name for name, _ in parts]
    old_top, *old = _split(case)
    kept = [text for name, text in old if not any(name == new or name.startswith(new + ".") for new in names)]
    keys = re.findall(r"^(\w+) *=", top[1], re.MULTILINE)
    first = "".join(line for line in old_top[1].splitlines(True) if line.partition("=")[0].strip() not in keys)
    return "\n".join([first + top[1], *kept, *(text for _, text in parts)])


def _split(text: str) -> list[tuple[str, str]]:
    """What stands before the first section of a case file, then its sections by name."""
    starts = [found.start() for found in HEADER.finditer(text)]
    ends = [*starts[1:], len(text)]
    parts = [text[start:end] for start, end in zip(starts, ends, strict=True)]
    named = [(found[1], part) for part in parts if (found := HEADER.match(part))]
    return [("", text[: starts[0]] if starts else text), *named]


def reads(test: str, page: str) -> bool:
    """Whether there is a test `tests/X.py::test_name` that names the file of the page in its own lines."""
    file, _, name = test.partition("::")
    if not name.startswith("test_") or not (ROOT / file).is_file():
        return False
    text = (ROOT / file).read_text(encoding="utf-8")
    own = [one for one in ast.parse(text).body if isinstance(one, ast.FunctionDef) and one.name == name]
    return any(Path(page).name in (ast.get_source_segment(text, one) or "") for one in own)


class Folder:
    """The empty folder in which a page is executed, and what its last command gave."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.status = 0
        self.printed = ""

    def run(self, block: Block, page: str) -> None:
        """Execute one block; raises AssertionError where the page says something else than the program."""
        if "held by" in block.remarks:
            assert reads(block.remarks["held by"], page), f"{block.remarks['held by']} is no test that reads {page}"
        elif block.language == "begins with":
            for other in blocks((ROOT / "docs" / block.text).read_text(encoding="utf-8")):
                if "file" in other.remarks:
                    self.run(other, page)
        elif block.language == "console":
            self._console(block)
        elif block.language == "toml":
            self._toml(block)
        elif block.language == "python":
            file = block.remarks.get("file")
            (self.path / (file or f"line_{block.line}.py")).write_text(block.text, encoding="utf-8")
            if not file:
                self._call(f"{sys.executable} line_{block.line}.py")
                assert self.status == 0, self.printed
        elif block.language == "csv":
            (self.path / block.remarks["file"]).write_text(block.text, encoding="utf-8")
        elif "printed" in block.remarks:
            lost = missing(block.text.splitlines(), self.printed)
            assert not lost, f"not printed: {lost}\n{self.printed}"

    def _console(self, block: Block) -> None:
        told = commands(block.text)
        for number, (command, shown) in enumerate(told):
            if command == "echo $?":
                assert [line.strip() for line in shown] == [str(self.status)], f"the status is {self.status}"
                continue
            if command.startswith("make "):
                self._make(command, shown)
                continue
            self._call(command)
            awaited = number + 1 < len(told) and told[number + 1][0] == "echo $?"
            assert self.status == 0 or awaited, f"{command}\n{self.printed}"
            lost = missing(shown, self.printed)
            assert not lost, f"{command}\ndoes not print: {lost}\n{self.printed}"

    def _toml(self, block: Block) -> None:
        name, base = block.remarks.get("file", ""), block.remarks.get("in", "")
        text = block.text
        if base:
            text = with_sections(self._case(base), text)
        if not name:
            name = f"line_{block.line}.toml" if not base or ":" in base else base
        (self.path / name).write_text(text, encoding="utf-8")
        self._call(f"punchform check {name}")
        assert self.status == 0, self.printed

    def _case(self, name: str) -> str:
        if ":" in name:
            packaged = ROOT / "src" / "punchform" / "cases" / f"{name.partition(':')[2]}.toml"
            return packaged.read_text(encoding="utf-8")
        return (self.path / name).read_text(encoding="utf-8")

    def _call(self, command: str) -> None:
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
        environment = {**os.environ, "PATH": path, "NO_COLOR": "1", "COLUMNS": "200", "MPLBACKEND": "agg"}
        done = subprocess.run(
            ["bash", "-c", command],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=self.path,
            env=environment,
            timeout=SECONDS,
        )
        self.status, self.printed = done.returncode, done.stdout.replace(f"{self.path}/", "")

    def _make(self, command: str, shown: list[str]) -> None:
        targets = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
        assert command.split()[1] in targets, f"the Makefile has no target for `{command}`"
        assert not shown, "make is not run here, so its output would be prose"
