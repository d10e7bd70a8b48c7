"""Grids and references for the tests of the net."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np

from punchform.arrays import Floats
from punchform.case import GridCase, RectangleBlank
from punchform.grid import Grid, lay
from punchform.punch import Gap, Surface

REFERENCE = Path(__file__).parent / "reference"


def reference(name: str) -> dict[str, Floats]:
    """The columns of a reference table by the names in its first line."""
    path = REFERENCE / f"{name}.csv"
    names = path.read_text(encoding="utf-8").splitlines()[0].split("  ")[0].split(",")
    return dict(zip(names, np.loadtxt(path, delimiter=",", skiprows=1).T, strict=True))


def rectangle(
    wires: tuple[int, int],
    step: tuple[float, float],
    *,
    centre: Literal["node", "cell"] = "node",
    symmetry: Literal["quarter", "full"] = "full",
) -> Grid:
    """A grid with so many wires on either side of the axis, not counting one through it."""
    missing = 0 if centre == "node" else 1
    size = [(2 * n - missing + 0.01) * s for n, s in zip(wires, step, strict=True)]
    case = GridCase(
        step=step, weave="same", blank=RectangleBlank(size=(size[0], size[1])), centre=centre, symmetry=symmetry
    )
    return lay(case)


def edges(grid: Grid, positions: Floats) -> Floats:
    """Edge lengths over the steps, less 1, (M,)."""
    length = np.linalg.norm(positions[grid.end] - positions[grid.start], axis=1)
    return np.asarray(length / np.asarray(grid.step)[grid.family] - 1.0)


class Hidden:
    """A surface of which only the signed distance is known."""

    def __init__(self, surface: Surface, *, mirror_planes: bool = True) -> None:
        self._surface, self._mirror_planes = surface, mirror_planes

    @property
    def rim_radius(self) -> float:
        return self._surface.rim_radius

    @property
    def mirror_planes(self) -> bool:
        return self._mirror_planes

    def gap(self, points: Floats) -> Gap:
        return self._surface.gap(points)

    def distance(self, points: Floats) -> Floats:
        return self._surface.distance(points)

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        return self._surface.distance_gradient(points)

    def height(self, xy: Floats) -> Floats:
        return self._surface.height(xy)
