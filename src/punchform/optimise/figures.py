"""The figures of a run that sweeps tabulate, searches improve and sensitivities are told of."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from punchform.accuracy import Measure
from punchform.antenna import loss
from punchform.case import Case
from punchform.errors import InputError
from punchform.export.told import told
from punchform.forces import wire_mass
from punchform.run import Run
from punchform.wire import pieces, stiffness


@dataclass(frozen=True)
class Figure:
    """A number of a run: its unit, what it is, what it is read from (None where the run does not have it).

    deviation: whose rms it is, of a measure as held or fitted; None for other figures.
    """

    name: str
    unit: str
    words: str
    of: Callable[[Run], float | None]
    deviation: Deviation | None = None


@dataclass(frozen=True)
class Deviation:
    """Which deviation an rms is of; that which the target judges where the measure is None."""

    measure: Measure | None
    fitted: bool = False

    def judged(self, case: Case) -> tuple[Measure, bool]:
        """Measure and whether after the best fit, of a case. Raises InputError for one without target."""
        if case.target is None:
            raise InputError.of("the case has no [target], so there is no deviation from it", where="target")
        if self.measure is None:
            return case.target.measure, case.target.alignment == "best fit"
        return self.measure, self.fitted


def figures(run: Run) -> dict[str, float | None]:
    """All figures of a run by their names; None for those it does not have, as an rms without a target."""
    return {name: figure.of(run) for name, figure in FIGURES.items()}


def figure(name: str) -> Figure:
    """The figure of a name. Raises InputError for one that is not known."""
    if name not in FIGURES:
        raise InputError.of(f"there is no figure {name!r}", hint="known are " + ", ".join(FIGURES))
    return FIGURES[name]


def in_its_tool(case: Case) -> tuple[str, ...]:
    """What to know of figures of accuracy where the grid is not let go; nothing where it is."""
    if case.target is None or any(step.kind == "release" for step in case.steps):
        return ()
    return ("the case has no [release]: this is the grid in its tool, where nothing has sprung back yet",)


def gain_loss(run: Run, *, frequency: float) -> float | None:
    """Loss of gain [dB] at a frequency [GHz] by the half-path error after the best fit, Eq. (9.19)."""
    from punchform.antenna import SPEED_OF_LIGHT

    error = FIGURES["rms_half_path_fitted"].of(run)
    return None if error is None else loss(error, SPEED_OF_LIGHT / frequency)


def wire_length(run: Run) -> float:
    """Length of all wire of the whole flat grid, crimp included [mm]."""
    grid = run.stages[0].done.grid
    lengths = _lengths(run.case)
    return float(
        grid.copies * sum(grid.weight[grid.kind == kind].sum() * length for kind, length in enumerate(lengths))
    )


def mass(run: Run) -> float | None:
    """Mass of all wire of the whole flat grid [kg], None without a density."""
    return wire_mass(run.stages[0].done.grid, run.case.wire, _lengths(run.case))


def _lengths(case: Case) -> tuple[float, ...]:
    """Length of the wire in each kind of piece [mm]."""
    return tuple(one.wire_length for one in pieces(stiffness(case.wire, case.grid.step), case.grid.subdivide))


def _judged(run: Run) -> float | None:
    return None if run.accuracy is None else run.accuracy.judged.rms


def _rms(measure: Measure, *, fitted: bool) -> tuple[Callable[[Run], float | None], Deviation]:
    def of(run: Run) -> float | None:
        if run.accuracy is None:
            return None
        aligned = run.accuracy.fitted if fitted else run.accuracy.as_held
        return aligned.statistics[measure].rms

    return of, Deviation(measure, fitted)


def _largest_stress_ratio(run: Run) -> float | None:
    ratio = run.formed.whole.stress_ratio
    return float(ratio.max()) if ratio.size and math.isfinite(ratio.max()) else None


def _apex(run: Run) -> float | None:
    released = told(run).released
    return None if released is None else released.apex


def _sag(run: Run) -> float | None:
    released = told(run).released
    return None if released is None else released.max_sag


def _held(run: Run) -> float | None:
    released = told(run).released
    return None if released is None else released.hold.count


def _compliance(run: Run) -> float | None:
    loaded = told(run).loaded
    return None if loaded is None else loaded.compliance


def _deflection(run: Run) -> float | None:
    loaded = told(run).loaded
    return None if loaded is None else loaded.rms_deflection


_ALL = (
    Figure("rms", "mm", "rms deviation that decides: measure and alignment of [target]", _judged, Deviation(None)),
    Figure("rms_normal", "mm", "rms deviation along the normals, as held", *_rms("normal", fitted=False)),
    Figure("rms_axial", "mm", "rms deviation along the axis, as held", *_rms("axial", fitted=False)),
    Figure("rms_half_path", "mm", "rms half-path error, as held", *_rms("half-path", fitted=False)),
    Figure("rms_normal_fitted", "mm", "rms deviation along the normals, best fit", *_rms("normal", fitted=True)),
    Figure("rms_axial_fitted", "mm", "rms deviation along the axis, best fit", *_rms("axial", fitted=True)),
    Figure("rms_half_path_fitted", "mm", "rms half-path error, best fit", *_rms("half-path", fitted=True)),
    Figure("apex", "mm", "how far the middle rises when let go", _apex),
    Figure("max_sag", "mm", "largest move downwards when let go, with its sign", _sag),
    Figure(
        "clamped", "", "solved nodes that clamp or holder held in the press", lambda run: int(run.formed.held.sum())
    ),
    Figure("held", "", "solved nodes that are held after the release", _held),
    Figure("max_shear", "deg", "largest shear of a cell in the press", lambda run: math.degrees(run.formed.max_shear)),
    Figure("max_strain", "", "largest strain of a wire in the press", lambda run: run.formed.max_axial_strain),
    Figure("max_plastic_strain", "", "largest plastic strain in the press", lambda run: run.formed.max_plastic_strain),
    Figure("max_stress_ratio", "", "largest stress over yield strength in the press", _largest_stress_ratio),
    Figure("energy", "mJ", "energy of the grid on the punch", lambda run: run.formed.energy),
    Figure("push", "N", "force of the punch on the grid", lambda run: run.formed.push),
    Figure("draw_in", "mm", "largest inward move of a wire end", lambda run: run.formed.draw_in),
    Figure("compliance", "mm/N", "rms deflection per newton of load, the inverse of rigidity", _compliance),
    Figure("rms_deflection", "mm", "rms deflection under the load", _deflection),
    Figure("mass", "kg", "mass of all wire", mass),
    Figure("wire_length", "mm", "length of all wire", wire_length),
)
FIGURES: Mapping[str, Figure] = MappingProxyType({one.name: one for one in _ALL})
"""Every figure by its name."""
