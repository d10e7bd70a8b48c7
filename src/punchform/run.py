"""The core idea: form the grid over the punch, let it go, load it, and measure it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import TYPE_CHECKING, Any, TypedDict, TypeVar

import numpy as np

from punchform.accuracy import Accuracy, measure_case, wire_surface
from punchform.case import (
    Case,
    CrossingSpring,
    Kind,
    LoadCase,
    PressCase,
    ReleaseCase,
    Settings,
    SolverCase,
    Step,
    TrimCase,
)
from punchform.drawing import drawing_room
from punchform.errors import InputError, NoEquilibrium
from punchform.grid import Grid, lay
from punchform.load import Loaded, load
from punchform.prepare import Prepared, prepare
from punchform.press import Formed, press
from punchform.progress import Observer, silent
from punchform.release import Released, release
from punchform.solved import Shaped
from punchform.start import struck
from punchform.trim import Trimmed, cut_like, trim

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Done = Formed | Released | Trimmed | Loaded
OneKind = TypeVar("OneKind", Formed, Released, Loaded)


@dataclass(frozen=True)
class Stage:
    """One stage of a run: of which kind, the how many-th of its kind, what was asked, and what came of it."""

    kind: Kind
    number: int
    settings: Settings
    done: Done

    @property
    def name(self) -> str:
        """Its name, such as "release 2"."""
        return f"{self.kind} {self.number}"


@dataclass(frozen=True)
class Run:
    """A case and what became of it: the last stage of each kind, None where there is none of it, and all in order.

    accuracy is that of the last press or release, whichever came later.
    """

    case: Case
    formed: Formed
    released: Released | None
    loaded: Loaded | None
    accuracy: Accuracy | None
    notes: tuple[str, ...]
    seconds: float
    stages: tuple[Stage, ...]

    @property
    def final(self) -> Formed | Released:
        """The last press or release: what leaves the workshop."""
        return _final(self.stages)

    def plot(self, field: str = "shape", stage: str = "formed") -> Figure:
        """A figure of a stage: its "shape", or in plan "height", "shear", "axial_force", "stress", "deviation", ...

        stage: "formed", "released", "loaded", or the name of one of `stages`; what a later press has undone is there by
        its name alone, such as "release 1". Raises ValueError for a field or a stage that the run has not, with those
        that it has.
        """
        figure: Figure = drawing_room().plot_run(self, field, stage)
        return figure

    def plot3d(self, field: str = "shape", stage: str = "formed", *, off_screen: bool = False) -> Any:
        """A PyVista plotter, whose `show` opens a view that can be turned; needs `punchform[pyvista]`.

        Raises InputError where PyVista is not installed, ValueError as `plot` does.
        """
        return drawing_room().plot_run_3d(self, field, stage, off_screen)

    def _repr_html_(self) -> str:
        shown: str = drawing_room().html_of_run(self)
        return shown


class _Wires(TypedDict):
    """What every solve needs beside grid and elements."""

    crossing: str | CrossingSpring
    solver: SolverCase
    yield_strength: float | None
    observe: Observer


def run(case: Case, *, observe: Observer = silent) -> Run:
    """Form the grid over the punch, let it go, load it, and measure it; or go through the stages that the case names.

    Raises InputError when the case cannot be pressed, NoEquilibrium when no equilibrium is found.
    """
    begun = perf_counter()
    ready = prepare(case)
    hardening = ready.elements[0].hardening
    # A tensile test says where its wire yields.
    strength = case.wire.yield_strength if hardening is None else hardening.yield_strength
    wires = _Wires(crossing=case.grid.crossing, solver=case.solver, yield_strength=strength, observe=observe)
    stages: list[Stage] = []
    for step in case.steps:
        number = 1 + sum(stage.kind == step.kind for stage in stages)
        stages.append(Stage(step.kind, number, step.settings, _done(step, stages, case, ready, wires)))
    notes = tuple(doubt.message for doubt in ready.doubts)
    done = gathered(case, ready, tuple(stages), notes=notes, seconds=0.0)
    return replace(done, seconds=perf_counter() - begun)


def gathered(case: Case, ready: Prepared, stages: tuple[Stage, ...], *, notes: tuple[str, ...], seconds: float) -> Run:
    """The run that the stages of a case make: the last of each kind, and how near the grid came to the target."""
    formed = _last(Formed, stages)
    assert formed is not None, "the first stage is a press"
    accuracy = None
    if case.target is not None:
        whole = _final(stages).whole
        # The shape is judged at its crossings, wherever else a wire has nodes.
        crossings = np.where(whole.between[:, None] == 0, whole.positions, np.nan)
        judged = wire_surface(
            "middle",
            height=ready.elements[0].height,
            diameter=case.wire.diameter,
            convention=formed_with(stages).offset,
        )
        apex_height = ready.punch.height_at_axis
        accuracy = measure_case(crossings, whole.cells, case.target, apex_height=apex_height, surface=judged)
    return Run(case, formed, _last(Released, stages), _last(Loaded, stages), accuracy, notes, seconds, stages)


def _done(step: Step, stages: Sequence[Stage], case: Case, ready: Prepared, wires: _Wires) -> Done:
    """What one stage makes of the grid as the stages before have left it."""
    before = stages[-1].done if stages else None
    try:
        if isinstance(step.settings, PressCase):
            grid, start = (ready.grid, None) if before is None else (before.grid, struck(before.state, ready.punch))
            return press(grid, ready.elements, ready.punch, case.framed(step.settings), start=start, **wires)
        pressed = case.framed(formed_with(stages))
        assert before is not None, "the first stage is a press"
        match step.settings:
            case ReleaseCase() as how:
                whole_grid = _whole_grid(case, how, before)
                return release(before, ready.elements, how, pressed, full_grid=whole_grid, **wires)
            case TrimCase(radius=radius):
                edge = ready.punch.rim_radius if radius is None else radius
                return trim(before, edge, ready.elements, case.wire, crossing=case.grid.crossing)
            case LoadCase() as what:
                assert isinstance(before, Released), "loads follow on a release"
                return load(before, ready.elements, what, case.wire, pressed, **wires)
    except InputError as error:
        raise step.placed(error) from None
    except NoEquilibrium as error:
        if step.number is None:
            raise
        raise NoEquilibrium(
            f"stages[{step.number}], {step.kind}: {str(error).removeprefix(f'{step.kind}: ')}"
        ) from None


def _whole_grid(case: Case, how: ReleaseCase, before: Shaped) -> Grid | None:
    """The grid without mirror planes, when the release shall be free to leave the symmetry."""
    if how.symmetry == "as pressed" or not before.grid.quarter:
        return None
    laid = lay(case.grid.model_copy(update={"symmetry": "full"}), rim_radius=case.tool.rim_radius)
    return cut_like(laid, before.whole) if before.grid.trimmed else laid


def formed_with(stages: Sequence[Stage]) -> PressCase:
    """The settings of the last press."""
    return next(stage.settings for stage in reversed(stages) if isinstance(stage.settings, PressCase))


def _final(stages: Sequence[Stage]) -> Formed | Released:
    return next(stage.done for stage in reversed(stages) if isinstance(stage.done, Formed | Released))


def _last(kind: type[OneKind], stages: Sequence[Stage]) -> OneKind | None:
    return next((stage.done for stage in reversed(stages) if isinstance(stage.done, kind)), None)
