"""A scene as text for the page: a JSON header that says what is where, and one compressed blob of numbers in base64."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from punchform.arrays import Floats
from punchform.report.viewer.coding import Blob
from punchform.report.viewer.scene import Pose, Quantity, Scene, Skin

VERSION = 1
PLACE = 1e-4
"""Positions are told in steps of this [mm]: right to half of it."""
SHARE = 4e-6
"""Figures are told in steps of this share of the largest: right to half of it."""
SKIN = 1e-2
"""Points of surfaces, which are only looked at, in steps of this [mm]."""


@dataclass(frozen=True)
class Packed:
    """A scene for one page: its id there, its title, and its text, which is JSON and safe inside a script element."""

    name: str
    title: str
    text: str

    @property
    def json(self) -> Markup:
        """The text as the template takes it: not to be escaped again."""
        return Markup(self.text)


def pack(scene: Scene, name: str = "scene") -> Packed:
    """The packed scene. Raises OverflowError for a position farther than 200 km from the origin."""
    blob = Blob()
    header = {
        "version": VERSION,
        "title": scene.title,
        "nodes": len(scene.index),
        "pieces": len(scene.ends),
        "diameter": scene.diameter,
        "begin": scene.begin,
        "colour": scene.colour,
        "index": [blob.integers(column) for column in scene.index.T],
        "between": blob.integers(scene.between),
        "ends": [blob.integers(scene.ends[:, 0]), blob.integers(scene.ends[:, 1] - scene.ends[:, 0])],
        "family": blob.integers(scene.family),
        "poses": [_pose(blob, pose) for pose in scene.poses],
        "quantities": [_quantity(quantity) for quantity in scene.quantities],
        "skins": [_skin(blob, skin) for skin in scene.skins],
    }
    header["size"] = blob.size
    header["blob"] = base64.b64encode(blob.deflated()).decode("ascii")
    # Inside a script element nothing else than these characters could end it.
    return Packed(name, scene.title, json.dumps(header, separators=(",", ":")).replace("<", "\\u003c"))


def _pose(blob: Blob, pose: Pose) -> dict[str, object]:
    return {
        "name": pose.name,
        "told": pose.told,
        "share": pose.share,
        "stroke": pose.stroke,
        "tool": pose.tool,
        "positions": _points(blob, pose.positions, PLACE),
        "figures": {figure.key: blob.floats(figure.values, _step(figure.values)) for figure in pose.figures},
        # Rounded apart, so that a shape less its reference is right to one step.
        "references": [
            {"name": name, "away": _points(blob, _rounded(places) - _rounded(pose.positions), PLACE)}
            for name, places in pose.references
        ],
    }


def _quantity(quantity: Quantity) -> dict[str, object]:
    over = quantity.shown_over
    return {
        "key": quantity.key,
        "label": quantity.label,
        "unit": quantity.unit,
        "place": quantity.place,
        "signed": quantity.signed,
        "note": quantity.note,
        "marks": [{"value": mark.value, "label": mark.label} for mark in quantity.marks],
        "over": None if over is None else {"value": over[0], "label": over[1]},
    }


def _skin(blob: Blob, skin: Skin) -> dict[str, object]:
    rings, around, _ = skin.points.shape
    told = {"key": skin.key, "label": skin.label, "falls": skin.falls, "rings": rings, "around": around}
    return told | {"points": _points(blob, skin.points.reshape(-1, 3), SKIN)}


def _points(blob: Blob, points: Floats, step: float) -> list[dict[str, object]]:
    return [blob.floats(column, step) for column in points.T]


def _rounded(points: Floats) -> Floats:
    return np.asarray(np.rint(points / PLACE) * PLACE)


def _step(values: Floats) -> float:
    """The step in which values (n,) are told: 1 where all are nil or none is known."""
    known = np.abs(values[np.isfinite(values)])
    return SHARE * float(known.max(initial=0.0)) or 1.0
