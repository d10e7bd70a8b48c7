"""What no single setting shows: sections of a case that contradict each other.

Each check takes sections that are valid by themselves; a section that is missing or invalid is None and the
checks that need it are passed over, so that all problems of a file can be told at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from punchform.case.findings import Finding
from punchform.case.grid import CircleBlank, GridCase, PolygonBlank, RectangleBlank
from punchform.case.load import LoadCase
from punchform.case.memory import (
    BYTES_PER_NODE,
    blank_area,
    blank_reach,
    machine_memory,
    solved_nodes,
)
from punchform.case.optimise import OptimiseCase, design_findings
from punchform.case.press import PressCase, SolverCase
from punchform.case.punch import PunchCase
from punchform.case.release import HoldFrom, ReleaseCase
from punchform.case.shell_checks import shell_findings
from punchform.case.stage_checks import stage_findings
from punchform.case.stages import Stage, Step, steps
from punchform.case.target import TargetCase
from punchform.case.wire import PAPER_DIAMETER, StraightLine, WireCase, rise
from punchform.case.yield_checks import memory_findings, yield_findings


def findings(
    *,
    stages: tuple[Stage, ...] | None = None,
    grid: GridCase | None,
    wire: WireCase | None,
    punch: PunchCase | None,
    press: PressCase | None,
    solver: SolverCase | None,
    release: ReleaseCase | None,
    load: LoadCase | None,
    target: TargetCase | None,
    optimise: OptimiseCase | None = None,
) -> Iterator[Finding]:
    """All contradictions between (and inside) the sections that are given."""
    if grid:
        yield from _grid_fits_machine(_solved_part(grid, press))
        yield from _polygon_has_area(grid)
    if wire:
        yield from _wire_is_described_once(wire)
    if grid and wire:
        yield from _wire_fits_step(grid, wire)
    if grid and punch:
        yield from _blank_reaches_rim(grid, punch)
    if press:
        yield from _press_is_consistent(press)
    if grid and press:
        yield from _kinematics_knows_crossing(grid, press)
    if grid and release:
        yield from _something_is_held(grid, release)
    if load and stages is None:
        yield from _load_can_act(load, wire, release)
    if punch and target:
        yield from _aperture_inside_rim(punch, target)
    if optimise and stages is None:
        yield from design_findings(optimise, target, load)
    if wire and press:
        yield from yield_findings(wire, press)
    if wire and grid and release:
        yield from memory_findings(wire, grid, release)
    if stages is not None:
        done = tuple(steps(stages, {"press": press, "release": release, "load": load}))
        yield from stage_findings(done, stages=stages, punch=punch, target=target)
        yield from _each_stage_can_be(done, grid, wire)
    yield from shell_findings(grid=grid, wire=wire, punch=punch, press=press, release=release, load=load, target=target)


def _each_stage_can_be(done: tuple[Step, ...], grid: GridCase | None, wire: WireCase | None) -> Iterator[Finding]:
    """What the checks of single sections say of stages with settings of their own."""
    held: ReleaseCase | None = None
    for step in done:
        found: list[Finding] = []
        match step.settings:
            case PressCase() as press if step.own:
                found += _press_is_consistent(press)
                found += yield_findings(wire, press) if wire else ()
                found += _kinematics_knows_crossing(grid, press) if grid else ()
            case ReleaseCase() as release:
                held = release
                found += _something_is_held(grid, release) if step.own and grid else ()
                found += memory_findings(wire, grid, release) if step.own and grid and wire else ()
            case LoadCase() as load if held is not None:
                found += _load_can_act(load, wire, held)
        yield from (replace(one, key=step.place(*one.key[1:])) for one in found)


def _solved_part(grid: GridCase, press: PressCase | None) -> GridCase:
    """Wire ends may go anywhere, so that a gridshell is solved as a whole."""
    return grid.model_copy(update={"symmetry": "full"}) if press and press.ends is not None else grid


def _grid_fits_machine(grid: GridCase) -> Iterator[Finding]:
    nodes = solved_nodes(grid)
    needed, there = nodes * BYTES_PER_NODE, machine_memory()
    if needed > there:
        smallest = max(grid.step) * (needed / there) ** 0.5
        what = "crossings" if grid.subdivide == 1 else "nodes"
        yield Finding(
            ("grid", "step"),
            f"about {nodes:.3g} {what} would have to be solved, which takes about "
            f"{needed / 2**30:.3g} GiB of memory; this machine has {there / 2**30:.3g} GiB",
            f"take a step of {smallest:.2g} mm or more, a smaller blank, or a larger machine",
        )


def _polygon_has_area(grid: GridCase) -> Iterator[Finding]:
    if isinstance(grid.blank, PolygonBlank) and blank_area(grid.blank) < 1e-9 * blank_reach(grid.blank) ** 2:
        yield Finding(("grid", "blank", "points"), "the corners enclose no area")


def _wire_is_described_once(wire: WireCase) -> Iterator[Finding]:
    if wire.stiffness == "paper" and wire.diameter != PAPER_DIAMETER:
        yield Finding(
            ("wire", "diameter"),
            f"the paper's Table 1 is of a wire of {PAPER_DIAMETER:g} mm, not {wire.diameter:g} mm",
            "leave out `diameter`, or give the wire itself instead of `stiffness`",
        )
    if wire.stiffness is not None and wire.centreline is not None:
        yield Finding(
            ("wire", "centreline"),
            "the stiffness is given, so a centreline would have no effect",
            "leave out `centreline` or `stiffness`",
        )
    elif wire.centreline is not None and wire.height != rise(wire.centreline):
        yield Finding(
            ("wire", "height"),
            f"{wire.height:g} mm contradicts the centreline, whose height is {rise(wire.centreline):g} mm",
            "leave out `height`: it is only needed beside `stiffness`",
        )


def _wire_fits_step(grid: GridCase, wire: WireCase) -> Iterator[Finding]:
    if wire.stiffness == "paper" and grid.weave == "stacked":
        yield Finding(("grid", "weave"), "the paper's Table 1 is of a crimped wire; a stacked grid is of straight ones")
    step = min(grid.step)
    if wire.diameter >= step:
        yield Finding(
            ("wire", "diameter"),
            f"a wire of {wire.diameter:g} mm is as thick as the step of {step:g} mm or thicker",
            "wires of one family would overlap; check the units of both",
        )
    elif abs(wire.height) > step:
        key = "height" if wire.centreline is None else "centreline"
        yield Finding(
            ("wire", key),
            f"a crimp height of {wire.height:g} mm is more than the step of {step:g} mm",
            "the crimp of a woven wire is about one diameter",
        )
    if grid.weave == "stacked" and wire.stiffness is None and not isinstance(wire.centreline, StraightLine):
        yield Finding(
            ("wire", "centreline"),
            "a stacked grid is made of straight wires",
            'write centreline = { kind = "straight", height = "..." } or choose weave = "plain"',
        )


def _blank_reaches_rim(grid: GridCase, punch: PunchCase) -> Iterator[Finding]:
    match grid.blank:
        case CircleBlank(radius=radius):
            reach, key = radius, "radius"
        case RectangleBlank(size=size):
            reach, key = 0.5 * min(size), "size"
        case _:
            return
    if reach < punch.rim_radius:
        yield Finding(
            ("grid", "blank", key),
            f"the blank reaches {reach:g} mm from the axis and so not to the rim at {punch.rim_radius:g} mm",
            "take a larger blank: the press draws some of it in",
        )
    elif max(grid.step) > punch.rim_radius:
        yield Finding(
            ("grid", "step"),
            f"a step of {max(grid.step):g} mm is more than the rim radius of {punch.rim_radius:g} mm",
            "no crossing but the one on the axis would lie on the punch; check the units of both",
        )


def _press_is_consistent(press: PressCase) -> Iterator[Finding]:
    if press.pull is not None and press.rim == "clamp":
        yield Finding(
            ("press", "pull"),
            'a clamped rim lets no wire end move, so a pull contradicts rim = "clamp"',
            'leave out `pull` or choose rim = "draw"',
        )
    if press.pull is not None and min(press.pull) < 0:
        yield Finding(("press", "pull"), "a pull cannot be negative: wires that are pushed buckle")
    if press.method == "descent" and press.descent.rule != "exact" and press.descent.step_length is None:
        yield Finding(
            ("press", "descent", "step_length"),
            f"is missing: the rule '{press.descent.rule}' needs a step length such as '0.001 mm/N'",
        )
    if press.method == "descent" and press.strokes not in (None, 1):
        yield Finding(
            ("press", "strokes"),
            "the paper's descent goes to the full depth at once",
            'leave out `strokes`, or write method = "newton"',
        )
    if press.hold is not None:
        yield from _holder_can_act(press)


def _holder_can_act(press: PressCase) -> Iterator[Finding]:
    """A holder brakes wires that slide in, by a potential in the unknowns of the free kinematics."""
    if press.rim == "clamp":
        yield Finding(
            ("press", "hold"),
            'a clamped rim lets nothing slide, so a holder contradicts rim = "clamp"',
            'leave out `hold` or choose rim = "draw"',
        )
    if press.pull is not None:
        yield Finding(
            ("press", "hold"),
            "the holder grips the flange, on which the pull would act",
            "leave out `hold` or `pull`: the holder gives the wires their tension",
        )
    if press.kinematics == "differences":
        yield Finding(("press", "hold"), "a holder needs the free kinematics", 'use kinematics = "free"')
    if press.method == "descent":
        yield Finding(("press", "hold"), "a holder needs Newton's method", 'use method = "newton"')


def _kinematics_knows_crossing(grid: GridCase, press: PressCase) -> Iterator[Finding]:
    if grid.crossing == "welded" and press.kinematics == "differences":
        yield Finding(
            ("press", "kinematics"),
            "welded crossings need the free kinematics: with differences the tangents follow from positions",
            'use kinematics = "free", or a crossing spring',
        )


def _something_is_held(grid: GridCase, release: ReleaseCase) -> Iterator[Finding]:
    if isinstance(release.hold, HoldFrom) and release.hold.from_radius > blank_reach(grid.blank):
        yield Finding(
            ("release", "hold", "from_radius"),
            f"no node lies beyond {release.hold.from_radius:g} mm: the blank reaches {blank_reach(grid.blank):g} mm",
            'take a smaller radius, or hold = "nothing"',
        )


def _load_can_act(load: LoadCase, wire: WireCase | None, release: ReleaseCase | None) -> Iterator[Finding]:
    if release is None:
        yield Finding(
            ("load",), "loads act after the release, and the case has no [release]", "say in [release] what is held"
        )
    elif release.hold == "nothing" and not release.ribs:
        yield Finding(
            ("load",), "nothing holds the grid, so a load would carry it away", "say in [release] what is held"
        )
    if load.gravity is not None and wire and wire.density is None:
        yield Finding(("load", "gravity"), "the weight of the wire is not known", "give wire.density in kg/m^3")


def _aperture_inside_rim(punch: PunchCase, target: TargetCase) -> Iterator[Finding]:
    if target.aperture_radius > punch.rim_radius:
        yield Finding(
            ("target", "aperture_radius"),
            f"an aperture of {target.aperture_radius:g} mm reaches beyond the rim at {punch.rim_radius:g} mm",
            "accuracy is judged on the formed surface, inside the rim",
        )
