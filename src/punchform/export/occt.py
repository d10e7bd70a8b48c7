"""Surfaces and solids of the OCCT kernel from arrays, and the data section of a STEP file. Needs the extra `step`."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError

SEWN = 1e-4
"""Edges this near to each other [mm] are one."""
JOINED = 1e-6
"""Ends of lines this near to each other [mm] are one point."""


def demand_occt() -> None:
    """Raise InputError, with what to install, where the kernel is not there."""
    try:
        from OCP.collections import Array2_gp_Pnt  # noqa: F401
    except ImportError as problem:
        raise InputError.of(
            f"STEP files need cadquery-ocp-novtk from version 8 on, which is not installed ({problem})",
            where="--to step",
            hint="pip install 'punchform[step]': 67 MB to load, 390 MB on the disk",
        ) from problem


def trimmed_face(poles: Floats, degrees: tuple[int, int], knots: tuple[Floats, Floats], outline: Floats) -> Any:
    """The face of a B-spline surface within a polygon (k, 2) of its parameters, counter-clockwise.

    poles (m, n, 3); knots: of both directions, as SciPy repeats them.
    """
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
    from OCP.BRepLib import BRepLib
    from OCP.Geom2d import Geom2d_Line
    from OCP.gp import gp_Dir2d, gp_Pnt2d

    surface = bspline_surface(poles, degrees, knots)
    wire = BRepBuilderAPI_MakeWire()
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        way = end - start
        line = Geom2d_Line(gp_Pnt2d(*start.tolist()), gp_Dir2d(*way.tolist()))
        wire.Add(BRepBuilderAPI_MakeEdge(line, surface, 0.0, float(np.hypot(*way))).Edge())
    face = BRepBuilderAPI_MakeFace(surface, wire.Wire(), True).Face()
    BRepLib.BuildCurves3d_s(face)
    BRepLib.SameParameter_s(face, JOINED, True)
    return face


def bspline_surface(poles: Floats, degrees: tuple[int, int], knots: tuple[Floats, Floats]) -> Any:
    """A B-spline surface of poles (m, n, 3)."""
    from OCP.collections import Array2_gp_Pnt
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    net = Array2_gp_Pnt(1, poles.shape[0], 1, poles.shape[1])
    for i, row in enumerate(poles.tolist(), 1):
        for j, pole in enumerate(row, 1):
            net.SetValue(i, j, gp_Pnt(*pole))
    (u, u_times), (v, v_times) = (_knots(along) for along in knots)
    return Geom_BSplineSurface(net, u, v, u_times, v_times, *degrees)


def bspline_edge(poles: Floats, degree: int, knots: Floats) -> Any:
    """An edge along a B-spline curve of poles (m, 3)."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.collections import Array1_gp_Pnt
    from OCP.Geom import Geom_BSplineCurve
    from OCP.gp import gp_Pnt

    line = Array1_gp_Pnt(1, len(poles))
    for i, pole in enumerate(poles.tolist(), 1):
        line.SetValue(i, gp_Pnt(*pole))
    return BRepBuilderAPI_MakeEdge(Geom_BSplineCurve(line, *_knots(knots), degree)).Edge()


def line_edge(start: Floats, end: Floats) -> Any:
    """A straight edge between two points (3,)."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.gp import gp_Pnt

    return BRepBuilderAPI_MakeEdge(gp_Pnt(*map(float, start)), gp_Pnt(*map(float, end))).Edge()


def arc_edge(start: Floats, middle: Floats, end: Floats) -> Any:
    """An edge along the circle through three points (3,)."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.GC import GC_MakeArcOfCircle
    from OCP.gp import gp_Pnt

    points = (gp_Pnt(*map(float, point)) for point in (start, middle, end))
    return BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(*points).Value()).Edge()


def turned_solid(edges: Iterable[Any]) -> Any:
    """The solid that a closed line of edges in the plane y = 0 sweeps about the z axis."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt

    wire = BRepBuilderAPI_MakeWire()
    for edge in edges:
        wire.Add(edge)
    section = BRepBuilderAPI_MakeFace(wire.Wire(), True).Face()
    axis = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))
    return outwards(BRepPrimAPI_MakeRevol(section, axis).Shape())


def sewn_solid(surfaces: Iterable[Any]) -> Any:
    """The solid between surfaces that close on each other."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
    from OCP.TopoDS import TopoDS

    sewing = BRepBuilderAPI_Sewing(SEWN)
    for surface in surfaces:
        sewing.Add(BRepBuilderAPI_MakeFace(surface, JOINED).Face())
    sewing.Perform()
    return outwards(BRepBuilderAPI_MakeSolid(TopoDS.Shell(sewing.SewedShape())).Solid())


def outwards(shape: Any) -> Any:
    """A solid with its faces turned outwards."""
    from OCP.BRepLib import BRepLib
    from OCP.TopoDS import TopoDS

    solid = TopoDS.Solid(shape)
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def step_data(shape: Any, name: str) -> tuple[str, str]:
    """The names of the schema and the data section of the STEP file of a shape, in mm; name: of the product."""
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.Interface import Interface_Static
    from OCP.Message import Message, Message_Gravity
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    for printer in Message.DefaultMessenger_s().Printers():
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    Interface_Static.SetCVal_s("write.step.product.name", name)
    stream = io.BytesIO()
    done = writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    if done == IFSelect_ReturnStatus.IFSelect_RetDone:
        done = writer.WriteStream(stream)
    assert done == IFSelect_ReturnStatus.IFSelect_RetDone, f"the kernel does not write {name}: {done}"
    head, _, data = stream.getvalue().decode("ascii").partition("DATA;")
    schema = head[head.index("FILE_SCHEMA") :].partition(";")[0]
    # The kernel counts the files that it has written, in the name of the product.
    return schema, re.sub(rf"'{name} [0-9]+'", f"'{name}'", data)


def _knots(knots: Floats) -> tuple[Any, Any]:
    """Knots, each once, and how often each is repeated."""
    from OCP.collections import Array1_double, Array1_int

    each, times = np.unique(knots, return_counts=True)
    return _array(Array1_double, each.tolist()), _array(Array1_int, times.tolist())


def _array(kind: Any, values: Sequence[float]) -> Any:
    made = kind(1, len(values))
    for number, value in enumerate(values, 1):
        made.SetValue(number, value)
    return made
