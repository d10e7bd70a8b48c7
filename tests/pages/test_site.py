"""What the site makes from the program: tables of all keys and commands, docstrings as they are, links that hold."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import pytest
from page_blocks import ROOT

from punchform.case.schema import json_schema
from punchform.cli import COMMANDS

Load = Callable[[str], ModuleType]


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch) -> Load:
    """Import an extension of the site by its name."""
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "_ext"))
    return importlib.import_module


def keys(schema: Any) -> Iterator[str]:
    """All keys that a case file can have."""
    for part in (schema, *schema["$defs"].values()):
        yield from part.get("properties", {})


def test_every_key_of_a_case_has_its_row(load: Load) -> None:
    schema, text = json_schema(), load("case_keys").markdown()
    assert not [key for key in keys(schema) if f"| `{key}` |" not in text]
    assert all(f"(case-{name.lower()})=" in text for name in schema["$defs"])


def test_a_row_tells_unit_limit_and_default(load: Load) -> None:
    rows = load("case_keys").markdown().splitlines()
    (tolerance,) = (row for row in rows if row.startswith("| `tolerance` |") and "mm" in row)
    assert 'quantity such as `"0.75 mm"`, more than 0' in tolerance
    (weave,) = (row for row in rows if row.startswith("| `weave` |"))
    assert '`"plain"` or `"same"` or `"stacked"` | `"plain"` |' in weave
    (half_angle,) = (row for row in rows if row.startswith("| `half_angle` |"))
    assert "more than 0 and less than 1.5708 | **required**" in half_angle


def test_every_command_has_its_table(load: Load) -> None:
    text = load("commands").markdown()
    assert all(f"## `punchform {name}`" in text for name in COMMANDS)
    assert "`--over PLACE=VALUES`" in text
    assert "**Required.**" in text


def test_docstrings_show_what_they_say(load: Load) -> None:
    plain = load("plain_docstrings").plain
    told = plain(["Takes |k' - k| of `C`, a* and x_.", "", "    F = C D", "", "- one", "- two", "", ">>> 1 + 1", "2"])
    assert told[0] == r"Takes \|k' - k\| of ``C``, a\* and x\_."
    assert told[2:6] == ["::", "", "    F = C D", ""]
    assert told[6:] == ["- one", "- two", "", ">>> 1 + 1", "2"]


def test_links_out_of_the_pages_find_their_place(load: Load) -> None:
    rewritten = load("beside").rewritten
    assert rewritten("[a](../README.md)", "docs/theory.md") == "[a](/index.md)"
    assert rewritten("[a](paper.md#x)", "docs/theory.md") == "[a](paper.md#x)"
    assert rewritten("[a](docs/paper.md#x)", "CONTRIBUTING.md") == "[a](/paper.md#x)"
    assert rewritten("[a](.importlinter)", "CONTRIBUTING.md") == "a"
    assert rewritten("```text\n[a](../README.md)\n```", "docs/theory.md") == "```text\n[a](../README.md)\n```"
    assert rewritten("[a](https://b.c)", "docs/theory.md") == "[a](https://b.c)"


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("see Eqs. (3.2) and (3.4), P(16)", ["eq-3-2", "eq-3-4", "paper-16"]),
        ("Eq. (4.1)-(4.3)", ["eq-4-1", "eq-4-3"]),
        ("(3.2) alone", []),
    ],
)
def test_cited_equations_become_links(load: Load, text: str, names: list[str]) -> None:
    equations = load("equations")
    chains = list(equations.CHAIN.finditer(text))
    found = [one.groups() for chain in chains for one in equations.ONE.finditer(text, chain.start(), chain.end())]
    assert [equations.anchor(*one) for one in found] == names
