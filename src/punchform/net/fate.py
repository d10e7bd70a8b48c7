"""What became of a node of the net."""

from __future__ import annotations

UNPLACED = 0
"""Not asked for."""
PLACED = 1
"""On the surface, at the right distances of its neighbours."""
COLLAPSED = 2
"""Its cell has closed: its wires would lie over one another."""
NO_INTERSECTION = 3
"""The surface has no point at the right distances of both neighbours."""
BEYOND = 4
"""Behind a node that could not be placed."""
