"""Whether the kernels are already in the cache on disk, so that a run can say that it compiles first."""

from __future__ import annotations

from pathlib import Path

from punchform.mechanics import sweeps


def kernels_are_compiled() -> bool:
    """Whether an earlier run has left the compiled sweep over the elements on disk."""
    folder = Path(str(sweeps.models.stats.cache_path))
    name = Path(sweeps.__file__).stem
    return any(folder.glob(f"{name}.models-*.nbc"))
