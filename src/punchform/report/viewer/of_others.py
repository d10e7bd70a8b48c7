"""Scenes of what is not pressed: an inextensible net on its punch, and a gridshell between its ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from punchform.report.quantities import AXIAL, MOMENT, SHEAR
from punchform.report.viewer.scene import Figure, Pose, Quantity, Scene, Skin
from punchform.report.viewer.shaped import coloured, figures_of, places, stress_quantity, wires_in_order
from punchform.report.viewer.skins import punch_skin
from punchform.whole import node_shear

if TYPE_CHECKING:
    from punchform.case import Case
    from punchform.drape import Drape
    from punchform.shell import Shell
    from punchform.whole import Whole


def scene_of_net(done: Drape) -> Scene:
    """The flat grid and the net on the punch; crossings without a place are not drawn there."""
    whole = done.formed.whole
    known = np.isfinite(whole.cell_shear)
    shear = node_shear(len(whole.flat), whole.cells[known], SHEAR.of(whole)[known])
    laid = Pose("on the punch", "with wires of constant length", whole.positions, (Figure(SHEAR.key, shear),))
    reach = float(np.nanmax(np.hypot(*whole.positions.T[:2])))
    return _scene(done.case, whole, laid, (coloured(SHEAR),), (punch_skin(done.formed.surface, reach),))


def scene_of_shell(done: Shell) -> Scene:
    """The flat grid and the gridshell."""
    whole = done.formed.whole
    axial, moment, shear = (coloured(one) for one in (AXIAL, MOMENT, SHEAR))
    asked = (axial, moment, stress_quantity(done.case.wire.yield_strength), shear)
    ends = np.column_stack((whole.start, whole.end))[wires_in_order(whole)]
    known = figures_of(whole, places(whole, ends, whole), asked, yields=False)
    figures = tuple(one for one in known if np.isfinite(one.values).any())
    keys = {one.key for one in figures}
    standing = Pose("standing", "the ends of the wires are where they are held", whole.positions, figures)
    return _scene(done.case, whole, standing, tuple(one for one in asked if one.key in keys), ())


def _scene(case: Case, whole: Whole, end: Pose, quantities: tuple[Quantity, ...], skins: tuple[Skin, ...]) -> Scene:
    order = wires_in_order(whole)
    return Scene(
        title=case.title or "Formed grid",
        index=whole.index,
        between=whole.between,
        ends=np.column_stack((whole.start, whole.end))[order],
        family=whole.family[order],
        diameter=case.wire.diameter,
        poses=(Pose("flat", "the blank as it is laid", whole.flat, share=0.0), end),
        quantities=quantities,
        skins=skins,
        begin=1,
        colour=quantities[0].key,
    )
