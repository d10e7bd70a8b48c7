"""Several runs side by side: their figures of result.json, how they differ from the first, and what differs in the
cases. No HTML here."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from punchform import __version__
from punchform.antenna import highest_frequency
from punchform.case import Case, write_case
from punchform.export.result import RESULT_SCHEMA, plain, result
from punchform.report.quantities import strain
from punchform.run import Run

LOSS = 0.5
"""The loss of gain [dB] at which the highest frequency is told."""
LONG = 60
"""A setting that takes more letters than this is told by its length."""
NOT_GIVEN = "not given"
LEFT_OUT = ("schema",)
"""Keys of a case that are not told."""

STRAIN = "formed.max_axial_strain"

FIGURES = (
    ("formed.energy_mJ", "Elastic energy in the tool", "mJ", 1.0),
    ("formed.max_shear_deg", "Largest shear in the tool", "°", 1.0),
    ("formed.draw_in_mm", "Largest draw-in of the edge", "mm", 1.0),
    ("formed.axial_force.max_N", "Highest axial force in a wire, in the tool", "N", 1.0),
    ("formed.axial_force.min_N", "Lowest axial force in a wire (below zero: pressed)", "N", 1.0),
    (STRAIN, "Largest {}, in the tool", "%", 100.0),
    ("formed.plastic.max_plastic_strain", "Largest plastic strain", "%", 100.0),
    ("formed.plastic.yielded_share", "Wire pieces that have yielded", "%", 100.0),
    ("formed.max_stress_MPa", "Largest stress in the tool", "MPa", 1.0),
    ("formed.max_stress_ratio", "Largest stress in the tool / yield strength", "", 1.0),
    ("formed.contact.push_N", "Press force along the axis", "N", 1.0),
    ("formed.contact.max_N", "Highest contact force on a crossing", "N", 1.0),
    ("formed.contact.min_N", "Lowest contact force (below zero: held down)", "N", 1.0),
    ("released.energy_mJ", "Elastic energy after the release", "mJ", 1.0),
    ("released.apex_mm", "Release: the middle moves by", "mm", 1.0),
    ("released.max_sag_mm", "Release: the lowest crossing moves by", "mm", 1.0),
    ("released.springback.total.rms_mm", "Release: springback, rms", "mm", 1.0),
    ("released.max_stress_MPa", "Largest stress after the release", "MPa", 1.0),
    ("loaded.rms_deflection_mm", "Load: rms deflection", "mm", 1.0),
    ("loaded.compliance_mm_per_N", "Load: rms deflection per newton", "mm/N", 1.0),
    ("loaded.mass_kg", "Mass of the wire", "kg", 1.0),
    ("accuracy.judged_on.rms_mm", "Accuracy: rms deviation as judged", "mm", 1.0),
    ("accuracy.judged_on.tolerance_mm", "Accuracy: tolerance", "mm", 1.0),
)
"""Where a figure stands in result.json, what it is called, its unit, and how many of that make one of the file's. What
the strain is called depends on the wires."""


@dataclass(frozen=True)
class Side:
    """One of the runs: its name, the run, and the content of its result.json."""

    name: str
    run: Run
    content: Mapping[str, Any]


@dataclass(frozen=True)
class Line:
    """One figure of all runs: its key, name and unit, and its value in each, None where it is not known."""

    key: str
    name: str
    unit: str
    values: tuple[float | None, ...]

    @property
    def differences(self) -> tuple[float | None, ...]:
        """Each value less that of the first run, in the unit of the figure."""
        first = self.values[0]
        return tuple(None if value is None or first is None else value - first for value in self.values)

    @property
    def percent(self) -> tuple[float | None, ...]:
        """The differences in per cent of the first value; None where a value is below zero or the first is zero, of
        which shares say nothing."""
        first = self.values[0]
        return tuple(
            None if value is None or not first or min(first, value) < 0 else 100.0 * (value - first) / first
            for value in self.values
        )


def sides(named: Sequence[tuple[str, Run]]) -> tuple[Side, ...]:
    """The runs with their results, each under the name it was given."""
    return tuple(Side(name, run, result(run)) for name, run in named)


def lines(runs: Sequence[Side]) -> tuple[Line, ...]:
    """The figures of the runs, those that at least one of them has."""
    told = [
        Line(key, _name(key, name, runs), unit, tuple(_scaled(at(side.content, key), times) for side in runs))
        for key, name, unit, times in FIGURES
    ]
    told += [
        Line("best_fit.rms_mm", "Accuracy: rms after the best fit", "mm", tuple(_best_fit(side) for side in runs)),
        Line(
            "as_held.highest_frequency_GHz",
            f"Antenna, as held: {LOSS:g} dB are lost at",
            "GHz",
            tuple(_frequency(side, "as held") for side in runs),
        ),
        Line(
            "best_fit.highest_frequency_GHz",
            f"Antenna, best fit: {LOSS:g} dB are lost at",
            "GHz",
            tuple(_frequency(side, _fit_name(side)) for side in runs),
        ),
    ]
    return tuple(line for line in told if any(value is not None for value in line.values))


def at(content: Mapping[str, Any], key: str) -> float | None:
    """The number at a dotted path of result.json; None where there is none."""
    found: Any = content
    for part in key.split("."):
        if not isinstance(found, Mapping) or part not in found:
            return None
        found = found[part]
    return float(found) if isinstance(found, int | float) and not isinstance(found, bool) else None


def changed_settings(runs: Sequence[Side]) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """The keys of the case files that differ, each with its value in every run."""
    cases = [settings(side.run.case) for side in runs]
    keys = dict.fromkeys(key for case in cases for key in case)
    found = ((key, tuple(case.get(key, NOT_GIVEN) for case in cases)) for key in keys)
    return tuple((key, values) for key, values in found if len(set(values)) > 1)


def settings(case: Case) -> dict[str, str]:
    """A case as its file would say it: dotted keys and their values as text; lists are one value."""
    found: dict[str, str] = {}

    def walk(table: Mapping[str, Any], above: str) -> None:
        for key, value in table.items():
            if isinstance(value, Mapping):
                walk(value, f"{above}{key}.")
            elif above or key not in LEFT_OUT:
                found[above + key] = json.dumps(value, ensure_ascii=False) if not isinstance(value, str) else value

    walk(tomllib.loads(write_case(case)), "")
    return found


def shortened(value: str) -> str:
    """A setting as a table shows it: a long list by how much it holds."""
    return value if len(value) <= LONG else f"{value[: LONG - 20]}… ({len(value)} letters)"


def comparison_json(runs: Sequence[Side], words: Sequence[str], nearest: str | None) -> str:
    """The comparison as strictly valid JSON: figures with their differences to the first run, settings that differ."""
    content = {
        "schema": RESULT_SCHEMA,
        "version": __version__,
        "runs": [{"name": side.name, "case_title": side.run.case.title} for side in runs],
        "nearest": nearest,
        "words": list(words),
        "figures": [
            {
                "key": line.key,
                "name": line.name,
                "unit": line.unit,
                "values": line.values,
                "differences": line.differences,
                "percent": line.percent,
            }
            for line in lines(runs)
        ],
        "settings": [{"key": key, "values": values} for key, values in changed_settings(runs)],
    }
    return json.dumps(plain(content), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def _name(key: str, name: str, runs: Sequence[Side]) -> str:
    """What a figure is called: where some wires yield and others do not, the strain has both names."""
    if key != STRAIN:
        return name
    return name.format(
        " or ".join(dict.fromkeys(strain(yields=one.run.formed.hardening is not None).label for one in runs))
    )


def _scaled(value: float | None, times: float) -> float | None:
    return None if value is None else times * value


def _fit_name(side: Side) -> str:
    accuracy = side.content["accuracy"]
    return "" if accuracy is None else str(accuracy["best_fit"])


def _best_fit(side: Side) -> float | None:
    accuracy = side.content["accuracy"]
    if accuracy is None:
        return None
    return at(accuracy, f"alignments.{accuracy['best_fit']}.deviations.{accuracy['judged_on']['measure']}.rms_mm")


def _frequency(side: Side, alignment: str) -> float | None:
    """The frequency [GHz] at which so much gain is lost, after Ruze; None for what is no antenna."""
    accuracy = side.content["accuracy"]
    if accuracy is None or accuracy["focal_length_mm"] is None:
        return None
    error = at(accuracy, f"alignments.{alignment}.deviations.half-path.sigma_mm")
    return None if not error else highest_frequency(error, LOSS)
