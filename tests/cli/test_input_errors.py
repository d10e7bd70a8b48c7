"""What a person gets wrong: one clear message, exit code 2, and nothing written."""

from __future__ import annotations

import os
import shlex
from errno import ENOSPC
from pathlib import Path

import pytest
from command_lines import written

from punchform.cli import main
from punchform.cli.exits import Exit


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a good case and what is no case."""
    monkeypatch.chdir(tmp_path)
    written(tmp_path)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "letter.txt").write_text("dear", encoding="utf-8")
    (tmp_path / "latin.toml").write_bytes(b'schema = 1\ntitle = "Sch\xfcssel"\n')
    (tmp_path / "binary.toml").write_bytes(bytes(range(256)) * 8)
    (tmp_path / "two.csv").write_text("x,y\n1,2\n", encoding="utf-8")
    os.mkfifo(tmp_path / "pipe.toml")
    return tmp_path


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("check missing.toml", "missing.toml: cannot be read: No such file or directory\n  hint: `punchform new FILE`"),
        ("check other", "other: is a folder, not a case file"),
        ("check ''", "the name of a case file is empty"),
        ("check latin.toml", "latin.toml:2: is not UTF-8 text\n  hint: save the file as UTF-8"),
        ("check binary.toml", "binary.toml:2: is not UTF-8 text"),
        ("check pipe.toml", "pipe.toml: is not a regular file"),
        ("check packaged:chek", "there is no packaged case 'chek'\n  hint: did you mean `packaged:check`?"),
        ("form dish.toml -o two.csv", "two.csv: is a file, or lies below one"),
        ("form dish.toml -o other", "other: the folder holds files that are not a punchform run"),
        ("drape dish.toml -o net --origin 5", "--origin 5: the origin is two lengths with a comma"),
        ("compare missing two.csv -o part", "missing: no such folder"),
        ("compare other two.csv -o part", "other: not a punchform run"),
        ("compensate dish.toml -o punch --solves many", "--solves many: a whole number from 1 on is needed"),
        ("sensitivity dish.toml --workers 0", "--workers: 0 workers are asked for"),
        ("sensitivity dish.toml --of beauty", "there is no figure 'beauty'"),
        ("sweep dish.toml --over wire.diameter=1 -o many --workers -2", "--workers: -2 workers are asked for"),
        ("tolerances dish.toml -o many", "dish.toml:1: scatter: the case does not say what varies"),
        ("optimise dish.toml -o many", "dish.toml:1: optimise: this section is missing"),
        ("punch dish.toml -o tool --step '1 um'", "--step 1 um: the height field would have more than 4000000 points"),
        ("element dish.toml --plot other", "other: the name of a picture ends in .png"),
        ("new other", "other: is a folder"),
        ("new other --overwrite", "other: is a folder"),
        ("new two.csv", "two.csv: the file is there already"),
        ("completion tcsh", "shell tcsh: no such choice\n  hint: there are: bash, zsh, fish"),
    ],
)
def test_it_is_told_and_nothing_is_written(
    line: str, told: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    assert main(shlex.split(line)) == Exit.UNUSABLE_INPUT
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("error: ")
    assert told in printed.err
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before


def test_a_full_disk_is_told_with_what_to_do(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(*, as_json: bool) -> Exit:
        raise OSError(ENOSPC, "No space left on device", "wire.png")

    monkeypatch.setattr("punchform.cli.about.about", full)
    assert main(["about"]) == Exit.UNUSABLE_INPUT
    assert capsys.readouterr().err == (
        "error: wire.png: No space left on device\n  hint: free some space, or name another place\n"
    )


def test_a_run_that_fails_beside_another_is_told_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = written(tmp_path)
    assert main(["sensitivity", case, "--vary", "release.hold.from_radius", "--workers", "1", "--quiet"]) == Exit.DONE
    row = next(line for line in capsys.readouterr().out.splitlines() if "from_radius" in line)
    assert "a run beside it failed: release.hold.from_radius: no crossing was formed at or beyond 70 mm" in row
