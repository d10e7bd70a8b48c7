"""`punchform sweep`: many designs of a case, all combinations of settings or samples of them, in one table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from punchform.case import Case, parse, read_text, unit
from punchform.cli.exits import Exit
from punchform.cli.sweeping import Means, check_designs, evaluated, workers_of
from punchform.cli.talk import notes
from punchform.errors import InputError

if TYPE_CHECKING:
    from punchform.optimise.evaluations import Evaluation

SHOWN = ("rms", "max_stress_ratio", "compliance", "mass")
"""Figures of which the summary says where they are smallest and largest."""


def sweep_case(
    path: str,
    output: str,
    *,
    over: Sequence[str],
    samples: int | None,
    seed: int,
    means: Means,
    format: str,
    overwrite: bool,
    as_json: bool,
) -> Exit:
    """Evaluate the designs and write the folder of the sweep, or go on with it.

    Raises InputError for a case, a design or a folder that cannot be used.
    """
    from punchform.optimise.sweep_folder import SWEEP, open_folder, request
    from punchform.optimise.tabulating import check_parquet

    source = read_text(path)
    case = parse(source)
    designs = _designs(case, over, samples, seed)
    try:
        check_designs(case, designs)
    except InputError as error:
        raise source.placed(error) from None
    if format == "parquet":
        check_parquet()
    asked = request("sweep", case, tuple(over), samples=samples, seed=seed)
    places, parquet = tuple(designs[0]), format == "parquet"
    with workers_of(means) as workers:
        folder = open_folder(output, asked, case, overwrite=overwrite)
        done = evaluated(case, designs, folder, asked, workers, means.voice, places=places, parquet=parquet)
    failed = [evaluation for evaluation in done if evaluation.failed]
    if failed:
        notes([f"{len(failed)} of {len(done)} designs failed, the first of them: {failed[0].failure}"], means.voice)
    print((folder / SWEEP).read_text("utf-8").rstrip() if as_json else summary(case, done, folder))
    return Exit.NO_EQUILIBRIUM if len(failed) == len(done) else Exit.DONE


def _designs(case: Case, over: Sequence[str], samples: int | None, seed: int) -> list[Mapping[str, Any]]:
    import numpy as np

    from punchform.optimise.designs import combinations, hypercube, variation

    variations = [variation(case, text) for text in over]
    if samples is None:
        return list(combinations(variations))
    if seed < 0:
        raise InputError.of(f"the seed is {seed}", where="--seed", hint="give a whole number from 0 up")
    return list(hypercube(variations, samples, np.random.default_rng(seed)))


def summary(case: Case, done: Sequence[Evaluation], folder: Path) -> str:
    """What a person wants to know first about a sweep."""
    from punchform.optimise.figures import FIGURES
    from punchform.optimise.tabulating import TABLE

    good = [evaluation for evaluation in done if not evaluation.failed]
    facts = {"designs": f"{len(good)} done, {len(done) - len(good)} failed"}
    for name in SHOWN:
        known = [(value, one) for one in good if (value := one.figures.get(name)) is not None]
        if known:
            least, most = min(known, key=lambda pair: pair[0]), max(known, key=lambda pair: pair[0])
            own = FIGURES[name].unit
            for words, (value, one) in (("smallest", least), ("largest", most)):
                facts[f"{words} {name}"] = f"{value:.4g} {own}".rstrip() + f" with {_settings(case, one)}"
    facts["table"] = str(folder / TABLE)
    width = max(map(len, facts))
    return "\n".join([case.title, *(f"  {name:<{width}}  {fact}" for name, fact in facts.items())])


def _settings(case: Case, one: Evaluation) -> str:
    words = []
    for place, value in one.changes.items():
        shown = f"{value:.6g} {unit(case, place)}".rstrip() if isinstance(value, int | float) else str(value)
        words.append(f"{place} = {shown}")
    return ", ".join(words)
