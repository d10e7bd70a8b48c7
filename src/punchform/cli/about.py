"""`punchform about`: what a helper needs to know about an installation."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version

from punchform import __version__
from punchform.case import machine_memory
from punchform.cli.exits import Exit
from punchform.mechanics.linear import chosen_solver

_PACKAGES = ("numpy", "scipy", "numba", "rslab", "py-mkl-pardiso", "pydantic", "matplotlib")


def about() -> Exit:
    """Print versions, platform, the chosen linear solver, cores and memory."""
    facts = {
        "punchform": __version__,
        "Python": f"{platform.python_version()} ({platform.python_implementation()})",
        "platform": platform.platform(),
        "linear solver": chosen_solver(),
        "cores": str(_cores()),
        "memory": f"{machine_memory() / 2**30:.1f} GiB",
        **{name: _version(name) for name in _PACKAGES},
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


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
