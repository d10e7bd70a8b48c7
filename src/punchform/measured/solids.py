"""Points from meshes: the vertices of PLY and STL files, as text or binary. Faces are not used."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from punchform.arrays import Floats
from punchform.errors import InputError, Problem
from punchform.measured.text import Found, unit_in

_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_STL_HEAD, _STL_FACE = 84, 50
_VERTEX = re.compile(rb"^[ \t]*vertex[ \t]+(.*?)[ \t]*\r?$", re.MULTILINE)


@dataclass(frozen=True)
class _Head:
    """Header of a PLY file: byte order ("" for text), elements as (name, count, [(property, type)]), comments."""

    order: str
    elements: tuple[tuple[str, int, list[tuple[str, str]]], ...]
    comments: tuple[str, ...]
    lines: int


def read_ply(content: bytes, *, where: str) -> Found:
    """The vertices of a PLY file. Raises InputError for a file that breaks the format or has no vertices."""
    head_bytes, mark, body = content.partition(b"end_header")
    if not content.startswith(b"ply") or not mark:
        raise _broken("PLY", "it has no header", where)
    body = body[2:] if body.startswith(b"\r\n") else body[1:]
    head = _ply_head(head_bytes.decode("latin-1"), where)
    place = [name for name, _, _ in head.elements].index("vertex")
    if any(kind.startswith("list") for _, _, properties in head.elements[: place + 1] for _, kind in properties):
        raise _broken("PLY", "lists stand before or in the vertices, which is not supported", where)
    vertices = _ply_text(head, body, place, where) if not head.order else _ply_binary(head, body, place, where)
    first = head.lines + 1 + sum(count for _, count, _ in head.elements[:place]) if not head.order else None
    return _found(vertices, unit_in(head.comments), where=where, first_line=first)


def read_stl(content: bytes, *, where: str) -> Found:
    """The distinct vertices of an STL file. Raises InputError for a file that breaks the format."""
    count = int.from_bytes(content[80:_STL_HEAD], "little") if len(content) >= _STL_HEAD else -1
    if len(content) == _STL_HEAD + _STL_FACE * count and count > 0:
        face = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
        corners = np.frombuffer(content, face, count, _STL_HEAD)["corners"].reshape(-1, 3).astype(np.float64)
        comment = content[:80].decode("latin-1")
    elif content.lstrip()[:5].lower() == b"solid":
        corners = _stl_text(content, where)
        comment = content.lstrip().splitlines()[0].decode("latin-1")
    else:
        raise _broken("STL", "it is neither text nor of the length that its count of faces says", where)
    finite = np.isfinite(corners).all(axis=1)
    distinct = np.concatenate((np.unique(corners[finite], axis=0), corners[~finite]))
    return _found(distinct, unit_in((comment,)), where=where)


def _found(points: Floats, unit: str | None, *, where: str, first_line: int | None = None) -> Found:
    """Points as found; those that are not finite become problems."""
    finite = np.isfinite(points).all(axis=1)
    numbers = np.arange(1, len(points) + 1)
    lines = np.zeros(len(points), np.int64) if first_line is None else first_line + numbers - 1
    bad = [
        Problem(f"vertex {number} is not finite", where if first_line is None else f"{where}:{line}")
        for number, line in zip(numbers[~finite], lines[~finite], strict=True)
    ]
    kept = [(float(x), float(y), float(z)) for x, y, z in points[finite]]
    return Found(
        points=tuple(kept),
        names=tuple(str(number) for number in numbers[finite]),
        nodes=(None,) * len(kept),
        sigma=None,
        lines=tuple(int(line) for line in lines[finite]),
        unit=unit,
        problems=tuple(bad),
    )


def _ply_head(text: str, where: str) -> _Head:
    order: str | None = None
    elements: list[tuple[str, int, list[tuple[str, str]]]] = []
    comments = []
    lines = text.splitlines()
    for line in lines:
        match line.split():
            case ["format", kind, _] if kind in _ORDERS:
                order = _ORDERS[kind]
            case ["comment" | "obj_info", *words]:
                comments.append(" ".join(words))
            case ["element", name, count] if count.isdigit():
                elements.append((name, int(count), []))
            case ["property", "list", *_, name] if elements:
                elements[-1][2].append((name, "list"))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1][2].append((name, _TYPES[kind]))
            case ["ply"] | []:
                pass
            case _:
                raise _broken("PLY", f"its header has the line {line.strip()[:60]!r}", where)
    named = {name: [key for key, _ in properties] for name, _, properties in elements}
    if order is None or not {"x", "y", "z"} <= set(named.get("vertex", ())):
        raise _broken("PLY", "its header names no format, or no vertices with x, y and z", where)
    return _Head(order, tuple(elements), tuple(comments), len(lines) + 1)


def _ply_text(head: _Head, body: bytes, place: int, where: str) -> Floats:
    before = sum(count for _, count, _ in head.elements[:place])
    _, count, properties = head.elements[place]
    rows = body.decode("latin-1").splitlines()[before : before + count]
    columns = [[name for name, _ in properties].index(axis) for axis in "xyz"]
    points = np.full((count, 3), np.nan)
    if len(rows) < count:
        raise _broken("PLY", f"it has {len(rows)} of the {count} vertices that its header says", where)
    for number, row in enumerate(rows):
        cells = row.split()
        try:
            points[number] = [float(cells[column]) for column in columns]
        except (IndexError, ValueError):
            # Stays NaN, and is told with the other bad rows.
            continue
    return points


def _ply_binary(head: _Head, body: bytes, place: int, where: str) -> Floats:
    sizes = [
        (count, np.dtype([(name, head.order + kind) for name, kind in properties]))
        for _, count, properties in head.elements[: place + 1]
    ]
    offset = sum(count * kind.itemsize for count, kind in sizes[:-1])
    count, kind = sizes[-1]
    if len(body) < offset + count * kind.itemsize:
        raise _broken("PLY", f"it ends before its {count} vertices do", where)
    vertices: NDArray[np.void] = np.frombuffer(body, kind, count, offset)
    return np.column_stack([vertices[axis].astype(np.float64) for axis in "xyz"])


def _stl_text(content: bytes, where: str) -> Floats:
    rows = [row.split() for row in _VERTEX.findall(content)]
    try:
        points = np.array(rows, dtype=np.float64)
    except ValueError:
        points = np.empty((0, 0))
    if points.ndim != 2 or points.shape[1] != 3:
        raise _broken("STL", "it has no vertices, or some that are not three numbers", where)
    return points


def _broken(kind: str, why: str, where: str) -> InputError:
    return InputError.of(f"not a usable {kind} file: {why}", where=where)
