"""The run folder: written aside, then put in place by a rename, so that it is whole or not there; and read
back."""

from __future__ import annotations

import json
import os
import secrets
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from punchform.errors import InputError
from punchform.export.result import result_json
from punchform.export.tables import NODE_COLUMNS, PLASTIC_COLUMNS, WIRE_COLUMNS, write_nodes, write_wires
from punchform.export.told import told, with_the_rest
from punchform.export.vtp import vtp_files

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.shell import Shell

RESULT, CASE, NODES, WIRES, KEPT = "result.json", "case.toml", "nodes.csv", "wires.csv", "run.npz"
WIRES_RELEASED = "wires_released.csv"
_WHOLE_NUMBERS = {"family", "i", "j"}

Extra = Callable[["Run", Path], None]


@dataclass(frozen=True)
class StoredRun:
    """A run folder as read back.

    Attributes: folder; result, the content of result.json; nodes and wires, structured arrays with the
    columns of nodes.csv and wires.csv as fields (`stored.nodes["x"]` is (N,) in mm), NaN where the file has
    an empty cell; wires of a run whose wires yield also have `stretch` and `plastic_strain`; wires_released,
    the same of the released stage, None without one.
    """

    folder: Path
    result: Mapping[str, Any]
    nodes: NDArray[np.void]
    wires: NDArray[np.void]
    wires_released: NDArray[np.void] | None = None


def check_folder(folder: str | Path, *, overwrite: bool = False) -> Path:
    """The absolute path of a folder that a run may be written to.

    Free: a path that does not exist, an empty folder, and with `overwrite` the folder of an earlier run.
    Raises InputError for everything else: a file, a folder of something other than a run, the folder one is
    in or its parents, the home folder, the root. Call it before a long computation; `write_run` calls it
    again.
    """
    path = Path(os.path.expanduser(folder)).resolve()
    where = str(folder)
    _keep_precious(path, where)
    try:
        kind = _kind(path)
    except OSError as problem:
        raise InputError.of(f"cannot be looked into: {problem.strerror}", where=where) from problem
    if kind == "file":
        raise InputError.of("is a file, or lies below one; results need a folder", where=where)
    if kind == "other":
        raise InputError.of(
            f"the folder holds files that are not a punchform run (no usable {RESULT}); it is left as it is",
            where=where,
            hint="name a new folder",
        )
    if kind == "run" and not overwrite:
        raise InputError.of(
            "the folder already holds a run",
            where=where,
            hint="give --overwrite to replace it, or name another folder",
        )
    return path


def keep_apart(output: str | Path, *sources: str | Path) -> None:
    """Refuse a folder for results that would replace the runs and files they are made from, or stand within such a run.

    Raises InputError for the folder of a run or a file, every folder above it, and those below a run.
    """
    target = Path(os.path.expanduser(output)).resolve()
    for source in sources:
        kept = Path(os.path.expanduser(source)).resolve()
        is_run = _read_result(kept) is not None
        if (is_run or kept.is_file()) and (target == kept or target in kept.parents):
            replaced = "the run that they are about" if is_run else f"{source}, which they are made from"
            raise InputError.of(f"the results would replace {replaced}", where=str(output), hint="name another folder")
        if is_run and kept in target.parents:
            raise InputError.of(
                "the results would stand among the files of a run", where=str(output), hint="name another folder"
            )


def check_growing_folder(folder: str | Path, mark: str) -> tuple[Path, bool]:
    """The absolute path of a folder to which results are added one by one, and whether it holds some: it is free, or
    has the file `mark`. Raises InputError for everything else, as `check_folder` does."""
    path = Path(os.path.expanduser(folder)).resolve()
    if (path / mark).is_file():
        return path, True
    if path.is_dir() and _kind(path) == "run":
        raise InputError.of("the folder holds a single run", where=str(folder), hint="name another folder")
    return check_folder(folder), False


def replace_file(path: Path, text: str) -> None:
    """Write a file aside and rename it: whoever reads it sees the old one or the new one, whole. Raises OSError."""
    aside = path.with_name(f".{path.name}.{secrets.token_hex(4)}.new")
    try:
        with aside.open("w", encoding="utf-8", newline="\n") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(aside, path)
    except BaseException:
        aside.unlink(missing_ok=True)
        raise


def write_run(run: Run, folder: str | Path, *, overwrite: bool = False, extras: Sequence[Extra] = ()) -> Path:
    """Write the run folder and return its path: case.toml, result.json, nodes.csv, wires.csv, shape.vtp, run.npz, and
    with a release wires_released.csv.

    `extras` are called as `extra(run, folder)` to add files of their own (the report). Whole or not at all, see
    `write_folder`, and raises what that raises.
    """

    def write(aside: Path) -> None:
        _write_files(run, aside)
        for extra in extras:
            extra(run, aside)

    return write_folder(folder, write, overwrite=overwrite)


def write_folder(folder: str | Path, write: Callable[[Path], None], *, overwrite: bool = False) -> Path:
    """Call `write` on a hidden folder beside the target, which then takes its place; returns its path.

    Whatever stops the writing, KeyboardInterrupt included, leaves the target as it was and nothing beside it.
    Raises InputError as `check_folder` does, and when the disk refuses.
    """
    target = check_folder(folder, overwrite=overwrite)
    made = [parent for parent in target.parents if not parent.exists()]
    aside = target.with_name(f".{target.name}.{secrets.token_hex(4)}.new")
    try:
        aside.mkdir(parents=True)
        write(aside)
        check_folder(folder, overwrite=overwrite)
        _put_in_place(aside, target)
    except BaseException as problem:
        _remove(aside)
        _remove_empty(made)
        if isinstance(problem, OSError):
            raise InputError.of(
                f"the results could not be written: {problem.strerror or problem}",
                where=str(folder),
                hint="check the free space and your rights there, or name another folder",
            ) from problem
        raise
    return target


def read_run(folder: str | Path) -> StoredRun:
    """Read a run folder back. Raises InputError for a folder that is not a run or whose files are damaged."""
    path = Path(os.path.expanduser(folder)).resolve()
    if not path.is_dir():
        raise InputError.of("no such folder", where=str(folder))
    content = _read_result(path)
    if content is None:
        raise InputError.of(
            f"not a punchform run: the folder has no usable {RESULT}",
            where=str(folder),
            hint="give the folder that `punchform form CASE -o FOLDER` wrote",
        )
    nodes, wires = _read_table(path / NODES, NODE_COLUMNS), _read_wires(path / WIRES)
    after = path / WIRES_RELEASED
    return StoredRun(path, content, nodes, wires, _read_wires(after) if after.exists() else None)


def load_run(folder: str | Path) -> Run:
    """The run that a folder holds, as `punchform.run` gave it, without a solve.

    What wires that yield remember for a further stroke (`state.history`) is not kept. Raises InputError for a folder
    that is not a run, that another version wrote, or whose files are damaged.
    """
    from punchform.shell import Shell

    found = load(folder)
    if isinstance(found, Shell):
        raise InputError.of("the folder holds a gridshell, not a grid on a punch", where=str(folder))
    return found


def load(folder: str | Path) -> Run | Shell:
    """The run or the gridshell that a folder holds; raises InputError as `load_run` does."""
    from punchform.case import read_case
    from punchform.kept import kept

    path = Path(os.path.expanduser(folder)).resolve()
    if _kind(path) != "run":
        raise InputError.of(
            f"not a punchform run: the folder has no usable {RESULT}" if path.is_dir() else "no such folder",
            where=str(folder),
            hint="give the folder that `punchform form CASE -o FOLDER` wrote",
        )
    if not (path / KEPT).is_file():
        raise InputError.of(
            f"the folder holds no {KEPT}: another command or an older version wrote it",
            where=str(folder),
            hint=f"form its case again: `punchform form {folder}/{CASE} -o FOLDER`",
        )
    case = read_case(str(path / CASE))
    try:
        return kept(case, path / KEPT)
    except OSError as problem:
        raise InputError.of(f"cannot be read: {problem.strerror}", where=str(path / KEPT)) from problem
    except ValueError as problem:
        raise InputError.of(f"the file is damaged: {problem}", where=str(path / KEPT)) from problem


def _keep_precious(path: Path, where: str) -> None:
    """Refuse the folder one is in, the home folder, and every folder above them (so also the root)."""
    for name, place in (
        ("the folder you are in", os.getcwd()),
        ("your home folder", os.path.expanduser("~")),
    ):
        kept = Path(place).resolve()
        if path == kept or path in kept.parents:
            raise InputError.of(
                f"results cannot replace {name} or a folder above it",
                where=where,
                hint="name a new folder, such as `results/dish`",
            )


def _kind(path: Path) -> Literal["free", "run", "other", "file"]:
    """What stands at the path: nothing or an empty folder (free), a run, another folder, a file."""
    if not path.exists():
        below_file = any(parent.exists() and not parent.is_dir() for parent in path.parents)
        return "file" if below_file else "free"
    if not path.is_dir():
        return "file"
    if not any(path.iterdir()):
        return "free"
    return "other" if _read_result(path) is None else "run"


def _write_files(run: Run, folder: Path) -> None:
    from punchform.case import write_case
    from punchform.kept import keep

    (folder / CASE).write_text(write_case(run.case), encoding="utf-8", newline="\n")
    (folder / RESULT).write_text(result_json(run), encoding="utf-8", newline="\n")
    write_nodes(folder / NODES, *with_the_rest(run))
    write_wires(folder / WIRES, run.formed)
    released = told(run).released
    if released is not None:
        write_wires(folder / WIRES_RELEASED, released)
    vtp_files(run, folder)
    keep(run, folder / KEPT)


def _put_in_place(aside: Path, target: Path) -> None:
    """Rename `aside` to `target`; an older target is moved away first and comes back if that fails."""
    if not target.exists():
        os.rename(aside, target)
        return
    old = target.with_name(f".{target.name}.{secrets.token_hex(4)}.old")
    try:
        os.rename(target, old)
        os.rename(aside, target)
    except BaseException:
        if old.exists() and not target.exists():
            os.rename(old, target)
        raise
    finally:
        if target.exists():
            _remove(old)


def _remove(folder: Path) -> None:
    """Remove a folder, finishing the job even when it is interrupted once."""
    try:
        shutil.rmtree(folder, ignore_errors=True)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _remove_empty(folders: Iterable[Path]) -> None:
    """Remove the parent folders that this call made, innermost first, as far as they are empty."""
    for folder in folders:
        try:
            folder.rmdir()
        except OSError:
            return


def _read_result(folder: Path) -> dict[str, Any] | None:
    """The content of result.json, None unless it is one of ours."""
    try:
        content = json.loads((folder / RESULT).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if isinstance(content, dict) and {"schema", "version"} <= content.keys():
        return content
    return None


def _read_wires(path: Path) -> NDArray[np.void]:
    """The table of elastic wires, or of those that yield, which has further columns."""
    return _read_table(path, WIRE_COLUMNS, PLASTIC_COLUMNS)


def _read_table(path: Path, columns: tuple[str, ...], further: tuple[str, ...] = ()) -> NDArray[np.void]:
    """A CSV file of numbers with exactly these columns, and with the further ones or none of them, as a structured
    array; empty cells are NaN."""
    try:
        head, *rows = path.read_text(encoding="utf-8").splitlines()
        if further and head == ",".join((*columns, *further)):
            columns += further
        if head != ",".join(columns):
            raise ValueError("the header is not " + ",".join(columns))
        if not rows:
            raise ValueError("it has no rows")
        filled = [_fill(row) for row in rows]
        kinds = np.dtype([(name, np.int64 if name in _WHOLE_NUMBERS else np.float64) for name in columns])
        table: NDArray[np.void] = np.loadtxt(filled, dtype=kinds, delimiter=",", ndmin=1)
    except OSError as problem:
        raise InputError.of(f"cannot be read: {problem.strerror}", where=str(path)) from problem
    except ValueError as problem:
        raise InputError.of(f"the file is damaged: {problem}", where=str(path)) from problem
    return table


def _fill(row: str) -> str:
    """The row with its empty cells written as nan."""
    if ",," not in row and not row.endswith(","):
        return row
    return ",".join(cell or "nan" for cell in row.split(","))
