"""`punchform examples`: what is listed is what is packaged, and copies are whole or not there."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from punchform.case import TEMPLATE, introduction, packaged_cases, packaged_text, read_case
from punchform.cli import main

NAMES = [name for name in packaged_cases() if name != TEMPLATE]


def test_every_packaged_case_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["examples", "--json"]) == 0
    printed = capsys.readouterr()
    listed = json.loads(printed.out)
    assert printed.err == ""
    assert [one["name"] for one in listed] == [f"packaged:{name}" for name in NAMES]
    for name, one in zip(NAMES, listed, strict=True):
        assert one["title"] == read_case(f"packaged:{name}").title
        assert one["shows"] == introduction(packaged_text(name))
        assert 10 < len(one["shows"]) < 250, "a sentence"
        assert one["takes"] in ("seconds", "half a minute", "minutes")
        assert one["crossings"] > 0
    assert main(["examples"]) == 0
    told = capsys.readouterr()
    assert all(one["name"] in told.out and one["title"] in told.out for one in listed)
    assert "punchform examples NAME" in told.err


def test_crossings_are_those_that_check_counts(capsys: pytest.CaptureFixture[str]) -> None:
    main(["examples", "--json"])
    listed = {one["name"]: one["crossings"] for one in json.loads(capsys.readouterr().out)}
    main(["check", "packaged:check", "--json"])
    assert json.loads(capsys.readouterr().out)["crossings"] == listed["packaged:check"]


@pytest.mark.parametrize("given", ["check", "packaged:check"])
def test_a_copy_is_the_packaged_text(
    given: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["examples", given]) == 0
    assert Path("check.toml").read_text(encoding="utf-8") == packaged_text("check")
    assert "wrote check.toml" in capsys.readouterr().err
    Path("check.toml").write_text("mine", encoding="utf-8")
    assert main(["examples", given]) == 2
    assert "error: check.toml: the file is there already\n  hint: give --overwrite" in capsys.readouterr().err
    assert Path("check.toml").read_text(encoding="utf-8") == "mine"
    assert main(["examples", given, "-o", "other.toml", "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    assert main(["examples", given, "--overwrite", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == ["check.toml"]
    assert Path("check.toml").read_text() == Path("other.toml").read_text() == packaged_text("check")


def test_all_are_copied_or_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "cases" / "mine"
    folder.mkdir(parents=True)
    (folder / f"{NAMES[-1]}.toml").write_text("mine", encoding="utf-8")
    assert main(["examples", "--all", "-o", str(folder)]) == 2
    assert [file.name for file in folder.iterdir()] == [f"{NAMES[-1]}.toml"]
    assert main(["examples", "--all", "-o", str(folder), "--overwrite"]) == 0
    assert sorted(file.stem for file in folder.iterdir()) == NAMES
    capsys.readouterr()


@pytest.mark.parametrize(
    ("line", "told"),
    [
        (["chek"], "error: there is no packaged case 'chek'\n  hint: did you mean `packaged:check`? there are: "),
        (["check", "--all"], "error: check: --all copies every example"),
        (["-o", "x.toml"], "error: -o x.toml: what is to be copied is not said"),
        (["check", "-o", "."], "error: .: is a folder\n  hint: give the name of a file"),
        (["check", "-o", "no/x.toml"], "error: no/x.toml: No such file or directory"),
    ],
)
def test_what_cannot_be_copied(
    line: list[str],
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["examples", *line]) == 2
    assert told in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("# One sentence of 0.75 mm. Another.\n", "One sentence of 0.75 mm."),
        ("# Over\n# two lines! More.\nschema = 1", "Over two lines!"),
        ("schema = 1\n# later", ""),
        ("#\n# After an empty line", "After an empty line"),
        ("# Without an end", "Without an end"),
    ],
)
def test_the_introduction_is_the_first_sentence_of_the_first_comment(text: str, said: str) -> None:
    assert introduction(text) == said
