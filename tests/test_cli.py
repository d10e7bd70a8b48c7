"""The command line: what it prints where, how it ends, and that help comes without the heavy imports."""

from __future__ import annotations

import argparse
import inspect
import io
import json
import os
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import tiny_dish

from punchform import __version__
from punchform.case import packaged_text
from punchform.case.materials import library
from punchform.cli import COMMANDS, main
from punchform.cli.exits import Exit
from punchform.cli.parser import parser
from punchform.cli.talk import Talk, say
from punchform.cli.voice import Voice
from punchform.errors import InputError, NoEquilibrium
from punchform.progress import Progress

HEAVY = ("numpy", "scipy", "numba", "pydantic", "rich", "matplotlib", "sympy", "jinja2", "tomlkit", "tomllib")


def in_new_process(code: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)


class Terminal(io.StringIO):
    """A stderr that says it is a terminal."""

    def isatty(self) -> bool:
        return True


def test_help_imports_nothing_heavy() -> None:
    told = f"print(set({HEAVY}) & set(sys.modules))"
    ended = in_new_process(f"import sys; from punchform.cli import main; main(['--help']); {told}")
    assert ended.returncode == 0
    assert ended.stdout.splitlines()[-1] == "set()"


def test_help_tells_commands_and_exit_codes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == Exit.DONE
    text = capsys.readouterr().out
    for command in ("form", "compensate", "punch", "element", "materials", "new", "check", "schema", "about"):
        assert re.search(rf"\n    {command}\s", text)
    for code in Exit:
        assert f"{code.value:>3}  {code.sentence}" in text


def test_exit_codes_are_what_scripts_rely_on() -> None:
    assert [code.value for code in Exit] == [0, 1, 2, 3, 70, 130, 143]


@pytest.mark.parametrize("arguments", [["frm"], ["form", "packaged:check"], ["check"], ["about", "--x"]])
def test_wrong_arguments_are_unusable_input(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == Exit.UNUSABLE_INPUT
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("error: ")
    assert re.search(r"\n  hint: .*see `punchform.* --help`", printed.err)


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == Exit.DONE
    assert capsys.readouterr().out == f"punchform {__version__}\n"


def test_new_writes_a_case_that_checks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "dish.toml"
    assert main(["new", str(file)]) == Exit.DONE
    assert capsys.readouterr().out == ""
    assert main(["check", str(file)]) == Exit.DONE
    assert "usable" in capsys.readouterr().out


def test_new_does_not_replace_a_file_unasked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "dish.toml"
    file.write_text("mine", encoding="utf-8")
    assert main(["new", str(file)]) == Exit.UNUSABLE_INPUT
    assert "--overwrite" in capsys.readouterr().err
    assert file.read_text(encoding="utf-8") == "mine"
    assert main(["new", str(file), "--overwrite"]) == Exit.DONE
    assert "schema = 1" in file.read_text(encoding="utf-8")


def test_new_in_no_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", str(tmp_path / "no" / "dish.toml")]) == Exit.UNUSABLE_INPUT
    assert "No such file or directory" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["check", "gridshell", "paper", "dish600", "new"])
def test_packaged_cases_check(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", f"packaged:{name}"]) == Exit.DONE
    printed = capsys.readouterr()
    assert printed.out.startswith(f"packaged:{name}: usable; ")
    assert printed.err == ""


def test_check_counts_the_whole_grid(capsys: pytest.CaptureFixture[str]) -> None:
    main(["check", "packaged:check"])
    quarter = capsys.readouterr().out
    steps = range(-46, 47)
    whole = sum(np.hypot(i, j) * 7.5 <= 345 * (1 + 1e-9) for i in steps for j in steps)
    assert f"{whole} crossings, a quarter of them solved" in quarter


def test_check_tells_where_wires_yield(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = packaged_text("new").replace("[wire]", '[wire]\nmaterial = "304 annealed"')
    case = tmp_path / "dish.toml"
    case.write_text(text, encoding="utf-8")
    assert main(["check", str(case)]) == Exit.DONE
    printed = capsys.readouterr()
    assert "wires yield at 205 MPa and neck at a true strain of 0.43" in printed.out
    case.write_text(text.replace("[wire]", '[wire]\nhardening = "none"\nsection = "fibres"'), encoding="utf-8")
    assert main(["check", str(case)]) == Exit.DONE
    printed = capsys.readouterr()
    assert "yield" not in printed.out
    assert "note: wire.section: fibres have no effect" in printed.err


def test_materials_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["materials"]) == Exit.DONE
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:3] == ["material", "E", "nu"]
    assert len(lines) == 2 + len(library())
    assert main(["materials", "--json"]) == Exit.DONE
    assert [one["name"] for one in json.loads(capsys.readouterr().out)] == list(library())


def test_a_material_tells_its_numbers_and_their_source(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "curve.png"
    assert main(["materials", "304 annealed", "-o", str(picture)]) == Exit.DONE
    printed = capsys.readouterr()
    for words in ("193 GPa", "205 MPa, taken as the stress at which plastic strain begins", "0.2 % proof", "handbooks"):
        assert words in printed.out
    assert printed.err == f"drew {picture}\n"
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert main(["materials", "304 annealed", "--json"]) == Exit.DONE
    content = json.loads(capsys.readouterr().out)
    assert content["flow_curve"]["rows"][0] == [0.0, 205.0]
    assert content["law_tensile_strength_MPa"] == pytest.approx(content["tensile_strength_MPa"], rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["304"], "error: there is no material '304'\n  hint: did you mean `304 annealed` or"),
        (["-o", "all.png"], "error: all.png: a picture is of one material"),
        (["brass hard", "-o", "curve.txt"], "error: curve.txt: the name of a picture ends in .png"),
        (["brass hard", "-o", "no/curve.png"], "error: no/curve.png: there is no folder no"),
    ],
)
def test_materials_that_cannot_be_shown(
    arguments: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["materials", *arguments]) == Exit.UNUSABLE_INPUT
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith(told)


def test_schema_is_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == Exit.DONE
    assert json.loads(capsys.readouterr().out)["title"] == "punchform case"


def test_about_tells_versions_and_solver(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["about"]) == Exit.DONE
    facts = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert facts["punchform"] == __version__
    assert facts["numpy"] == np.__version__
    assert facts["linear"].removeprefix("solver").strip() in ("pardiso", "rslab", "scipy")
    assert int(facts["cores"]) >= 1
    assert facts["memory"].endswith("GiB")


def test_element_prints_a_symmetric_stiffness(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["element", "packaged:check", "--json"]) == Exit.DONE
    content = json.loads(capsys.readouterr().out)
    C, B = np.array(content["C"]), np.array(content["B"])
    assert content["axes"] == "element"
    assert C.shape == (6, 6)
    np.testing.assert_allclose(C, C.T, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(C @ B, np.eye(6), atol=1e-8)


def test_element_in_the_axes_of_the_paper(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["element", "packaged:paper", "--axes", "paper"]) == Exit.DONE
    assert "paper" in capsys.readouterr().out


def test_element_of_two_steps_has_two_families(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "dish.toml"
    main(["new", str(file)])
    text = file.read_text(encoding="utf-8").replace('step = "10 mm"', 'step = ["10 mm", "8 mm"]')
    file.write_text(text, encoding="utf-8")
    plot = tmp_path / "wire.svg"
    assert main(["element", str(file), "--json", "--plot", str(plot)]) == Exit.DONE
    content = json.loads(capsys.readouterr().out)
    assert content["C"][0][0] < content["second_family"]["C"][0][0], "the shorter wire is the stiffer one"
    assert plot.is_file()
    assert plot.with_name("wire-y.svg").is_file()


@pytest.mark.parametrize(
    ("plot", "message"), [("wire.toml", "ends in .png, .svg, .pdf"), ("no/wire.png", "there is no folder")]
)
def test_a_picture_that_cannot_be_drawn(plot: str, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["element", "packaged:check", "--plot", plot]) == Exit.UNUSABLE_INPUT
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("trouble", "code", "words"),
    [
        (
            InputError.of("too small", where="grid.blank", hint="enlarge it"),
            2,
            "error: grid.blank: too small",
        ),
        (NoEquilibrium("the step limit was reached"), 3, "error: the step limit was reached"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (MemoryError(), 2, "error: the memory is not enough"),
        (OSError(28, "No space left on device", "x.csv"), 2, "error: x.csv: No space left on device"),
    ],
)
def test_trouble_becomes_words_and_a_code(
    trouble: BaseException,
    code: int,
    words: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(*, as_json: bool) -> Exit:
        raise trouble

    monkeypatch.setattr("punchform.cli.about.about", fail)
    assert main(["about"]) == code
    assert capsys.readouterr().err.startswith(words)


def test_a_reader_that_stops_early_is_no_error() -> None:
    command = [sys.executable, "-c", "import sys; from punchform.cli import main; sys.exit(main(['schema']))"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == Exit.DONE


@pytest.mark.parametrize("colourless", [True, False])
def test_colour_adds_to_words_and_can_be_refused(colourless: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    if colourless:
        monkeypatch.setenv("NO_COLOR", "1")
    else:
        monkeypatch.delenv("NO_COLOR", raising=False)
    say("error: dish.toml:3: [bold]grid[/bold]: no such setting\n  hint: leave it out")
    written = stream.getvalue()
    assert "[bold]grid[/bold]: no such setting" in written
    assert "error:" in written
    assert ("\x1b[1;31m" in written) is not colourless


STEP = Progress("press", 3, 6600.058, 2.1e-3)
WORDS = Progress("press", message="compiling")


def test_progress_off_a_terminal_is_messages_only(capsys: pytest.CaptureFixture[str]) -> None:
    with Talk(Voice.PLAIN) as talk:
        talk(WORDS)
        talk(STEP)
    assert capsys.readouterr().err == "compiling\n"


def test_quiet_is_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    with Talk(Voice.QUIET) as talk:
        talk(WORDS)
        talk(STEP)
    assert capsys.readouterr().err == ""


def test_progress_on_a_terminal_shows_the_step(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setenv("TERM", "xterm")
    with Talk(Voice.PLAIN) as talk:
        talk(WORDS)
        talk(STEP)
    assert "compiling" in stream.getvalue()
    assert "press: step 3" in stream.getvalue()
    assert "energy" not in stream.getvalue()


def test_an_old_console_gets_a_question_mark_not_a_traceback() -> None:
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    code = "import sys; from punchform.cli import main; sys.exit(main(['element', 'packaged:check']))"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, env=environment, check=False)
    assert ended.returncode == 0
    assert b"Traceback" not in ended.stderr


COARSE = """
schema = 1
[grid]
step = 25
blank = { shape = "circle", radius = 180 }
[wire]
diameter = 0.8
youngs_modulus = "200 GPa"
[punch]
profile = { kind = "paraboloid", focal_length = 150 }
rim_radius = 150
fillet = 60
"""


def test_form_prints_its_results_and_nothing_else(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("dish.toml").write_text(COARSE, encoding="utf-8")
    assert main(["form", "dish.toml", "-o", "out", "--quiet", "--json"]) == Exit.DONE
    printed = capsys.readouterr()
    assert printed.err == ""
    assert json.loads(printed.out) == json.loads(Path("out/result.json").read_text(encoding="utf-8"))

    assert main(["form", "dish.toml", "-o", "out"]) == Exit.UNUSABLE_INPUT
    assert "--overwrite" in capsys.readouterr().err

    # The resolved case is a case: it forms the same grid.
    Path("again.toml").write_text(Path("out/case.toml").read_text(encoding="utf-8"), encoding="utf-8")
    before = Path("out/nodes.csv").read_text(encoding="utf-8")
    assert main(["form", "again.toml", "-o", "out", "--overwrite"]) == Exit.DONE
    assert "  outcome         converged to a minimum\n" in capsys.readouterr().out
    assert Path("out/nodes.csv").read_text(encoding="utf-8") == before


AFTER = """
[release]
hold = { from_radius = 150 }
[load]
pressure = "1 Pa"
[target]
profile = { kind = "paraboloid", focal_length = 150 }
aperture_radius = 120
tolerance = "1 um"
"""


@pytest.mark.parametrize(
    ("tolerance", "code", "words"), [("1 um", Exit.OUT_OF_TOLERANCE, "out of"), ("90 mm", Exit.DONE, "within")]
)
def test_form_lets_go_loads_and_judges(
    tolerance: str,
    code: Exit,
    words: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("dish.toml").write_text(COARSE + AFTER.replace("1 um", tolerance), encoding="utf-8")
    assert main(["form", "dish.toml", "-o", "out"]) == code
    facts = dict(re.findall(r"^  (\w[\w ]*?) {2,}(.*)$", capsys.readouterr().out, re.MULTILINE))
    assert "mJ left; apex" in facts["released"]
    assert "N move the shape by" in facts["loaded"]
    assert f"{words} the tolerance of" in facts["accuracy"]
    content = json.loads(Path("out/result.json").read_text(encoding="utf-8"))
    assert content["accuracy"]["judged_on"]["within"] is (code is Exit.DONE)
    assert content["released"]["energy_mJ"] < content["formed"]["energy_mJ"]
    assert 'id="accuracy"' in Path("out/report.html").read_text(encoding="utf-8")


def test_form_without_equilibrium_ends_with_3_and_writes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("dish.toml").write_text(COARSE + "[solver]\nmax_steps = 1\n", encoding="utf-8")
    assert main(["form", "dish.toml", "-o", "out"]) == Exit.NO_EQUILIBRIUM
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "error: the step limit was reached" in printed.err
    assert not Path("out").exists()


def test_a_descent_that_gets_nowhere_ends_with_3_and_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    descent = '[press]\nmethod = "descent"\ndescent = { rule = "fixed", step_length = "1 mm/N" }\n'
    Path("dish.toml").write_text(COARSE + descent, encoding="utf-8")
    assert main(["form", "dish.toml", "-o", "out"]) == Exit.NO_EQUILIBRIUM
    assert "error: no step lowered the energy" in capsys.readouterr().err
    # The reference method is there to be looked at: its folder is written all the same.
    assert json.loads(Path("out/result.json").read_text(encoding="utf-8"))["formed"]["outcome"] == "no_descent"


def test_the_longer_of_two_steps_meets_the_bends(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = tmp_path / "dish.toml"
    case.write_text(COARSE.replace("step = 25", "step = [70, 5]"), encoding="utf-8")
    assert main(["check", str(case)]) == Exit.UNUSABLE_INPUT
    assert "sharper than the grid step of 70 mm" in capsys.readouterr().err


def test_a_modulus_meant_in_gigapascals_is_doubted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = tmp_path / "dish.toml"
    case.write_text(COARSE.replace('"200 GPa"', "200"), encoding="utf-8")
    assert main(["check", str(case)]) == Exit.DONE
    assert "wire.youngs_modulus: Young's modulus is 200 MPa" in capsys.readouterr().err


def test_every_command_is_given_the_arguments_that_it_takes() -> None:
    """The names of its options are those of its function, so none is offered that does nothing."""
    choices = next(one for one in parser()._actions if isinstance(one, argparse._SubParsersAction)).choices
    assert set(choices) == set(COMMANDS)
    for name, command in choices.items():
        module, _, function = COMMANDS[name].partition(":")
        taken = set(inspect.signature(getattr(import_module(f"punchform.cli.{module}"), function)).parameters)
        given = {one.dest for one in command._actions} - {"help"}
        if "verbose" in given:
            given = given - {"quiet", "verbose"} | {"voice"}
        if "scheduler" in given:
            given = given - {"workers", "scheduler", "voice"} | {"means"}
        assert given == taken, name


def test_a_fault_of_the_program_is_not_taken_for_an_answer(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(path: str, *, voice: object, as_json: bool) -> None:
        raise KeyError("stress")

    monkeypatch.setattr("punchform.cli.check.check", broken)
    assert main(["check", "packaged:check"]) == 70
    said = capsys.readouterr().err
    assert "error: a fault of punchform itself: KeyError: 'stress'" in said
    assert "Traceback" not in said
    assert main(["check", "packaged:check", "--verbose"]) == 70
    assert "Traceback" in capsys.readouterr().err


@pytest.mark.parametrize(("problem", "code"), [(KeyError("stress"), 70), (KeyboardInterrupt(), 130)])
def test_a_report_that_fails_or_is_stopped_leaves_the_run(
    problem: BaseException,
    code: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def broken(run: object, folder: Path, *, observe: object) -> None:
        (folder / "figures").mkdir()
        raise problem

    case, folder = tmp_path / "dish.toml", tmp_path / "dish"
    case.write_text(tiny_dish.TEXT, encoding="utf-8")
    with monkeypatch.context() as patch:
        patch.setattr("punchform.cli.drawing.write_report", broken)
        assert main(["form", str(case), "-o", str(folder)]) == code
    assert f"`punchform report {folder}` draws it" in capsys.readouterr().err
    assert {path.name for path in folder.iterdir()}.isdisjoint({"report.html", "figures"})
    assert main(["report", str(folder)]) == 0
    assert (folder / "report.html").is_file()
