"""The wire room: material and centreline → 6×6 stiffness by unit loads, Eq. (2.4)."""

from punchform.wire.centreline import Centreline, cosine_line, line_through, straight_line
from punchform.wire.element import Element, along, axial_compliance, given, mirror_symmetric, stiffness
from punchform.wire.element_plot import plot_element
from punchform.wire.element_report import ElementReport, describe
from punchform.wire.flexibility import deflections, flexibility, inverse, straight_wire
from punchform.wire.hardening import Hardening
from punchform.wire.pieces import pieces, together
from punchform.wire.section import Section, round_section
from punchform.wire.stations import Stations, stations
from punchform.wire.stress import stress
from punchform.wire.yielding import hardening_of

__all__ = [
    "Centreline",
    "Element",
    "ElementReport",
    "Hardening",
    "Section",
    "Stations",
    "along",
    "axial_compliance",
    "cosine_line",
    "deflections",
    "describe",
    "flexibility",
    "given",
    "hardening_of",
    "inverse",
    "line_through",
    "mirror_symmetric",
    "pieces",
    "plot_element",
    "round_section",
    "stations",
    "stiffness",
    "straight_line",
    "straight_wire",
    "stress",
    "together",
]
