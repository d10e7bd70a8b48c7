"""The documents hold together: cited equations and linked pages exist, and the derivations are right."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from page_blocks import DIRECTIVES, LANGUAGES, ROOT, blocks, missing, pages, reads, with_sections

from punchform.arrays import Floats

DOCS = ROOT / "docs"
DECISIONS = DOCS / "decisions"
PAGES = pages()
CODE = sorted(
    path
    for folder in ("src", "tests", "scripts")
    for path in (ROOT / folder).rglob("*")
    if path.suffix in {".py", ".toml", ".html", ".j2"} and path != Path(__file__).resolve()
)

OWN = r"\(\d+\.\d+\)"
JOIN = r"(?:\s*(?:,|and|to|-|–)\s*)+"
EQUATIONS = re.compile(rf"Eqs?\.\s*({OWN}(?:{JOIN}{OWN})*)")
PAPER = re.compile(r"P\((\d+)(?:\s*[-–]\s*(\d+))?\)(?:\s*[-–]\s*P?\((\d+)\))?")


def cited_equations(text: str) -> set[str]:
    """Our own numbers in "Eq. (3.2)", "Eqs. (3.2) and (3.4)", "Eqs. (4.1)-(4.3)"; a range counts whole."""
    found: set[str] = set()
    for chain in EQUATIONS.findall(text):
        found |= set(re.findall(r"\d+\.\d+", chain))
        for first, last in re.findall(r"\((\d+\.\d+)\)\s*[-–]\s*\((\d+\.\d+)\)", chain):
            section, start = first.split(".")
            stop = last.split(".")[1]
            found |= {f"{section}.{n}" for n in range(int(start), int(stop) + 1)}
    return found


def cited_paper(text: str) -> set[int]:
    """The paper's numbers in "P(16)", "P(5–7)", "P(16)–(17)", "P(3)–P(7)"; a range counts whole."""
    found: set[int] = set()
    for first, last, far in PAPER.findall(text):
        found |= set(range(int(first), int(far or last or first) + 1))
    return found


def defined(page: Path) -> tuple[set[str], set[int]]:
    """The numbers that stand in bold on a page: where an equation is defined and not only mentioned."""
    text = page.read_text(encoding="utf-8")
    own = set(re.findall(r"\*\*\((\d+\.\d+)\)\*\*", text))
    return own, {int(n) for n in re.findall(r"\*\*P\((\d+)\)\*\*", text)}


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("Eq. (3.2)", {"3.2"}),
        ("Eqs. (4.1)-(4.3)", {"4.1", "4.2", "4.3"}),
        ("Eqs. (3.2) and (3.4), see (9.9)", {"3.2", "3.4"}),
        ("(3.2) alone", set()),
    ],
)
def test_citations_are_read(text: str, numbers: set[str]) -> None:
    assert cited_equations(text) == numbers


@pytest.mark.parametrize(
    ("text", "numbers"),
    [("P(16)", {16}), ("P(5–7)", {5, 6, 7}), ("P(16)–(17)", {16, 17}), ("P(3)-P(5), P(18)", {3, 4, 5, 18})],
)
def test_citations_of_the_paper_are_read(text: str, numbers: set[int]) -> None:
    assert cited_paper(text) == numbers


def test_every_cited_equation_exists() -> None:
    own, paper = defined(DOCS / "theory.md")
    unknown = {}
    for path in [*CODE, *PAGES]:
        text = path.read_text(encoding="utf-8")
        numbers = sorted(cited_equations(text) - own) + [f"P({n})" for n in sorted(cited_paper(text) - paper)]
        if numbers:
            unknown[str(path.relative_to(ROOT))] = numbers
    assert not unknown


def test_code_cites_equations_and_not_sections_of_a_page() -> None:
    loose = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in CODE
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1)
        if re.search(r"\bTHEORY\b|§", line)
    ]
    assert not loose, "cite an equation, `Eq. (3.5)`, instead of:\n" + "\n".join(loose)


def test_every_equation_of_the_paper_has_its_row() -> None:
    rows = cited_paper("".join(re.findall(r"^\|([^|]*)\|", (DOCS / "paper.md").read_text("utf-8"), re.MULTILINE)))
    _, paper = defined(DOCS / "theory.md")
    assert rows == paper == set(range(1, 21))


def test_what_the_page_of_the_paper_names_is_in_the_code() -> None:
    text = (DOCS / "paper.md").read_text(encoding="utf-8")
    places = re.findall(r"`([a-z_/]+\.py)(?::([A-Za-z_]+))?`", text)
    assert places
    lost = []
    for file, name in places:
        path = ROOT / "src" / "punchform" / file
        if not path.is_file():
            lost.append(file)
        elif name and not re.search(rf"\b(?:def|class) {name}\b|^{name}\b", path.read_text("utf-8"), re.MULTILINE):
            lost.append(f"{file}:{name}")
    assert not lost


def links(page: Path) -> Iterator[tuple[str, str]]:
    """Relative links of a page as (path, anchor), code blocks left out."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if not re.match(r"[a-z]+:", target):
            path, _, anchor = target.partition("#")
            yield path, anchor


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as the common renderers make them."""
    heads = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.strip().lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_relative_link_resolves(page: Path) -> None:
    broken = []
    for path, anchor in links(page):
        target = (page.parent / path).resolve() if path else page
        if not target.exists() or (anchor and anchor not in anchors(target)):
            broken.append(path + ("#" + anchor if anchor else ""))
    assert not broken


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_block_is_of_a_kind_that_is_executed_or_plain_text(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert len(re.findall(r"^```", text, re.MULTILINE)) == 2 * len([b for b in blocks(text) if not b.hidden])
    for block in (block for block in blocks(text) if not block.hidden):
        directive = block.language.partition(" ")[0]
        known = block.language in LANGUAGES or directive in DIRECTIVES
        assert known, f"line {block.line}: nothing executes a block of `{block.language}`"
        assert (
            block.language != "text" or "printed" in block.remarks or not re.search(r"^\$ ", block.text, re.MULTILINE)
        )
        assert block.language != "csv" or "file" in block.remarks, f"line {block.line}: which file is it?"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_indented_blocks_are_formulas_and_not_commands(page: Path) -> None:
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    assert not re.findall(r"^    (?:\$ |punchform |python |make |pip |import |from \w+ import )", text, re.MULTILINE)


def test_a_block_shows_lines_in_their_order_and_leaves_out_where_it_says_so() -> None:
    printed = "one 1.5 mm\n  two\nthree\n"
    assert missing(["one ... mm", "...", "three"], printed) == ""
    assert missing(["one 1.6 mm"], printed) == "one 1.6 mm"
    assert missing(["three", "two"], printed) == "two"
    assert missing(["tw"], printed) == "tw"


def test_sections_of_a_page_stand_in_place_of_those_of_a_case() -> None:
    case = "schema = 1\n[wire]\na = 1\n[wire.more]\nb = 2\n[grid]\nc = 3\n"
    assert tomllib.loads(with_sections(case, 'title = "x"\n[wire]\nd = 4\n')) == {
        "schema": 1,
        "title": "x",
        "grid": {"c": 3},
        "wire": {"d": 4},
    }


def test_the_index_of_decisions_lists_every_page() -> None:
    pages = {path.name for path in DECISIONS.glob("*.md")} - {"README.md"}
    assert {path for path, _ in links(DECISIONS / "README.md")} == pages


# --- derivations of theory.md, compared with exact rotations differenced along random paths -----------------

STEP = 1e-3


def rotation(vector: Floats) -> Floats:
    """The rotation matrix exp([vector]×), by Rodrigues' formula."""
    angle = float(np.linalg.norm(vector))
    skew = np.cross(np.eye(3), vector / angle)
    return np.asarray(np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew)


def rotation_vector(matrix: Floats) -> Floats:
    """The vector of a rotation matrix of less than half a turn."""
    axis = 0.5 * np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]])
    sine = float(np.linalg.norm(axis))
    angle = np.arctan2(sine, 0.5 * (np.trace(matrix) - 1))
    return np.asarray(axis * (angle / sine if sine > 0 else 1.0))


def derivatives(path: Callable[[float], Floats]) -> tuple[Floats, Floats]:
    """First and second derivative at 0 by central differences of fourth order."""
    far, near, here = path(-2 * STEP), path(-STEP), path(0.0)
    ahead, farther = path(STEP), path(2 * STEP)
    first = (far - 8 * near + 8 * ahead - farther) / (12 * STEP)
    second = (-far + 16 * near - 30 * here + 16 * ahead - farther) / (12 * STEP**2)
    return first, second


@pytest.mark.parametrize("seed", range(5))
def test_tilt_and_spin_compose_as_in_equation_4_1(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = rng.normal(size=3)
    n /= np.linalg.norm(n)
    tilt, spin = np.cross(n, rng.normal(size=3)), rng.normal()

    def path(e: float) -> Floats:
        return rotation_vector(rotation(e * tilt) @ rotation(e * spin * n)) if e else np.zeros(3)

    first, second = derivatives(path)
    np.testing.assert_allclose(first, tilt + spin * n, atol=1e-9)
    np.testing.assert_allclose(0.5 * second, 0.5 * spin * np.cross(tilt, n), atol=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_frame_from_differences_turns_as_in_equations_4_2_and_4_3(seed: int) -> None:
    rng = np.random.default_rng(seed)
    normal, along = rng.normal(size=(2, 3, 3))

    def frame(e: float) -> Floats:
        """Columns t, j, n of the frame of a moving normal and a moving difference of positions."""
        n = normal[0] + e * normal[1] + e**2 / 2 * normal[2]
        n = n / np.linalg.norm(n)
        q = tangent(e)
        t = q / np.linalg.norm(q)
        return np.column_stack((t, np.cross(n, t), n))

    def tangent(e: float) -> Floats:
        n = normal[0] + e * normal[1] + e**2 / 2 * normal[2]
        n = n / np.linalg.norm(n)
        tau = along[0] + e * along[1] + e**2 / 2 * along[2]
        return np.asarray(tau - n * (n @ tau))

    w1, w2 = derivatives(lambda e: rotation_vector(frame(e) @ frame(0.0).T))
    n1, n2 = derivatives(lambda e: frame(e)[:, 2])
    q0, (q1, q2) = tangent(0.0), derivatives(tangent)
    t, j, n = frame(0.0).T
    length = np.linalg.norm(q0)
    s = j @ q1 / length
    np.testing.assert_allclose(w1, np.cross(n, n1) + n * s, atol=1e-6)

    m = rng.normal(size=3)
    jt2 = j @ q2 / length - 2 * (j @ q1) * (t @ q1) / length**2
    curvature = np.cross(m, n) @ n2 + s * (m @ n1) + (m @ n) * (jt2 + (n1 @ t) * (n1 @ j))
    np.testing.assert_allclose(m @ w2, curvature, rtol=1e-4, atol=1e-4)

    tau1, tau2, tau0 = along[1], along[2], along[0]
    jq2 = j @ tau2 - 2 * (j @ n1) * (n1 @ tau0 + n @ tau1) - (j @ n2) * (n @ tau0)
    np.testing.assert_allclose(j @ q2, jq2, atol=1e-4)


@pytest.mark.parametrize("seed", range(5))
def test_energy_on_a_sphere_curves_as_in_equation_4_4(seed: int) -> None:
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    radius, force, stiffness = 3.0, rng.normal(size=3), rng.normal(size=(3, 3))
    H = stiffness + stiffness.T
    x = radius * normal
    y = np.cross(normal, rng.normal(size=3))

    def energy(e: float) -> Floats:
        moved = x + e * y
        moved = radius * moved / np.linalg.norm(moved)
        return np.array(force @ (moved - x) + 0.5 * (moved - x) @ H @ (moved - x))

    # gap = |x| - radius: |gradient| = 1, Hessian (I - N N') / radius.
    multiplier = -force @ normal
    bent = (np.eye(3) - np.outer(normal, normal)) / radius
    _, second = derivatives(energy)
    np.testing.assert_allclose(second, y @ (H + multiplier * bent) @ y, rtol=1e-6, atol=1e-6)


def test_a_block_is_left_only_to_a_test_that_reads_its_page() -> None:
    own = "tests/test_stretch_forming.py"
    assert reads(f"{own}::test_the_page_shows_the_packaged_case", "docs/stretch_forming.md")
    assert not reads(f"{own}::test_the_page_shows_the_packaged_case", "docs/tutorial.md")
    assert not reads(f"{own}::test_the_page", "docs/stretch_forming.md"), "there is no such test"
    assert not reads(own, "docs/stretch_forming.md")
    assert not reads("tests/test_gone.py::test_the_page_shows_the_packaged_case", "docs/stretch_forming.md")
