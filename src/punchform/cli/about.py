"""`punchform about`: what a helper needs to know about an installation."""

from __future__ import annotations

import json
import os
import platform
from importlib.metadata import PackageNotFoundError, version

from punchform import __version__
from punchform.case import machine_memory
from punchform.cli.exits import Exit
from punchform.mechanics.linear import chosen_solver

_PACKAGES = ("numpy", "scipy", "numba", "rslab", "py-mkl-pardiso", "pydantic", "matplotlib")


def about(*, as_json: bool) -> Exit:
    """Print versions, platform, the chosen linear solver, cores and memory."""
    packages = {name: _version(name) for name in _PACKAGES}
    cores, memory = _cores(), machine_memory() / 2**30
    python = f"{platform.python_version()} ({platform.python_implementation()})"
    if as_json:
        content = {
            "punchform": __version__,
            "python": python,
            "platform": platform.platform(),
            "linear_solver": chosen_solver(),
            "cores": cores,
            "memory_GiB": round(memory, 3),
            "packages": packages,
        }
        print(json.dumps(content, indent=2, allow_nan=False))
        return Exit.DONE
    facts = {
        "punchform": __version__,
        "Python": python,
        "platform": platform.platform(),
        "linear solver": chosen_solver(),
        "cores": str(cores),
        "memory": f"{memory:.1f} GiB",
        **{name: found or "not installed" for name, found in packages.items()},
    }
    width = max(map(len, facts))
    for name, fact in facts.items():
        print(f"{name:<{width}}  {fact}")
    return Exit.DONE


def _cores() -> int:
    """Cores that this process may use, which in a container are fewer than the machine has."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
