"""The front of the example against 200 random designs: not one of its points is beaten."""

from __future__ import annotations

import numpy as np
import pytest
import random_designs

from punchform.optimise.asking import evaluator
from punchform.optimise.evaluations import Record, evaluate
from punchform.optimise.pools import processes
from punchform.optimise.search import search

QUESTION = random_designs.question()
ROWS = random_designs.read_table()


def test_the_table_is_of_this_program() -> None:
    """Some of its rows, computed again."""
    designs = random_designs.designs(QUESTION)
    for row in (0, 77, 199):
        changes = QUESTION.space.changes(designs[row])
        done = evaluate(QUESTION.case, changes)
        assert [str(value) for value in changes.values()] == [ROWS[row][place] for place in changes]
        for name in QUESTION.figures:
            assert done.figures[name] == pytest.approx(float(ROWS[row][name]), rel=1e-6)


def test_no_random_design_of_200_dominates_a_point_of_the_front() -> None:
    with evaluator(QUESTION.case, Record(), processes(2)) as ask:
        found = search(QUESTION, ask)
    assert len(found.answers) == QUESTION.asked.evaluations == 60
    assert len(found.front) >= 20
    names = [one.figure for one in QUESTION.objectives]
    against = np.array([[float(row[name]) for name in names] for row in ROWS])
    against = against[against[:, 0] <= QUESTION.limits[0].limit]
    assert len(against) > 30
    for answer in found.front:
        own = np.array([answer.told[name] for name in names], dtype=float)
        assert not ((against <= own).all(axis=1) & (against < own).any(axis=1)).any()
