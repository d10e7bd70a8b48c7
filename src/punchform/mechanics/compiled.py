"""Whether the kernels are already in the cache on disk, and compiling them before a solve is timed."""

from __future__ import annotations

from punchform.mechanics import settling, sweeps, yielding
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.frames import State
from punchform.net.compiled import is_cached


def kernels_are_compiled(*, yields: bool = False) -> bool:
    """Whether an earlier run has left the compiled sweep over the elements on disk; yields: and that of wires that
    yield."""
    wanted = (sweeps.models, yielding.respond, settling.settle) if yields else (sweeps.models,)
    return all(is_cached(kernel) for kernel in wanted)


def compile_kernels(energy: Energy, state: State) -> None:
    """Use every kernel once, so that the seconds of the solve that follows are those of its own work."""
    energy.at(state)
    energy.elastic(state)
    energy.model(energy.kinematics.chart(state), Hessian.EXACT)
    energy.settled(state)
    energy.clock.reset()
