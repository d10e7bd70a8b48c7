"""A predicted shape with four lobes, its case, and clouds measured on it, for the tests of measured shapes."""

from __future__ import annotations

import numpy as np
from fake_run import check_case, fake_run

from punchform.arrays import Floats
from punchform.case import Case
from punchform.measured import Cloud, Pose, Predicted
from punchform.measured.alignment import Scene
from punchform.measured.pose import rotation
from punchform.measured.sheet import sheet
from punchform.measured.target import target_of, whole_punch

NOISE = 0.05


def predicted(step: float = 15.0, *, lobes: float = 8.0) -> Predicted:
    """A dish whose diagonals have sunk by up to `lobes` [mm]; weakly two-fold, so that no turn is like another."""
    whole = fake_run(step=step).formed.whole
    x, y, z = whole.positions.T
    rho, angle = np.minimum(np.hypot(x, y) / 300, 1.0), np.arctan2(y, x)
    sunk = lobes * 16 * (rho * (1 - rho)) ** 2 * (0.5 - 0.5 * np.cos(4 * angle) + 0.15 * np.sin(2 * angle + 0.3))
    return Predicted(whole.index, whole.flat[:, :2], np.column_stack((x, y, z - sunk)), "released")


def scene(shape: Predicted, case: Case | None = None) -> Scene:
    case = case or check_case()
    return Scene(
        punch=whole_punch(case),
        prediction=sheet(shape.index, shape.flat, shape.nodes),
        target=target_of(case),
        nodes={(int(i), int(j)): number for number, (i, j) in enumerate(shape.index)},
        rim_radius=case.tool.rim_radius,
        step=15.0,
    )


def pose(tilt: float = 0.4, shift: tuple[float, float, float] = (3.0, 0.0, 0.0), *, flipped: bool = False) -> Pose:
    """Tilted [deg] about an axis between x and y, turned over first when `flipped`."""
    turn = rotation(np.radians(tilt) * np.array([0.6, 0.8, 0.0]))
    return Pose(turn @ np.diag([1.0, -1.0, -1.0]) if flipped else turn, np.array(shift))


def cloud(points: Floats, nodes: Floats | None = None, sigma: Floats | None = None) -> Cloud:
    count = len(points)
    return Cloud(
        points=points,
        names=tuple(f"P{k}" for k in range(count)),
        nodes=np.zeros((count, 2), np.int64) if nodes is None else np.asarray(nodes, dtype=np.int64),
        named=np.full(count, nodes is not None),
        sigma=sigma,
        lines=np.arange(1, count + 1),
        source="cloud.csv",
        unit="mm",
        stated=True,
    )


def off_by(found: Pose, true: Pose) -> Floats:
    """The small motion (6,), shift [mm] and turn [rad] in the axes of the run, from the true pose to the found one."""
    between = Pose(true.turn.T @ found.turn, np.zeros(3))
    return np.concatenate((true.turn.T @ (found.shift - true.shift), between.rotation_vector))
