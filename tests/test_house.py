"""The house rules that a program can check: size, names, directions, start-up, one version everywhere."""

from __future__ import annotations

import ast
import configparser
import re
import subprocess
import sys
from pathlib import Path

import pytest

import punchform

ROOT = Path(__file__).resolve().parents[1]
SOURCES = sorted((ROOT / "src" / "punchform").rglob("*.py"))
MOST_LINES = 350
EMPTY_NAMES = {"utils", "util", "helpers", "helper", "manager", "data", "process", "misc", "common"}
HEAVY = (
    "numpy",
    "scipy",
    "numba",
    "matplotlib",
    "pydantic",
    "rich",
    "sympy",
    "tomlkit",
    "jinja2",
    "rslab",
    "ezdxf",
    "OCP",
)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT / "src")))
def test_a_module_is_one_room_with_one_job(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= MOST_LINES
    assert path.stem not in EMPTY_NAMES
    named = {node.name for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    assert not named & EMPTY_NAMES


def test_every_folder_of_modules_is_a_package() -> None:
    assert all((folder / "__init__.py").is_file() for folder in {path.parent for path in SOURCES})


def test_every_package_says_what_it_is_for() -> None:
    silent = [str(path) for path in SOURCES if not ast.get_docstring(ast.parse(path.read_text("utf-8")))]
    assert not silent


def test_layers_are_written_down_and_checked_by_make() -> None:
    config = configparser.ConfigParser()
    config.read(ROOT / ".importlinter", encoding="utf-8")
    contract = config["importlinter:contract:layers"]
    assert contract["type"] == "layers"
    assert contract.getboolean("exhaustive")
    rooms = re.findall(r"\w+", contract["layers"])
    assert len(rooms) == len(set(rooms))
    assert {"cli", "report", "run", "mechanics", "wire", "punch", "grid", "case", "errors"} <= set(rooms)
    assert "lint-imports" in (ROOT / "Makefile").read_text(encoding="utf-8")


def loaded_after(code: str) -> set[str]:
    """Which of the heavy packages a fresh interpreter holds after running the code."""
    report = f"\nimport sys\nprint('loaded:', *[name for name in {HEAVY!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code + report], capture_output=True, text=True, check=True)
    return set(done.stdout.rpartition("loaded:")[2].split())


def test_importing_the_package_loads_nothing_heavy() -> None:
    assert loaded_after("import punchform") == set()


def test_the_verb_run_is_found_beside_the_module_of_its_name() -> None:
    ask = "import punchform.run\nfrom punchform import read_case, run\nassert callable(run), run"
    subprocess.run([sys.executable, "-W", "error", "-c", ask], check=True)


def test_asking_for_help_loads_nothing_heavy() -> None:
    ask = """
import sys
sys.argv = ["punchform", "--help"]
from punchform.cli import main
try:
    main()
except SystemExit as end:
    assert not end.code
"""
    assert loaded_after(ask) == set()


def test_one_version_everywhere() -> None:
    version = punchform.__version__
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.findall(r"^version: (\S+)$", citation, re.MULTILINE) == [version]
    newest = re.search(r"^## \[([^\]]+)\]", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert newest is not None
    assert newest[1] == version
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert 'dynamic = ["version"]' in project
    assert 'path = "src/punchform/__init__.py"' in project


def test_the_map_of_rooms_names_every_module() -> None:
    told = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    package = ROOT / "src" / "punchform"
    rooms = {path.name for path in package.glob("*.py")} | {path.parent.name for path in package.glob("*/__init__.py")}
    unnamed = {room for room in rooms if f"`{room}`" not in told and f"`{room.removesuffix('.py')}`" not in told}
    assert unnamed <= {"__init__.py", "__main__.py"}
