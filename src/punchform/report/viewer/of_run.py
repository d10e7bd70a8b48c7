"""From a run to what the viewer shows of it: every stage is a shape, with the figures that the report tells of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from punchform.accuracy import Accuracy, feet
from punchform.arrays import Floats, Ints
from punchform.export.told import laid
from punchform.report.quantities import (
    AXIAL,
    CONTACT,
    DEFLECTION,
    ELONGATION,
    MOMENT,
    PLASTIC,
    RISE,
    SHEAR,
    deviation_label,
)
from punchform.report.release_words import hold_words
from punchform.report.viewer.scene import Figure, Mark, Pose, Quantity, Scene, Skin
from punchform.report.viewer.shaped import (
    Places,
    coloured,
    figures_of,
    places,
    stress_quantity,
    values_of,
    wires_in_order,
)
from punchform.report.viewer.skins import punch_skin, target_skin
from punchform.report.words import percent, size
from punchform.whole import cell_shear, node_shear, unfold_vectors

if TYPE_CHECKING:
    from punchform.case import ReleaseCase
    from punchform.load import Loaded
    from punchform.press import Formed
    from punchform.release import Released
    from punchform.run import Run, Stage
    from punchform.trim import Trimmed
    from punchform.whole import Whole

HELD, FIT = "deviation_held", "deviation_fit"
NAMES = {"press": "in the tool", "release": "released", "trim": "trimmed", "load": "loaded"}
MOST_PLACES = 240_000
"""Positions of strokes that a scene holds at most."""
SAG = Quantity("release_moved", RISE, "mm", "node", signed=True, note="+ up")
DEFLECTED = Quantity("load_moved", DEFLECTION, "mm", "node", signed=True, note="+ outwards")


@dataclass(frozen=True)
class _Laid:
    """The grid as it was laid: its whole and the ends (M, 2) of its wire pieces in the order of the scene."""

    whole: Whole
    ends: Ints


def scene_of(run: Run, title: str | None = None) -> Scene:
    """The scene of a run: flat, each stage in its order, the punch of its last press and the target."""
    whole = laid(run).whole
    order = wires_in_order(whole)
    ground = _Laid(whole, np.column_stack((whole.start, whole.end))[order])
    asked = _quantities(run)
    poses = [Pose("flat", "the blank as it is laid, before the press", whole.flat, share=0.0)]
    begin = 0
    for last, stage in zip((None, *run.stages), run.stages, strict=False):
        at = places(whole, ground.ends, stage.done.whole)
        if stage.kind == "press":
            poses += _strokes(run, stage, at)
        poses.append(_pose(run, stage, last, at, poses[-1], asked))
        begin = len(poses) - 1 if stage.done is run.final else begin
    shown = {figure.key for pose in poses for figure in pose.figures if np.isfinite(figure.values).any()}
    quantities = tuple(one for one in asked if one.key in shown)
    # What is known of no shape, such as the stress of a wire that is given as a matrix, is not told at all.
    poses = [replace(pose, figures=tuple(one for one in pose.figures if one.key in shown)) for pose in poses]
    return Scene(
        title=run.case.title or "Formed grid" if title is None else title,
        index=whole.index,
        between=whole.between,
        ends=ground.ends,
        family=whole.family[order],
        diameter=run.case.wire.diameter,
        poses=tuple(poses),
        quantities=quantities,
        skins=_skins(run, poses),
        begin=begin,
        colour=quantities[0].key if quantities else None,
    )


def _quantities(run: Run) -> tuple[Quantity, ...]:
    """All that this run can tell, what decides first."""
    yields = run.formed.hardening is not None
    kinds = {stage.kind for stage in run.stages}
    strength = run.formed.hardening.yield_strength if run.formed.hardening else run.case.wire.yield_strength
    return (
        *(() if run.accuracy is None else _deviation_quantities(run.accuracy)),
        *(coloured(one) for one in (SHEAR, AXIAL, MOMENT)),
        stress_quantity(strength),
        *(coloured(one) for one in (ELONGATION, PLASTIC) if yields),
        coloured(CONTACT),
        *((SAG,) if "release" in kinds else ()),
        *((DEFLECTED,) if "load" in kinds else ()),
    )


def _deviation_quantities(accuracy: Accuracy) -> tuple[Quantity, ...]:
    """The deviation in the alignment that is judged, then that in the other."""
    judge = accuracy.judge
    marks = () if judge.tolerance is None else (Mark(-judge.tolerance, ""), Mark(judge.tolerance, "tolerance"))
    held, fit = (
        Quantity(key, deviation_label(judge.measure, how), "mm", "node", signed=True, note="+ upwards", marks=marks)
        for key, how in ((HELD, "as held"), (FIT, "best fit"))
    )
    return (held, fit) if accuracy.aligned is accuracy.as_held else (fit, held)


def _pose(run: Run, stage: Stage, last: Stage | None, at: Places, before: Pose, asked: tuple[Quantity, ...]) -> Pose:
    done = stage.done
    figures = (*figures_of(done.whole, at, asked, yields=done.hardening is not None), *_own_figures(stage, last, at))
    references: tuple[tuple[str, Floats], ...] = ()
    if stage.kind != "press":
        references = ((before.name, before.positions),)
    if done is run.final and run.accuracy is not None:
        figures += _deviations(run.accuracy, at)
        references += (("the target", at.of_nodes(_on_target(run.accuracy, done.whole))),)
    return Pose(
        NAMES[stage.kind] if run.case.stages is None else f"{stage.name}: {NAMES[stage.kind]}",
        _told(stage),
        at.of_nodes(done.whole.positions),
        figures,
        references,
        tool=stage.kind == "press" or (stage.kind == "trim" and before.tool),
    )


def _strokes(run: Run, stage: Stage, at: Places) -> list[Pose]:
    """The shapes on the way down, the last one left out; of many strokes on a large grid only some."""
    formed = cast("Formed", stage.done)
    whole, strokes = formed.whole, formed.strokes
    count = min(len(strokes) - 1, MOST_PLACES // len(whole.flat))
    kept = np.unique(np.linspace(1, len(strokes) - 1, count).round().astype(int)) if count > 0 else ()
    before = "" if run.case.stages is None else f"{stage.name}: "
    poses = []
    for number in kept:
        stroke = strokes[number - 1]
        positions = unfold_vectors(formed.grid, stroke.positions)
        shear = np.degrees(node_shear(len(positions), whole.cells, cell_shear(positions, whole.cells)))
        poses.append(
            Pose(
                f"{before}stroke {number} of {len(strokes)}",
                f"the punch is down to {percent(stroke.share)} of its depth",
                at.of_nodes(positions),
                (Figure(SHEAR.key, at.of_nodes(shear)),),
                share=stroke.share,
                stroke=True,
            )
        )
    return poses


def _own_figures(stage: Stage, last: Stage | None, at: Places) -> tuple[Figure, ...]:
    """What only one kind of stage tells: the tool's forces, how far a release or a load moved the nodes."""
    match stage.kind:
        case "press":
            return (Figure(CONTACT.key, values_of(CONTACT, stage.done.whole, at)),)
        case "release":
            return (Figure(SAG.key, at.of_nodes(cast("Released", stage.done).moved[:, 2])),)
        case "load":
            assert last is not None, "loads follow on a release"
            along = np.sum(cast("Loaded", stage.done).moved * last.done.whole.normals, axis=1)
            return (Figure(DEFLECTED.key, at.of_nodes(along)),)
    return ()


def _deviations(accuracy: Accuracy, at: Places) -> tuple[Figure, ...]:
    """Deviations of the judged nodes in both alignments; the others have none."""
    return tuple(
        Figure(key, at.of_nodes(np.where(accuracy.mask, aligned.deviations.of(accuracy.judge.measure), np.nan)))
        for key, aligned in ((HELD, accuracy.as_held), (FIT, accuracy.fitted))
    )


def _on_target(accuracy: Accuracy, whole: Whole) -> Floats:
    """The nearest points of the target (N, 3) [mm], as it is judged, to the nodes in the aperture; NaN for others."""
    nearest = np.full_like(whole.positions, np.nan)
    inside = accuracy.aperture.mask(whole.positions)
    nearest[inside] = feet(whole.positions[inside], accuracy.target, accuracy.aligned.fit.pose)
    return nearest


def _told(stage: Stage) -> str:
    match stage.kind:
        case "press":
            return "pressed onto the punch"
        case "release":
            return f"the punch has gone and {hold_words(cast('ReleaseCase', stage.settings))}"
        case "trim":
            return f"cut off beyond {size(cast('Trimmed', stage.done).radius, 'mm')}, the rest as it lay"
    return "under its load"


def _skins(run: Run, poses: list[Pose]) -> tuple[Skin, ...]:
    reach = max(float(np.nanmax(np.hypot(*pose.positions.T[:2]))) for pose in poses[1:])
    skins = (punch_skin(run.formed.surface, reach),)
    if run.accuracy is None:
        return skins
    pose = run.accuracy.aligned.fit.pose
    return (*skins, target_skin(run.accuracy.target, pose, run.accuracy.aperture.radius))
