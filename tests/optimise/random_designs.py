"""200 random designs of the packaged case `design`, and the figures of each: what a front has to stand against.

Run as a script it computes them and writes random_designs.csv beside itself; that takes a minute.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from punchform.arrays import Floats
from punchform.case import read_case
from punchform.optimise.evaluations import Record, evaluate
from punchform.optimise.problem import Question, question_of

TABLE = Path(__file__).with_suffix(".csv")
COUNT, SEED = 200, 99


def question() -> Question:
    """What the packaged case asks."""
    return question_of(read_case("packaged:design"))


def designs(asked: Question) -> Floats:
    """Designs (200, n), each variable evenly over its range or list and on its own."""
    return asked.space.nearest(np.random.default_rng(SEED).random((COUNT, len(asked.space.variables))))


def read_table() -> list[dict[str, str]]:
    """The rows of the table: settings and figures by their names."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def main(record: Record | None = None) -> None:
    """Evaluate all designs and write the table."""
    asked = question()
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*(one.place for one in asked.space.variables), *asked.figures])
        for design in designs(asked):
            changes = asked.space.changes(design)
            done = evaluate(asked.case, changes) if record is None else record.evaluated(asked.case, changes)
            told = asked.told(changes, done.figures)
            writer.writerow([*changes.values(), *(f"{told[name]:.9g}" for name in asked.figures)])


if __name__ == "__main__":
    main()
