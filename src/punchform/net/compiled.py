"""Compiling a kernel: one decorator, and whether an earlier run has already left the result on disk."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """The function as machine code, compiled at its first call and kept on disk."""
    return cast(Function, njit(cache=True, nogil=True, error_model="numpy")(function))


def is_cached(function: Callable[..., Any]) -> bool:
    """Whether the machine code of a kernel made by `compiled` lies on disk."""
    kernel = cast(Any, function)
    folder = Path(str(kernel.stats.cache_path))
    name = Path(str(kernel.py_func.__code__.co_filename)).stem
    return any(folder.glob(f"{name}.{kernel.py_func.__name__}-*.nbc"))
