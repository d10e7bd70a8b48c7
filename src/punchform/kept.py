"""run.npz: a run kept whole, number for number, so that it can be shown and exported again without a solve.

A NumPy archive: every array of the stages is a member under its path, such as `0.whole.positions`; the member `tree`
is the rest as JSON, shaped by the dataclasses of this package. What the case says (punch, wire, target) is made from
the case again, and what wires that yield remember for a further stroke is left out.
"""

from __future__ import annotations

import hashlib
import json
import zipfile
import zlib
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from functools import cache
from pathlib import Path
from types import MappingProxyType, NoneType, UnionType
from typing import Any, Union, cast, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from punchform.case import Case, write_case
from punchform.errors import InputError
from punchform.gridshell import Gridshell
from punchform.load import Loaded
from punchform.mechanics.frames import State
from punchform.prepare import prepare
from punchform.press import Formed
from punchform.release import Released
from punchform.run import Done, Run, Stage, gathered
from punchform.shell import Shell, prepare_shell
from punchform.trim import Trimmed

Arrays = dict[str, NDArray[Any]]

SCHEMA = 1
TREE = "tree"
KINDS: dict[str, type[Done]] = {"press": Formed, "release": Released, "trim": Trimmed, "load": Loaded}
_FROM_THE_CASE = ("surface", "hardening")
"""Fields of stages that the case says."""
NOTHING: Mapping[str, Any] = MappingProxyType({})
_ARRAY = "@array"
"""What stands in the tree for an array."""
_PACKING = 1
"""Level of compression: the lowest, which is four times as fast as the usual one and 5 % larger."""


def keep(run: Run | Shell, path: Path) -> None:
    """Write a run or a gridshell to a file; equal ones give equal bytes but for their seconds. Raises OSError."""
    arrays: Arrays = {}
    shapes = (run.formed,) if isinstance(run, Shell) else tuple(stage.done for stage in run.stages)
    notes = () if isinstance(run, Shell) else run.notes
    stages = [_taken_apart(shape, str(number), arrays) for number, shape in enumerate(shapes)]
    tree = {
        "schema": SCHEMA,
        "case": _mark(run.case),
        "notes": notes,
        "seconds": run.seconds,
        "stages": stages,
    }
    arrays[TREE] = np.frombuffer(json.dumps(tree).encode(), dtype=np.uint8)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=_PACKING) as archive:
        for name, values in arrays.items():
            # A member without a date: the archive of the same run is the same tomorrow.
            member = zipfile.ZipInfo(f"{name}.npy")
            member.compress_type = zipfile.ZIP_DEFLATED
            with archive.open(member, "w", force_zip64=True) as file:
                np.lib.format.write_array(file, np.ascontiguousarray(values), allow_pickle=False)


def kept(case: Case, path: Path) -> Run | Shell:
    """The run of a case, or the gridshell of one without a punch, from the file that `keep` wrote.

    Raises OSError, ValueError for a damaged file or one of another version of the format, and InputError for another
    case than that of the run.
    """
    try:
        arrays = _arrays(path)
        tree = json.loads(arrays.pop(TREE).tobytes())
        if tree["schema"] != SCHEMA:
            raise ValueError(f"its format is {tree['schema']}, not {SCHEMA}")
        if tree["case"] != _mark(case):
            raise InputError.of(
                "the case was changed after the run, so that its numbers are of another one",
                where=str(path.with_name("case.toml")),
                hint="form the changed case into a new folder, or undo the change",
            )
        return _run(case, tree, arrays) if case.press.ends is None else _shell(case, tree, arrays)
    except (KeyError, TypeError, zipfile.BadZipFile, zlib.error, EOFError) as problem:
        raise ValueError(f"it is not what a run is kept in ({problem})") from problem


def _mark(case: Case) -> str:
    """What tells a case from every other."""
    return hashlib.sha256(write_case(case).encode()).hexdigest()


def _run(case: Case, tree: dict[str, Any], arrays: Arrays) -> Run:
    ready = prepare(case)
    given = {"surface": ready.punch, "hardening": ready.elements[0].hardening}
    done: list[Stage] = []
    for step, part in zip(case.steps, tree["stages"], strict=True):
        shape = _put_together(KINDS[step.kind], part, str(len(done)), arrays, given)
        number = 1 + sum(one.kind == step.kind for one in done)
        done.append(Stage(step.kind, number, step.settings, cast("Done", shape)))
    return gathered(case, ready, tuple(done), notes=tuple(tree["notes"]), seconds=tree["seconds"])


def _shell(case: Case, tree: dict[str, Any], arrays: Arrays) -> Shell:
    ready = prepare_shell(case)
    (part,) = tree["stages"]
    formed = _put_together(Gridshell, part, "0", arrays, {"hardening": ready.elements[0].hardening})
    return Shell(case, ready.ends, cast("Gridshell", formed), tree["seconds"])


def _arrays(path: Path) -> Arrays:
    """All members by their paths."""
    arrays: Arrays = {}
    with zipfile.ZipFile(path) as archive:
        for name in archive.namelist():
            with archive.open(name) as member:
                arrays[name.removesuffix(".npy")] = np.lib.format.read_array(member, allow_pickle=False)
    return arrays


def _taken_apart(value: Any, at: str, arrays: Arrays) -> Any:
    """A value as JSON; its arrays go into `arrays` under their paths."""
    if isinstance(value, np.ndarray):
        arrays[at] = value
        return _ARRAY
    if isinstance(value, State):
        value = replace(value, history=None)
    if is_dataclass(value) and not isinstance(value, type):
        names = [field.name for field in fields(value) if field.name not in _FROM_THE_CASE]
        return {name: _taken_apart(getattr(value, name), f"{at}.{name}", arrays) for name in names}
    if isinstance(value, tuple | list):
        return [_taken_apart(one, f"{at}.{number}", arrays) for number, one in enumerate(value)]
    if isinstance(value, Mapping):
        return {name: _taken_apart(one, f"{at}.{name}", arrays) for name, one in value.items()}
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, np.generic):
        return value.item()
    assert value is None or isinstance(value, bool | int | float | str), f"{at} cannot be kept"
    return value


def _put_together(kind: Any, part: Any, at: str, arrays: Arrays, given: Mapping[str, Any] = NOTHING) -> Any:
    """The value of a type from its JSON and the arrays; given: its fields that the case says."""
    if part == _ARRAY:
        return arrays[at]
    origin = get_origin(kind)
    if origin in (Union, UnionType):
        (real,) = (one for one in get_args(kind) if one is not NoneType)
        return None if part is None else _put_together(real, part, at, arrays)
    if is_dataclass(kind):
        values = {
            name: given[name] if name in given else _put_together(hint, part[name], f"{at}.{name}", arrays)
            for name, hint in _hints(cast("type", kind)).items()
        }
        return cast("Callable[..., Any]", kind)(**values)
    if origin is tuple:
        each = get_args(kind)
        kinds = [each[0]] * len(part) if each[-1] is Ellipsis else each
        return tuple(
            _put_together(one, value, f"{at}.{number}", arrays)
            for number, (one, value) in enumerate(zip(kinds, part, strict=True))
        )
    if origin is dict:
        return {name: _put_together(get_args(kind)[1], value, f"{at}.{name}", arrays) for name, value in part.items()}
    if isinstance(kind, type) and issubclass(kind, Enum):
        return kind[part]
    return part


@cache
def _hints(kind: type) -> dict[str, Any]:
    """The fields of a dataclass with their types."""
    hints = get_type_hints(kind, localns={"History": Any})
    return {field.name: hints[field.name] for field in fields(cast("Any", kind))}
