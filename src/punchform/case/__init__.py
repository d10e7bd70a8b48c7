"""The case: what the user asks for, read from a file, checked, in internal units (mm, N, MPa, rad)."""

from punchform.case.correction import FieldPoints, RadialPoints
from punchform.case.ends import COLUMNS, End, EndCase, read_ends
from punchform.case.grid import (
    Blank,
    CircleBlank,
    CrossingSpring,
    GridCase,
    PolygonBlank,
    RectangleBlank,
    SingleWire,
    WiresBlank,
)
from punchform.case.hardening import (
    FibreSection,
    LinearHardening,
    PowerHardening,
    TableHardening,
    TensileHardening,
    VoceHardening,
)
from punchform.case.load import LoadCase, PointForce, WindCase
from punchform.case.memory import machine_memory
from punchform.case.optimise import LimitCase, ObjectiveCase, OptimiseCase, VariableCase
from punchform.case.packaged import PREFIX, TEMPLATE, introduction, packaged_cases, packaged_text
from punchform.case.press import DescentCase, HolderCase, PressCase, SolverCase
from punchform.case.punch import (
    ConeProfile,
    EllipsoidProfile,
    ExpressionProfile,
    FlatProfile,
    ParaboloidProfile,
    PolynomialProfile,
    Profile,
    PunchCase,
    SphereProfile,
    TableProfile,
)
from punchform.case.reading import CaseText, case_from_text, parse, read_case, read_text
from punchform.case.release import HoldFrom, HoldNodes, HoldPoints, HoldRing, ReleaseCase, Rib
from punchform.case.schema import json_schema
from punchform.case.stages import Kind, LoadStage, PressStage, ReleaseStage, Settings, Step, TrimCase, TrimStage
from punchform.case.target import TargetCase
from punchform.case.varying import number, setting, unit, varied, written
from punchform.case.whole import Case, Contradiction
from punchform.case.wire import Centreline, CosineLine, PointsLine, StraightLine, WireCase
from punchform.case.writing import write_case

__all__ = [
    "COLUMNS",
    "PREFIX",
    "TEMPLATE",
    "Blank",
    "Case",
    "CaseText",
    "Centreline",
    "CircleBlank",
    "ConeProfile",
    "Contradiction",
    "CosineLine",
    "CrossingSpring",
    "DescentCase",
    "EllipsoidProfile",
    "End",
    "EndCase",
    "ExpressionProfile",
    "FibreSection",
    "FieldPoints",
    "FlatProfile",
    "GridCase",
    "HoldFrom",
    "HoldNodes",
    "HoldPoints",
    "HoldRing",
    "HolderCase",
    "Kind",
    "LimitCase",
    "LinearHardening",
    "LoadCase",
    "LoadStage",
    "ObjectiveCase",
    "OptimiseCase",
    "ParaboloidProfile",
    "PointForce",
    "PointsLine",
    "PolygonBlank",
    "PolynomialProfile",
    "PowerHardening",
    "PressCase",
    "PressStage",
    "Profile",
    "PunchCase",
    "RadialPoints",
    "RectangleBlank",
    "ReleaseCase",
    "ReleaseStage",
    "Rib",
    "Settings",
    "SingleWire",
    "SolverCase",
    "SphereProfile",
    "Step",
    "StraightLine",
    "TableHardening",
    "TableProfile",
    "TargetCase",
    "TensileHardening",
    "TrimCase",
    "TrimStage",
    "VariableCase",
    "VoceHardening",
    "WindCase",
    "WireCase",
    "WiresBlank",
    "case_from_text",
    "introduction",
    "json_schema",
    "machine_memory",
    "number",
    "packaged_cases",
    "packaged_text",
    "parse",
    "read_case",
    "read_ends",
    "read_text",
    "setting",
    "unit",
    "varied",
    "write_case",
    "written",
]
