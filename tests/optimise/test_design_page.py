"""The page on design searches says what the program does."""

from __future__ import annotations

import re
from pathlib import Path

from punchform.case import case_from_text, packaged_text, read_case
from punchform.optimise.problem import question_of

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "design_search.md").read_text(encoding="utf-8")


def test_the_section_on_the_page_is_that_of_the_packaged_case() -> None:
    section = re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    assert section is not None
    text = packaged_text("design").partition("[optimise]")[0] + section[1]
    assert case_from_text(text) == read_case("packaged:design")


def test_the_cost_on_the_page_can_be_asked_for() -> None:
    formula = re.search(r'`cost = ("[^"]*")`', PAGE)
    assert formula is not None
    section = packaged_text("design").replace("evaluations = 60", f"evaluations = 60\ncost = {formula[1]}")
    question = question_of(case_from_text(section))
    assert question.cost is not None
    assert question.cost.names == ("wire_length", "mass", "wire.diameter")


def test_the_program_on_the_page_runs_as_far_as_it_is_cheap() -> None:
    """Everything but the search itself: names and arguments."""
    program = re.search(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert program is not None
    begun = program[1].partition("    with Record()")[0]
    names: dict[str, object] = {"__name__": "__main__"}
    exec(compile(begun, "page", "exec"), names)
    assert names["question"] == question_of(read_case("packaged:design"))
