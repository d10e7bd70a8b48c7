"""The sections of the report on accuracy, release and load: their sentences and tables. No HTML here."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from punchform.accuracy import MEASURES, Accuracy
from punchform.arrays import Floats
from punchform.export.result import largest
from punchform.report.accuracy_words import LOBES, ROUNDING, in_the_tool, listed
from punchform.report.figures.deviation import parts_of
from punchform.report.gain import gain_matrix
from punchform.report.release_words import hold_words
from punchform.report.section import Matrix, Rows, Section, Tables
from punchform.report.words import energy, percent, size
from punchform.report.yielding import springback_tables

if TYPE_CHECKING:
    from punchform.release import Released
    from punchform.run import Run
    from punchform.solved import Solved

ROWS = {
    "mean": "even offset (mean)",
    "0": "depth wrong all round (m = 0)",
    "1": "tilt or sideways shift (m = 1)",
    "2": "saddle (m = 2)",
    "rest": "finer ripple (rest)",
}
"""What the parts of a deviation are called in a row of a table, shorter than in a sentence; the others are lobes."""
LEAST_SHARE = 1e-5
"""A smaller share is told as none."""
NOTHING = 1e-9
"""Parameters below this are rounding [mm, deg]."""


def after_sections(run: Run) -> tuple[Section, ...]:
    """The sections on accuracy, release and load, as far as the run has them."""
    return (*_accuracy(run), *_released(run), *_loaded(run))


def _accuracy(run: Run) -> tuple[Section, ...]:
    accuracy = run.accuracy
    if accuracy is None:
        return ()
    ruze = (gain_matrix(run.case, accuracy),) if accuracy.target.focal_length is not None else ()
    return (
        Section(
            "accuracy",
            "Accuracy of the shape",
            warnings=accuracy.warnings,
            matrices=(_deviation_matrix(accuracy), _parameter_matrix(accuracy), *_parts_matrix(accuracy), *ruze),
            tables=(("How it was judged", _judging_rows(run, accuracy)), *_facet_rows(accuracy)),
            short="Accuracy",
        ),
    )


def _deviation_matrix(accuracy: Accuracy) -> Matrix:
    found = [(aligned, measure, aligned.statistics[measure]) for aligned in accuracy.alignments for measure in MEASURES]
    values = np.array([(one.rms, one.mean, one.sigma, one.lowest, one.highest, one.p95) for *_, one in found])
    rows = [
        (aligned.name if measure == MEASURES[0] else "", measure, *_numbers(row, values))
        for (aligned, measure, _), row in zip(found, values, strict=True)
    ]
    judged = accuracy.aligned
    upwards = "upwards" if accuracy.target.focal_length is None else "upwards, away from the focus"
    marked = [k for k, (one, measure, _) in enumerate(found) if one is judged and measure == accuracy.judge.measure]
    return Matrix(
        f"Deviation of the nodes [mm], positive {upwards}; the judged row is bold",
        ("alignment", "measure", "rms", "mean", "σ", "min", "max", "P95"),
        tuple(rows),
        tuple(marked),
        note=f"The rms is held against the tolerance. {_alignments(accuracy)} σ is the rms about the mean; P95 is the "
        "size that 95 % of the weighted area stays within.",
    )


def _alignments(accuracy: Accuracy) -> str:
    """What each alignment may move, in words."""
    told = ["As held is the part where it was let go"]
    for aligned in accuracy.alignments[1:]:
        moves = ["moved sideways, raised and tilted" if "u" in aligned.fit.free else "raised and tilted"]
        moves += ["given another focal length"] if "f" in aligned.fit.free else []
        told.append(f"{aligned.name} is the best fit of a target that may be {listed(moves)}")
    return f"{'; '.join(told)}."


def _parameter_matrix(accuracy: Accuracy) -> Matrix:
    """What the best fits moved, one column per alignment."""
    fits = accuracy.alignments[1:]

    def row(name: str, value: list[float], unit: str) -> tuple[str, ...]:
        return (name, *(size(0.0 if abs(one) < NOTHING else one, unit) for one in value))

    poses = [aligned.fit.pose for aligned in fits]
    rows = [
        *(row(f"vertex moved along {axis}", [pose.shift[k] for pose in poses], "mm") for k, axis in enumerate("xyz")),
        row("tilt about x", [math.degrees(pose.alpha) for pose in poses], "°"),
        row("tilt about y", [math.degrees(pose.beta) for pose in poses], "°"),
        row("boresight leans by", [math.degrees(aligned.boresight_tilt) for aligned in fits], "°"),
        row("condition of the fit", [aligned.fit.condition for aligned in fits], ""),
    ]
    if accuracy.target.focal_length is not None:
        shift = [float(np.linalg.norm(aligned.implied_shift)) for aligned in fits]
        rows.insert(0, row("focal length", [pose.f or math.nan for pose in poses], "mm"))
        rows.insert(-1, row("the focus, and so the feed, moves by", shift, "mm"))
    return Matrix(
        f"What the best fits moved (least rms of the {accuracy.fit_measure} deviation)",
        ("", *(aligned.name for aligned in fits)),
        tuple(rows),
        note="To reach the best fit, mounting and feed have to follow by these moves. The larger the condition of the "
        "fit, the more two of the moves do the same: then do not take them one by one.",
    )


def _parts_matrix(accuracy: Accuracy) -> tuple[Matrix, ...]:
    aligned = accuracy.aligned
    if aligned.harmonics is None:
        return ()
    names, sizes = parts_of(aligned)
    square, variance = float(np.sum(sizes**2)) or 1.0, float(np.sum(sizes[1:] ** 2)) or 1.0
    rows = [
        (
            ROWS[name] if name in ROWS else (f"{LOBES.get(int(name), name)} lobes (m = {name})"),
            _numbers(sizes[k : k + 1], sizes)[0],
            _share(sizes[k] ** 2 / square),
            "" if name == "mean" else _share(sizes[k] ** 2 / variance),
        )
        for k, name in enumerate(names)
    ]
    return (
        Matrix(
            f"What the {accuracy.judge.measure} deviation is made of, {aligned.name}",
            ("part", "rms [mm]", "of the mean square", "of the variance"),
            tuple(rows),
            note="The largest share is what to mend first: an even offset by the mounting, a wrong depth by the "
            "profile of the punch, lobes by what holds the mesh. m counts the lobes around the axis.",
        ),
    )


def _judging_rows(run: Run, accuracy: Accuracy) -> Rows:
    judge, aperture = accuracy.judge, accuracy.aperture
    inner = f"{size(aperture.inner_radius, 'mm')} to " if aperture.inner_radius else ""
    before = in_the_tool(run, accuracy)
    rows: Rows = (
        ("Judged", f"rms of the {judge.measure} deviation, {judge.alignment}"),
        ("Tolerance", "none" if judge.tolerance is None else size(judge.tolerance, "mm")),
        ("Nodes judged", f"{accuracy.nodes}, inside {inner}{size(aperture.radius, 'mm')}"),
        ("Weights", accuracy.weighting),
        ("Surface of the wires that is told of", accuracy.surface.name),
    )
    if before is not None:
        rows += (
            ("Rms of the same nodes in the tool, as held", size(before.rms if before.rms > ROUNDING else 0.0, "mm")),
        )
    return rows


def _facet_rows(accuracy: Accuracy) -> Tables:
    facets = accuracy.facets
    if facets is None:
        return ()
    rows = (
        ("Mean of the cells between perfect nodes", size(facets.mean, "mm")),
        ("Rms about it", size(facets.sigma, "mm")),
        ("Largest", size(facets.largest, "mm")),
    )
    return (("What the mesh itself adds (not in the figures above)", rows),)


def _released(run: Run) -> tuple[Section, ...]:
    released, case = run.released, run.case.release
    if released is None or case is None:
        return ()
    return (
        Section(
            "released",
            "Release: the punch has gone",
            warnings=released.notes,
            matrices=springback_tables(released),
            tables=(("Shape and holds", _shape_rows(run, released)), ("Wires and solve", _wire_rows(run, released))),
            short="Release",
        ),
    )


def _shape_rows(run: Run, released: Released) -> Rows:
    formed, whole = run.formed.whole, released.whole
    assert run.case.release is not None
    i, j = whole.index[released.lowest]
    moved = np.linalg.norm(released.moved, axis=1)
    middle = [_middle(shape.flat, shape.positions) for shape in (formed, whole)]
    rows: Rows = (
        ("Held", hold_words(run.case.release)),
        ("Crossings held", f"{released.hold.count} of {released.solved_nodes} solved"),
        ("Middle: in the tool, released", f"{size(middle[0], 'mm')}, {size(middle[1], 'mm')}"),
        ("The middle moves by", _signed(released.apex)),
        (f"The lowest move, at ({i}, {j})", _signed(released.max_sag)),
        ("Largest move of a crossing", size(float(moved.max()), "mm")),
    )
    if len(whole.cells):
        change = np.degrees(whole.cell_shear - formed.cell_shear)
        rms, most = float(np.sqrt(np.mean(change**2))), float(np.abs(change).max())
        shear = f"{_degrees(run.formed.max_shear)}, {_degrees(released.max_shear)}"
        rows += (
            ("Largest shear: in the tool, released", shear),
            ("Springback of the shear, rms and largest", f"{size(rms, '°', 3)}, {size(most, '°', 3)}"),
        )
    return (*rows, ("Largest force that holds a crossing", size(released.largest_reaction, "N")))


def _wire_rows(run: Run, released: Released) -> Rows:
    before, after = largest(run.formed.whole.stress), largest(released.whole.stress)
    force = released.whole.F[:, 0]
    negative = released.stability.negative
    known = "not known" if before is None or after is None else f"{size(before, 'MPa')}, {size(after, 'MPa')}"
    return (
        ("Energy left", f"{energy(released.energy)} of {energy(run.formed.energy)}"),
        ("Axial force in the wires", f"{size(float(force.min()), '')} to {size(float(force.max()), 'N')}"),
        ("Largest stress: in the tool, released", known),
        ("Ways of leaving the equilibrium", "not counted" if negative is None else f"{negative}"),
        *_solve_rows(released),
    )


def _loaded(run: Run) -> tuple[Section, ...]:
    loaded = run.loaded
    if loaded is None:
        return ()
    rigid = 1.0 / loaded.compliance if loaded.compliance > 0 else math.nan
    shape: Rows = (
        ("All forces, by size", size(loaded.load, "N")),
        ("Rms deflection along the normals", size(loaded.rms_deflection, "mm")),
        ("Largest move of a crossing", size(loaded.largest_deflection, "mm")),
        ("Rms deflection per newton, of small loads", size(loaded.compliance, "mm/N")),
        ("Rigidity, its inverse", size(rigid, "N/mm")),
        ("Mass of the wire", "not known without `wire.density`" if loaded.mass is None else size(loaded.mass, "kg")),
        ("Largest force that holds a crossing", size(float(np.linalg.norm(loaded.reactions, axis=1).max()), "N")),
    )
    tables = (("Deflection", shape), ("Solve", _solve_rows(loaded)))
    return (Section("loaded", "Load", warnings=loaded.notes, tables=tables),)


def _solve_rows(stage: Solved) -> Rows:
    return (
        ("Ended", stage.outcome.value),
        ("Steps", f"{stage.steps}"),
        ("Factorisations", f"{stage.factorisations} ({stage.linear_solver})"),
        ("Seconds", f"{stage.seconds['total']:.2f}"),
    )


def _middle(flat: Floats, positions: Floats) -> float:
    return float(positions[int(np.argmin(np.linalg.norm(flat, axis=1))), 2])


def _share(value: float) -> str:
    return percent(value if value > LEAST_SHARE else 0.0)


def _signed(value: float) -> str:
    return ("+" if value > 0 else "") + size(value, "mm")


def _degrees(angle: float) -> str:
    return size(math.degrees(angle), "°")


def _numbers(row: Floats, all_of_them: Floats) -> tuple[str, ...]:
    """Numbers with so many decimals that the largest of them all shows four digits."""
    largest_one = float(np.abs(all_of_them).max(initial=0.0))
    decimals = int(np.clip(3 - math.floor(math.log10(largest_one)), 0, 6)) if largest_one > 0 else 0
    if largest_one >= 1e5:
        return tuple(size(float(value), "") for value in row)
    return tuple(f"{value + 0.0:.{decimals}f}".replace("-", "−") for value in row)
