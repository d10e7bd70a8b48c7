"""A run made of closed forms, at any size and in no time: what the results side is tested with.

The net is the equal-arc translation net of a paraboloid (docs/theory.md, section 6) above a softly flattened
flange; D, forces and energies are smooth made-up fields of the right order of magnitude. Names are those of
Run, Formed and Whole.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from punchform.arrays import Floats, Ints

if TYPE_CHECKING:
    from punchform.accuracy import Accuracy
    from punchform.case import Case
    from punchform.holder import Grip
    from punchform.run import Run
    from punchform.strokes import Stroke


SOFTNESS = 6.0


class FakeOutcome(Enum):
    CONVERGED = "converged to a minimum"
    STEP_LIMIT = "the step limit was reached; raise solver.max_steps or press in more strokes"


@dataclass(frozen=True)
class FakeStep:
    number: int
    energy: float
    gradient: float
    decrement: float
    length: float
    hessian: str


@dataclass(frozen=True)
class FakeWhole:
    index: Ints
    between: Ints
    flat: Floats
    positions: Floats
    normals: Floats
    contact: Floats
    family: Ints
    start: Ints
    end: Ints
    sigma: Floats
    D: Floats
    F: Floats
    energy: Floats
    axial_strain: Floats
    stress: Floats
    stress_ratio: Floats
    cells: Ints
    cell_shear: Floats

    @property
    def crossings(self) -> int:
        return len(self.index)


@dataclass(frozen=True)
class FakeSurface:
    focal: float
    rim_radius: float

    def height(self, xy: Floats) -> Floats:
        return _height(np.hypot(*xy.T), self.focal, self.rim_radius)


@dataclass(frozen=True)
class FakeFormed:
    whole: FakeWhole
    surface: FakeSurface
    energy: float
    energy_kinds: dict[str, float]
    history: tuple[FakeStep, ...]
    max_shear: float
    max_axial_strain: float
    push: float
    draw_in: float
    outcome: FakeOutcome = FakeOutcome.CONVERGED
    steps: int = 6
    factorisations: int = 6
    negative_eigenvalues: int | None = 0
    solved_nodes: int = 1703
    linear_solver: str = "scipy"
    seconds: dict[str, float] = field(default_factory=lambda: {"kernel": 0.2, "factorisation": 1.1, "total": 1.6})
    notes: tuple[str, ...] = ("the release of this case is not computed yet",)
    strokes: tuple[Stroke, ...] = ()
    grip: Grip | None = None
    hardening: None = None


@dataclass(frozen=True)
class FakeHeld:
    count: int


@dataclass(frozen=True)
class FakeStability:
    negative: int | None
    mode: Floats | None


@dataclass(frozen=True)
class FakeReleased:
    """As FakeFormed, with what a release adds."""

    whole: FakeWhole
    moved: Floats
    reactions: Floats
    energy: float
    energy_kinds: dict[str, float]
    history: tuple[FakeStep, ...]
    max_shear: float
    max_axial_strain: float
    stability: FakeStability
    hold: FakeHeld = FakeHeld(12)
    outcome: FakeOutcome = FakeOutcome.CONVERGED
    steps: int = 9
    factorisations: int = 10
    negative_eigenvalues: int | None = 0
    solved_nodes: int = 1703
    linear_solver: str = "scipy"
    seconds: dict[str, float] = field(default_factory=lambda: {"total": 0.9})
    notes: tuple[str, ...] = ()
    largest_reaction: float = 4.2
    hardening: None = None
    split: None = None

    @property
    def apex(self) -> float:
        return float(self.moved[np.argmin(np.linalg.norm(self.whole.flat, axis=1)), 2])

    @property
    def lowest(self) -> int:
        return int(self.moved[:, 2].argmin())

    @property
    def max_sag(self) -> float:
        return float(self.moved[:, 2].min())


@dataclass(frozen=True)
class FakeLoaded(FakeReleased):
    """As FakeReleased, with what a load adds."""

    applied: Floats = field(default_factory=lambda: np.zeros((1, 3)))
    compliance: float = 0.04
    mass: float | None = None
    load: float = 3.35
    rms_deflection: float = 0.13
    largest_deflection: float = 0.3


@dataclass(frozen=True)
class FakeStage:
    kind: str
    number: int
    settings: object
    done: FakeFormed | FakeReleased

    @property
    def name(self) -> str:
        return f"{self.kind} {self.number}"


@dataclass(frozen=True)
class FakeRun:
    case: Case
    formed: FakeFormed
    released: FakeReleased | None = None
    loaded: FakeLoaded | None = None
    accuracy: Accuracy | None = None
    notes: tuple[str, ...] = ()
    seconds: float = 2.5

    @property
    def stages(self) -> tuple[FakeStage, ...]:
        done = {"press": self.formed, "release": self.released, "load": self.loaded}
        return tuple(FakeStage(kind, 1, getattr(self.case, kind), one) for kind, one in done.items() if one is not None)

    @property
    def final(self) -> FakeFormed | FakeReleased:
        return self.formed if self.released is None else self.released


def check_case() -> Case:
    """The packaged check case."""
    from punchform.case import read_case

    return read_case(Path(str(files("punchform") / "cases" / "check.toml")))


def fake_run(
    *,
    step: float = 30.0,
    radius: float = 345.0,
    focal: float = 250.0,
    yield_strength: float | None = None,
    outcome: FakeOutcome = FakeOutcome.CONVERGED,
    notes: tuple[str, ...] = (),
    case: Case | None = None,
) -> Run:
    """A run on a circular blank; the step sets the size: 7.5 mm gives 6 600 nodes, 1.9 mm 100 000."""
    whole = _whole(step, radius, focal, yield_strength)
    kinds = dict(zip(("stretch", "bend", "in_plane", "twist", "crossing"), (0.2, 0.7, 0.06, 0.04, 0.0), strict=True))
    energy = float(whole.energy.sum())
    formed = FakeFormed(
        whole=whole,
        surface=FakeSurface(focal, 0.85 * radius),
        outcome=outcome,
        energy=energy,
        energy_kinds={kind: share * energy for kind, share in kinds.items()},
        history=_history(energy),
        max_shear=float(np.abs(whole.cell_shear).max()),
        max_axial_strain=float(whole.axial_strain.max()),
        push=123.0,
        draw_in=float((np.hypot(*whole.flat.T[:2]) - np.hypot(*whole.positions.T[:2])).max()),
    )
    case = check_case() if case is None else case
    grid = case.grid.model_copy(update={"step": (step, step)})
    wire = case.wire.model_copy(update={"yield_strength": yield_strength})
    return cast("Run", FakeRun(case.model_copy(update={"grid": grid, "wire": wire}), formed, notes=notes))


def let_go(
    run: Run,
    shift: Callable[[Floats, Floats], Floats],
    *,
    release: dict[str, object] | None = None,
    target: dict[str, object] | None = None,
    load: dict[str, object] | None = None,
    negative: int | None = 0,
    mode: bool = False,
) -> Run:
    """A fake run whose nodes the release moves by shift(rho, angle) [mm] along z; sections as in a case file.

    Without `release` the formed grid is what is measured; without `target` nothing is.
    """
    from punchform.accuracy import measure_case
    from punchform.case import LoadCase, ReleaseCase, TargetCase

    whole = cast("FakeWhole", run.formed.whole)
    x, y, _ = whole.positions.T
    moved = np.zeros_like(whole.positions)
    moved[:, 2] = shift(np.hypot(x, y), np.arctan2(y, x))
    after = replace(whole, positions=whole.positions + moved)
    modes = np.column_stack((0 * x, 0 * x, np.sin(np.arctan2(y, x)))) if mode else None
    told = {
        "whole": after,
        "moved": moved,
        "reactions": 0.1 * moved,
        "energy": 0.4 * run.formed.energy,
        "energy_kinds": {kind: 0.4 * part for kind, part in run.formed.energy_kinds.items()},
        "history": run.formed.history,
        "max_shear": run.formed.max_shear,
        "max_axial_strain": run.formed.max_axial_strain,
        "stability": FakeStability(negative, modes),
    }
    wanted = None if target is None else TargetCase.model_validate(target)
    accuracy = None
    if wanted is not None:
        top = float(whole.positions[:, 2].max())
        accuracy = measure_case(after.positions, whole.cells, wanted, apex_height=top)
    sections = {
        "release": None if release is None else ReleaseCase.model_validate(release),
        "target": wanted,
        "load": None if load is None else LoadCase.model_validate(load),
    }
    done = FakeRun(
        run.case.model_copy(update=sections),
        cast("FakeFormed", run.formed if release is not None else replace(run.formed, whole=after)),  # type: ignore[arg-type]
        None if release is None else FakeReleased(**told),  # type: ignore[arg-type]
        None if load is None else FakeLoaded(**told),  # type: ignore[arg-type]
        accuracy,
        notes=run.notes,
    )
    return cast("Run", done)


def _history(energy: float) -> tuple[FakeStep, ...]:
    """Newton near its end: the error is squared at every step."""
    errors = 3.0 ** -(2.0 ** np.arange(7))
    return tuple(
        FakeStep(k, energy * (1 + error), 40 * error, error**2, 1.0, "gauss-newton" if k < 3 else "full")
        for k, error in enumerate(errors)
    )


def _whole(step: float, radius: float, focal: float, yield_strength: float | None) -> FakeWhole:
    count = int(radius / step) + 1
    axis = np.arange(-count, count + 1)
    i, j = (grid.ravel() for grid in np.meshgrid(axis, axis, indexing="ij"))
    inside = np.hypot(i * step, j * step) <= radius * (1 + 1e-9)
    numbers = np.full((len(axis), len(axis)), -1)
    index = np.column_stack((i, j))[inside]
    numbers[tuple((index + count).T)] = np.arange(len(index))
    flat = np.column_stack((index * step, np.zeros(len(index))))
    positions, normals = _dish(flat, focal, radius)
    start, end, family = _elements(index, numbers, count)
    D, F = _loads(positions, start, end, step)
    stress = np.abs(F[:, 0]) / 0.44 + 180 * np.abs(D[:, 4])
    cells = _cells(numbers)
    x, y = positions[cells].mean(axis=1).T[:2]
    rho = np.hypot(*positions.T[:2])
    angle = np.arctan2(positions[:, 1], positions[:, 0])
    return FakeWhole(
        index=index,
        between=np.zeros(len(index), dtype=np.int64),
        flat=flat,
        positions=positions,
        normals=normals,
        contact=2 - 9 * np.exp(-(((rho - 0.85 * radius) / 12) ** 2)) * (1 + 0.3 * np.cos(4 * angle)),
        family=family,
        start=start,
        end=end,
        sigma=np.where((index[start].sum(axis=1) + family) % 2 == 1, 1.0, -1.0),
        D=D,
        F=F,
        energy=0.5 * (D * F).sum(axis=1),
        axial_strain=D[:, 0] / step,
        stress=stress,
        stress_ratio=stress / yield_strength if yield_strength else np.full(len(start), np.nan),
        cells=cells,
        cell_shear=np.arcsin(x * y / np.sqrt((4 * focal**2 + x**2) * (4 * focal**2 + y**2))),
    )


def _dish(flat: Floats, focal: float, radius: float) -> tuple[Floats, Floats]:
    """Equal arcs along both parabolas; the height runs softly into the plane of the flange."""
    reach = np.linspace(0, 2 * radius, 4001)
    slope = reach / (2 * focal)
    arc = 0.5 * (reach * np.sqrt(1 + slope**2) + 2 * focal * np.arcsinh(slope))
    plan = np.sign(flat[:, :2]) * np.interp(np.abs(flat[:, :2]), arc, reach)
    rho = np.hypot(*plan.T)
    rim = 0.85 * radius
    height = _height(rho, focal, rim)
    fall = 1 / (1 + np.exp((rho**2 - rim**2) / (4 * focal * SOFTNESS)))
    normals = np.column_stack((plan * (fall / (2 * focal))[:, None], np.ones(len(plan))))
    return np.column_stack((plan, height)), normals / np.linalg.norm(normals, axis=1)[:, None]


def _height(rho: Floats, focal: float, rim: float) -> Floats:
    return SOFTNESS * np.logaddexp(0.0, (rim**2 - rho**2) / (4 * focal * SOFTNESS))


def _elements(index: Ints, numbers: Ints, count: int) -> tuple[Ints, Ints, Ints]:
    """Elements to the next node in +i (family 1) and +j (family 2), each starting at its end nearer to the
    axis."""
    pairs, families = [], []
    for family, shift in ((1, (1, 0)), (2, (0, 1))):
        other = numbers[tuple((index + shift + count).T)]
        here = np.flatnonzero(other >= 0)
        pair = np.column_stack((here, other[here]))
        backwards = index[here, family - 1] < 0
        pair[backwards] = pair[backwards, ::-1]
        pairs.append(pair)
        families.append(np.full(len(pair), family))
    start, end = np.vstack(pairs).T
    return np.ascontiguousarray(start), np.ascontiguousarray(end), np.concatenate(families)


def _loads(positions: Floats, start: Ints, end: Ints, step: float) -> tuple[Floats, Floats]:
    middle = 0.5 * (positions[start] + positions[end])
    angle = np.arctan2(middle[:, 1], middle[:, 0])
    reach = np.hypot(*middle.T[:2]) / 300
    shape = np.column_stack(
        [
            4e-4 * step * (0.3 - reach**2 * np.cos(4 * angle)),
            1e-3 * reach * np.sin(2 * angle),
            np.full(len(angle), 2e-2),
            1e-3 * reach**2 * np.sin(4 * angle),
            1.5e-2 * (1 - 0.2 * reach),
            2e-3 * reach * np.sin(4 * angle),
        ]
    )
    return shape, shape * np.array([4000.0, 900.0, 50.0, 300.0, 450.0, 450.0])


def _cells(numbers: Ints) -> Ints:
    corners = np.stack((numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]), axis=-1)
    flat = corners.reshape(-1, 4)
    return flat[(flat >= 0).all(axis=1)]
