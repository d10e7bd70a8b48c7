"""Running CalculiX on a deck."""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path


def answer_to(deck: str, *, threads: int = 2, timeout: float | None = None) -> str:
    """What `ccx` prints of a deck into its .dat file.

    Raises RuntimeError when it fails, subprocess.TimeoutExpired when it takes longer than `timeout` [s].
    """
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "model.inp").write_text(deck)
        done = subprocess.run(
            ["ccx", "-i", "model"],
            cwd=folder,
            capture_output=True,
            text=True,
            env={**os.environ, "OMP_NUM_THREADS": str(threads)},
            check=False,
            timeout=timeout,
        )
        answer = Path(folder, "model.dat")
        if done.returncode or not answer.exists():
            raise RuntimeError(f"ccx failed:\n{done.stdout[-2000:]}\n{done.stderr[-1000:]}")
        return answer.read_text()
