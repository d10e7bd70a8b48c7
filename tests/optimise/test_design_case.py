"""The section [optimise] of a case: it reads back the same, and what is wrong with it is told with its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from punchform.case import case_from_text, json_schema, packaged_text, read_case, varied, write_case
from punchform.cli import main
from punchform.errors import InputError
from punchform.optimise.problem import question_of

PLAIN = packaged_text("design").partition("[optimise]")[0]
LINE = PLAIN.count("\n") + 2
"""The first line below the head of the section."""
DIAMETER = 'variables = { "wire.diameter" = { from = "0.4 mm", to = "1 mm" } }'


def test_it_reads_back_the_same() -> None:
    case = read_case("packaged:design")
    assert case_from_text(write_case(case)) == case
    assert varied(case, {"wire.diameter": 0.5}).optimise == case.optimise
    assert case.optimise is not None
    assert [one.figure for one in case.optimise.objectives] == ["rms", "compliance", "mass"]


def test_an_objective_alone_is_made_small() -> None:
    asked = case_from_text(f"{PLAIN}[optimise]\n{DIAMETER}\nobjectives = ['rms', {{ maximise = 'push' }}]\n").optimise
    assert asked is not None
    assert [(one.minimise, one.maximise) for one in asked.objectives] == [("rms", None), (None, "push")]


def test_an_editor_is_told_that_a_word_is_enough() -> None:
    objectives = json_schema()["$defs"]["OptimiseCase"]["properties"]["objectives"]
    assert {"type": "string"} in objectives["items"]["anyOf"]


@pytest.mark.parametrize(
    ("section", "line", "words"),
    [
        ("", 0, "optimise.variables: is missing"),
        ("variables = {}", 1, "optimise.variables: needs at least 1 entries"),
        ("variables = { wire.diameter = { from = 1, to = 2 } }", 1, 'write "wire.diameter" = ...'),
        ('variables = { "wire.diameter" = { from = 1 } }', 1, '"wire.diameter".to: is missing: a range has two ends'),
        ('variables = { "wire.diameter" = { frm = 1, to = 2 } }', 1, "did you mean `from`?"),
        ('variables = { "wire.diameter" = {} }', 1, "needs a range or a list"),
        ('variables = { "wire.diameter" = { among = [1] } }', 1, "needs at least 2 entries"),
        ('variables = { "wire.diameter" = 3 }', 1, "expected a table with settings, not 3"),
        ('variables = { "wire.diametr" = { from = 1, to = 2 } }', 1, "the case has no such setting"),
        ('variables = { "wire.diameter" = { from = "1 mmm", to = 2 } }', 1, '"wire.diameter".from: expected a length'),
        ('variables = { "wire.diameter" = { from = -1, to = 2 } }', 1, "must be more than 0"),
        ('variables = { "wire.diameter" = { from = 2, to = 1 } }', 1, "from 2 to 1 there is nothing"),
        ('variables = { "grid.crossing" = { from = 1, to = 2 } }', 1, "expected 'pinned' or 'welded'"),
        ('variables = { "grid.crossing" = { among = ["pinned", "glued"] } }', 1, "among[1]: expected 'pinned'"),
        ('variables = { "grid.step" = { among = ["8 mm", "0.8 cm"] } }', 1, "holds the same value twice"),
        ('variables = { "grid.subdivide" = { from = 1, to = 2.5 } }', 1, "whole number"),
        (f"{DIAMETER}\nobjectives = []", 2, "between 1 and 4 figures can be improved, not 0"),
        (f"{DIAMETER}\nobjectives = ['rms', 'rms']", 2, "`rms` stands twice"),
        (f"{DIAMETER}\nobjectives = [{{ maximize = 'rms' }}]", 2, "did you mean `maximise`?"),
        (f"{DIAMETER}\nobjectives = ['mas']", 2, "did you mean `mass`?"),
        (f"{DIAMETER}\nobjectives = ['cost']", 0, "optimise.cost: is missing: `cost` needs it"),
        (f"{DIAMETER}\nobjectives = ['gain_loss']", 0, "optimise.frequency: is missing"),
        (f"{DIAMETER}\nconstraints = {{ mass = 3 }}", 2, "expected a table with settings, not 3"),
        (f"{DIAMETER}\nconstraints = {{ mass = {{}} }}", 2, "sets no limit"),
        (f"{DIAMETER}\nconstraints = {{ mass = {{ least = 2, most = 1 }} }}", 2, "at least 2 and at most 1"),
        (f"{DIAMETER}\nconstraints = {{ weight = {{ most = 1 }} }}", 2, "there is no figure `weight`"),
        (f"{DIAMETER}\ncost = 'import os'", 2, "optimise.cost: `import` is not known"),
        (f"{DIAMETER}\ncost = '40 * cost'", 2, "optimise.cost: `cost` is not known"),
        (f"{DIAMETER}\nmethod = 'gradient'\nobjectives = ['rms', 'mass']", 2, "one objective has a way downhill"),
        (f"{DIAMETER}\nmethod = 'genetic'", 2, "expected 'auto', 'gradient' or 'global'"),
        ('method = "gradient"\nvariables = { "grid.step" = { among = [8, 10] } }', 1, "which has no gradient"),
        ('method = "gradient"\nvariables = { "grid.subdivide" = { from = 1, to = 2 } }', 1, "it goes in steps"),
        (f"{DIAMETER}\nevaluations = 0", 2, "must be at least 1"),
        (f"{DIAMETER}\nseed = -1", 2, "must be at least 0"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(
    section: str, line: int, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "dish.toml"
    file.write_text(f"{PLAIN}[optimise]\n{section}\n", encoding="utf-8")
    assert main(["check", str(file)]) == 2
    told = capsys.readouterr().err
    assert f"dish.toml:{LINE + line - 1}: optimise" in told
    assert words in told


@pytest.mark.parametrize(("lost", "figure"), [("target", "rms"), ("load", "compliance")])
def test_figures_need_what_they_are_read_from(lost: str, figure: str) -> None:
    section = f"[optimise]\n{DIAMETER}\nobjectives = ['{figure}']\n"
    text = PLAIN.replace(f"[{lost}]", "[dropped]").replace("[dropped]", f"[{lost}]") + section
    begin = text.index(f"[{lost}]")
    text = text[:begin] + text[text.index("[", text.index("\n\n", begin)) :]
    with pytest.raises(InputError, match=rf"`{figure}` is not known without a \[{lost}\]"):
        case_from_text(text)


def test_a_case_that_asks_for_nothing_is_told_so() -> None:
    with pytest.raises(InputError, match="this section is missing"):
        question_of(case_from_text(PLAIN))
