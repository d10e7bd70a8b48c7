"""How a worker process begins. Nothing heavy is imported here: the limits must stand before NumPy is loaded."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading

LIMITS = ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""What libraries ask for how many threads they may start."""


def limit_libraries() -> None:
    """Let the libraries of this process use one core: the other cores have workers of their own."""
    for name in LIMITS:
        os.environ[name] = "1"


def begin() -> None:
    """Make ready a process that its parent alone stops: an interrupt from the keyboard ends it without a word, and so
    does the end of the parent."""
    limit_libraries()
    signal.signal(signal.SIGINT, lambda *_: os._exit(1))
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
