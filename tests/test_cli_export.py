"""`punchform export`: files of a run folder, whole or not there, and a clear word for what cannot be exported."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import tiny_dish

from punchform.case.reading import case_from_text
from punchform.cli import main
from punchform.export.formats import FORMATS
from punchform.run import run as form
from punchform.store import write_run


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_run(form(tiny_dish.case()), tmp_path_factory.mktemp("export") / "dish")


def test_the_vtp_is_that_of_the_run_folder(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", str(folder), "--to", "vtp", "-o", str(tmp_path / "files"), "--json"]) == 0
    assert (tmp_path / "files" / "shape.vtp").read_bytes() == (folder / "shape.vtp").read_bytes()
    out = capsys.readouterr().out
    assert json.loads(out)["files"] == [{"name": "shape.vtp", "format": "vtp"}]
    assert out == (tmp_path / "files" / "result.json").read_text(encoding="utf-8")


def test_what_is_written_twice_is_the_same(folder: Path, tmp_path: Path) -> None:
    for name in ("one", "other"):
        assert main(["export", str(folder), "--to", "all", "-o", str(tmp_path / name), "--quiet"]) == 0
    files = sorted(path.name for path in (tmp_path / "one").iterdir())
    assert len(files) >= 2 + len(FORMATS)
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "other" / file).read_bytes(), file


def test_an_old_export_is_replaced_only_on_request(folder: Path, tmp_path: Path) -> None:
    command = ["export", str(folder), "--to", "vtp", "-o", str(tmp_path / "files"), "--quiet"]
    assert [main(command), main(command), main([*command, "--overwrite"])] == [0, 2, 0]


@pytest.mark.parametrize(("place", "said"), [(".", "replace"), ("..", "replace"), ("more", "stand among")])
@pytest.mark.parametrize("more", [[], ["--overwrite"]])
def test_the_run_itself_is_never_replaced(
    folder: Path, place: str, said: str, more: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    assert main(["export", str(folder), "--to", "vtp", "-o", str(folder / place), *more]) == 2
    assert said in capsys.readouterr().err
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize(
    ("run", "said"),
    [("nowhere", "no such folder"), (".", "not a punchform run"), ("file", "no such folder")],
)
def test_what_is_no_run_is_refused(run: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    target = tmp_path / "files"
    assert main(["export", str(tmp_path / run), "--to", "vtp", "-o", str(target)]) == 2
    assert said in capsys.readouterr().err
    assert not target.exists()


def test_a_format_that_is_none_is_refused_with_those_there_are(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["export", str(folder), "--to", "doc", "-o", "files"]) == 2
    assert "there are: " in capsys.readouterr().err


def test_all_leaves_out_what_a_run_cannot_show_and_says_why(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = tiny_dish.TEXT.replace('step = "10 mm"', 'step = "7.5 mm"')
    text = text.replace('diameter = "0.75 mm"', 'stiffness = "paper"').replace("poisson = 0.3", "")
    run = write_run(form(case_from_text(text.replace('youngs_modulus = "210 GPa"', ""))), tmp_path / "run")
    assert main(["export", str(run), "--to", "all", "-o", str(tmp_path / "files")]) == 0
    assert "ccx is left out: a wire whose stiffness is given as a matrix" in capsys.readouterr().err
    assert not list((tmp_path / "files").glob("*.inp"))
    assert main(["export", str(run), "--to", "ccx", "-o", str(tmp_path / "deck")]) == 2
    assert not (tmp_path / "deck").exists()
