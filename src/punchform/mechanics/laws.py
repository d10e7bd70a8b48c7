"""The two section laws behind one door: the law of fibres where there are points, else that of resultants."""

from __future__ import annotations

from numba import njit

from punchform.mechanics import fibres, resultants


@njit(cache=True, nogil=True, error_model="numpy")
def flow(s, past, curve, kinematic, wire, stretch, points, memory, strain, compliance):
    """Plastic strain (4,) added since the past, its derivative (4, 4) with s, and its potential: of the law of fibres
    where there are points, else of resultants."""
    if len(points):
        return fibres.flow(s, past, curve, kinematic, wire, stretch, points, memory, strain, compliance)
    return resultants.flow(s, past, curve, kinematic, wire, stretch, strain, compliance)


@njit(cache=True, nogil=True, error_model="numpy")
def stays(s, past, curve, kinematic, wire, stretch, points):
    """Whether nothing flows in a section, by either law."""
    if len(points):
        return fibres.stays(s, past, curve, kinematic, wire, stretch, points)
    return resultants.stays(s, past, curve, kinematic, wire, stretch)


@njit(cache=True, nogil=True, error_model="numpy")
def largest_strains(past, points, strains):
    """Write the largest equivalent plastic strain (M,) among the sections (M, G, V) of each element."""
    for m in range(len(past)):
        strains[m] = 0.0
        for g in range(past.shape[1]):
            here = fibres.plastic(past[m, g]) if len(points) else resultants.plastic(past[m, g])
            strains[m] = max(strains[m], here)


@njit(cache=True, nogil=True, error_model="numpy")
def keep(s, past, curve, kinematic, wire, stretch, points, memory, after):
    """Write the internal variables of a section after the strains that s adds, of either law."""
    if len(points):
        fibres.settle(s, past, curve, kinematic, wire, stretch, points, memory, after)
    else:
        resultants.settle(s, past, curve, kinematic, wire, stretch, after)
