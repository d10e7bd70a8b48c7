"""punchform: how a flat grid of wires becomes a shell when it is pressed over a punch.

>>> from punchform import read_case, run
>>> formed = run(read_case("packaged:new")).formed
>>> formed.outcome.name
'CONVERGED'
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from punchform.case import Case as Case
    from punchform.case import read_case as read_case
    from punchform.drape import Drape as Drape
    from punchform.drape import drape as drape
    from punchform.press import Formed as Formed
    from punchform.run import Run as Run
    from punchform.run import run as run
    from punchform.shell import Shell as Shell
    from punchform.shell import form_shell as form_shell
    from punchform.store import load_run as load_run

__version__ = "0.1.0"

__all__ = [
    "Case",
    "Drape",
    "Formed",
    "Run",
    "Shell",
    "__version__",
    "drape",
    "form_shell",
    "load_run",
    "read_case",
    "run",
]

_HOMES = {
    "Case": "case",
    "read_case": "case",
    "Drape": "drape",
    "drape": "drape",
    "Formed": "press",
    "Run": "run",
    "run": "run",
    "Shell": "shell",
    "form_shell": "shell",
    "load_run": "store",
}
_VERBS = ("run", "drape")


def __getattr__(name: str) -> Any:
    """Public names load on first use: `punchform --help` must not wait for NumPy and Numba."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


class _Package(ModuleType):
    """The package, in which `run` and `drape` are functions also after the modules of these names were imported."""

    def __setattr__(self, name: str, value: object) -> None:
        verb = name in _VERBS and isinstance(value, ModuleType)
        super().__setattr__(name, getattr(value, name) if verb else value)


sys.modules[__name__].__class__ = _Package
