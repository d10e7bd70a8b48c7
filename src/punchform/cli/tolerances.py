"""`punchform tolerances`: what the scatter of a case does to its accuracy."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from punchform.case import Case, parse, read_text
from punchform.cli.exits import Exit
from punchform.cli.sweeping import Means, check_designs, evaluated, workers_of
from punchform.cli.talk import notes as say_notes
from punchform.errors import InputError

if TYPE_CHECKING:
    from punchform.optimise.tolerances import Tolerances

MOST = 1_000_000


def tolerances_of(
    path: str, output: str, *, samples: int, seed: int, means: Means, format: str, overwrite: bool, as_json: bool
) -> Exit:
    """Evaluate the case and samples of its scatter, and write the folder, or go on with it.

    Raises InputError for a case or a folder that cannot be used, and when too few samples have an rms.
    """
    import numpy as np

    from punchform.optimise.evaluations import designed
    from punchform.optimise.sweep_folder import open_folder, request
    from punchform.optimise.tabulating import check_parquet
    from punchform.optimise.tolerances import FEWEST, draws, places, tolerances
    from punchform.report.tolerances import notes, tolerances_json, write_tolerances_report
    from punchform.store import RESULT, replace_file

    source = read_text(path)
    case = parse(source)
    if not FEWEST <= samples <= MOST:
        raise InputError.of(
            f"{samples} samples are asked for", where="--samples", hint=f"give {FEWEST} to {MOST}, 200 as a rule"
        )
    if seed < 0:
        raise InputError.of(f"the seed is {seed}", where="--seed", hint="give a whole number from 0 up")
    try:
        designs = list(draws(case, samples, np.random.default_rng(seed)))
        check_designs(case, designs)
    except InputError as error:
        raise source.placed(error) from None
    if format == "parquet":
        check_parquet()
    asked = request("tolerances", case, samples=samples, seed=seed)
    nominal, varying, parquet = designed(case, {}).key, places(case), format == "parquet"
    with workers_of(means) as workers:
        folder = open_folder(output, asked, case, overwrite=overwrite)
        done = evaluated(case, [{}, *designs], folder, asked, workers, means.voice, places=varying, parquet=parquet)
    found = tolerances(case, done[0], done[1:])
    assert done[0].key == nominal
    text = tolerances_json(case, found, samples=samples, seed=seed)
    replace_file(folder / RESULT, text)
    write_tolerances_report(case, found, folder)
    say_notes(notes(found, case), means.voice)
    print(text.rstrip() if as_json else summary(case, found, folder))
    return Exit.DONE


def summary(case: Case, found: Tolerances, folder: Path) -> str:
    """What a person wants to know first."""
    percentiles = found.percentiles
    nominal = "failed" if found.nominal is None else f"{found.nominal:.4g} mm"
    facts = {
        "rms": f"{found.mean:.4g} mm on average, standard deviation {found.deviation:.3g} mm; nominal {nominal}",
        "90 % between": f"{percentiles[5]:.4g} and {percentiles[95]:.4g} mm",
        "yield": f"{100 * found.yielded:.1f} % within {found.tolerance:g} mm "
        f"({found.within} of {found.samples}; {100 * found.low:.1f} to {100 * found.high:.1f} % with 95 % confidence)",
    }
    for number, one in enumerate(found.influences, start=1):
        told = f"{100 * one.share:.0f} % of the variance, standardised slope {one.slope:+.2f}"
        facts[f"influence {number}"] = f"{one.place}: {told}"
    facts["report"] = str(folder / "report.html")
    width = max(map(len, facts))
    return "\n".join([case.title, *(f"  {name:<{width}}  {fact}" for name, fact in facts.items())])
