"""Where a net locks or ends, how far it came, and what to change, in words."""

from __future__ import annotations

import math

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.grid import Grid
from punchform.net.fate import COLLAPSED, PLACED

ADVICE = (
    "a shallower punch or a smaller blank shears the net less, and so do cuts in the blank along the diagonals; "
    "another origin or direction moves the shear elsewhere"
)


def notes_on(grid: Grid, fate: Ints, cells: Ints, shear: Floats, locked: Bools, limit: float) -> tuple[str, ...]:
    """What a user must know of a net: nothing when it has no locked cell and all its nodes."""
    notes = []
    if locked.any():
        notes.append(_locks(grid, cells, shear, locked, limit))
    if (fate != PLACED).any():
        notes.append(_ends(grid, fate))
    return tuple(notes)


def _locks(grid: Grid, cells: Ints, shear: Floats, locked: Bools, limit: float) -> str:
    """The share of locked cells and the one nearest to the axis on the flat blank."""
    middle = grid.flat[cells[locked]].mean(axis=1)
    corners = grid.index[cells[locked, 0]]
    first = int(np.argmin(np.hypot(*middle.T)))
    most = float(np.nanmax(np.abs(shear)))
    return (
        f"the net locks: {int(locked.sum())} of {len(cells)} cells shear by more than the limit of "
        f"{math.degrees(limit):.4g} deg (up to {math.degrees(most):.4g} deg), as a rule where neighbouring wires "
        f"touch; the cell nearest to the axis is ({corners[first, 0]}, {corners[first, 1]}), {_place(middle[first])}; "
        f"{ADVICE}, and a thinner wire or a larger step locks later"
    )


def _ends(grid: Grid, fate: Ints) -> str:
    """How many nodes have no place and where the first of them lies on the flat blank."""
    without = np.flatnonzero(fate != PLACED)
    radius = np.hypot(*grid.flat[without].T)
    first = without[int(np.argmin(radius))]
    i, j = grid.index[first]
    collapsed = bool((fate == COLLAPSED).any()) or fate[first] == COLLAPSED
    why = (
        "the cells close there until their wires would lie over one another"
        if collapsed
        else "the surface has no point there at one step from both neighbours"
    )
    return (
        f"the net ends: {len(without)} of {grid.nodes} nodes have no place with wires of constant length, the "
        f"nearest to the axis is node ({i}, {j}), {_place(grid.flat[first])}: {why}; cut the blank inside it, or: "
        f"{ADVICE}"
    )


def _place(flat: Floats) -> str:
    return f"{math.hypot(*flat):.6g} mm from the axis on the flat blank (x0 = {flat[0]:.6g} mm, y0 = {flat[1]:.6g} mm)"
