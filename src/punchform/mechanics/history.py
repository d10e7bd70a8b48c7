"""What the wires of a grid remember, and the element that asks it: the Python side of `yielding`."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.mechanics import fibres, laws, resultants, settling, yielding

PARTS = 8
"""Parts of the elements for each thread."""


MOST_GROWTH = 0.1
"""A wire is not foreseen to grow by more than this part in a stroke."""


@dataclass(frozen=True, eq=False)
class History:
    """What every one of M elements remembers; it changes when a stroke is over, not while one is sought.

    rest (M, 6): chord measures of the unloaded wire, Eq. (12.14) [mm, rad]; turned (M, 4): how its angles changed in
    the last stroke, and turning (M, 4): what is foreseen of that in the next [rad]; off (M, G, 2): how far its sections
    have moved from where they were made, along the chord's normal and sideways [mm]; stretch (M,): length of the wire
    over that of the new one; grown (M,): by which part it grew in the last stroke, and ahead (M,): what is foreseen of
    that in the next, Eq. (12.18); pull (M,): along its chord [N]; past (M, G, V): internal variables of the sections;
    B, C (M, 6, 6): flexibility and stiffness now; work (M,): of plastic flow so far [mJ].
    """

    rest: Floats
    turned: Floats
    turning: Floats
    off: Floats
    stretch: Floats
    grown: Floats
    ahead: Floats
    pull: Floats
    past: Floats
    B: Floats
    C: Floats
    work: Floats

    def of(self, elements: Ints) -> History:
        """The history of some of the elements, or of copies of them."""
        return History(**{name: values[elements] for name, values in vars(self).items()})

    def foreseen(self, times: float) -> History:
        """The history before a stroke so many times as long as the last: wires go on as in it, Eq. (12.18)."""
        return replace(self, ahead=np.clip(times * self.grown, 0.0, MOST_GROWTH), turning=times * self.turned)

    @property
    def measures(self) -> Floats:
        """What the modes count from, and what else the bow leaves out, (M, 10), as of `chord.measures`."""
        return np.concatenate((self.rest, self.turning), axis=1)

    @property
    def sizes(self) -> tuple[Floats, Floats]:
        """Stretch that area and length have in a stroke, (M,) each: at its end, in its middle; Eq. (12.18)."""
        return self.stretch * (1.0 + self.ahead), self.stretch * (1.0 + 0.5 * self.ahead)


@dataclass(frozen=True, eq=False)
class Beginning:
    """Where the search for end forces begins: the forces (M, 12) of the last call, its modes (M, 6), NaN before the
    first, the derivative of the forces with the modes when they last flowed, hard (M, 12, 6), and what the sections
    found (M, G, 24). Every call overwrites them."""

    forces: Floats
    modes: Floats
    hard: Floats
    sections: Floats


@dataclass(frozen=True, eq=False)
class Response:
    """What a yielding law makes of the modes: end forces F (M, 6), their derivatives with D (M, 6, 6), energies."""

    F: Floats
    stiffness: Floats
    energies: Floats


@dataclass(eq=False)
class Recall:
    """The last answer of wires that yield: a state that a line search has asked for is asked for again at once.

    of: what it is the answer for, by identity: the state, and the grid and the bars, for which alone `begin` is good.
    """

    of: tuple[object, object, object] = (None, None, None)
    begin: Beginning | None = None
    D: Floats = field(default_factory=lambda: np.empty((0, 6)))
    answer: Response | None = None

    def has(self, of: tuple[object, object, object]) -> bool:
        """Whether the answer is that of the same state, grid and bars."""
        return all(one is other for one, other in zip(self.of, of, strict=True))

    def knows(self, of: tuple[object, object, object]) -> bool:
        """Whether it is that of the same grid and bars, in any state."""
        return all(one is other for one, other in zip(self.of[1:], of[1:], strict=True))


@dataclass(frozen=True, eq=False)
class Flowed:
    """What flowing has left in the wires, (M,) each: elongation against the new wire, pulled as it is; stretch of the
    unloaded one; plastic_strain: largest equivalent one of its sections; stress: largest of Eq. (12.4) [MPa]; work of
    the flow so far [mJ]."""

    elongation: Floats
    stretch: Floats
    plastic_strain: Floats
    stress: Floats
    work: Floats


@dataclass(frozen=True, eq=False)
class Yielding:
    """What the elements need to know to yield, by kind of piece where arrays begin with P.

    H (P, G, 4, 6), lever (P, G, 2, 4, 6), weight (P, G), curving (G, G), string (G, 3): as `wire.Stations`;
    C (P, 6, 6), height, length (P,): as `Bars`; curve (K, 2): equivalent plastic strain and flow stress [MPa];
    kinematic: share of its rise that moves the yield surface; wire (3,): E, G [MPa] and diameter [mm]; points (n, 3):
    fibres of a circle of diameter 1, none for the law of resultants.
    """

    H: Floats
    lever: Floats
    weight: Floats
    curving: Floats
    string: Floats
    C: Floats
    height: Floats
    length: Floats
    curve: Floats
    kinematic: float
    wire: Floats
    points: Floats

    def virgin(self, kind: Ints) -> History:
        """The history of new wires, of the kinds (M,)."""
        count, stations = len(kind), self.H.shape[1]
        size = fibres.past_size(len(self.points)) if len(self.points) else resultants.PAST
        return History(
            rest=np.zeros((count, 6)),
            turned=np.zeros((count, 4)),
            turning=np.zeros((count, 4)),
            off=np.zeros((count, stations, 2)),
            stretch=np.ones(count),
            grown=np.zeros(count),
            ahead=np.zeros(count),
            pull=np.zeros(count),
            past=np.zeros((count, stations, size)),
            B=np.asarray(np.linalg.inv(self.C)[kind]),
            C=self.C[kind],
            work=np.zeros(count),
        )

    def beginning(self, count: int) -> Beginning:
        """Where the search begins for so many elements of which nothing is known."""
        return Beginning(
            forces=np.zeros((count, 12)),
            modes=np.full((count, 6), np.nan),
            hard=np.zeros((count, 12, 6)),
            sections=np.full((count, self.H.shape[1], fibres.MEMORY), np.nan),
        )

    def flowed(self, history: History, kind: Ints, F: Floats) -> Flowed:
        """What is left of what flowed, and the stress under end forces F (M, 6)."""
        area = 0.25 * np.pi * self.wire[2] ** 2 / history.stretch
        strains = np.empty(len(history.stretch))
        laws.largest_strains(history.past, self.points, strains)
        size = np.hypot(self.length, self.height)[kind]
        pull = (self.length[kind] * F[:, 0] + self.height[kind] * F[:, 2]) / size
        longer = history.stretch * (1.0 + pull / (self.wire[0] * area))
        return Flowed(longer - 1.0, history.stretch, strains, self._stress(history, kind, F, area), history.work)

    def _stress(self, history: History, kind: Ints, F: Floats, area: Floats) -> Floats:
        """Largest stress (M,) of the sections as if each had yielded throughout, Eq. (12.4) [MPa]."""
        across = area * self.wire[2] / np.sqrt(history.stretch)
        H = self.H[kind] + np.einsum("mgk,mgkab->mgab", history.off, self.lever[kind])
        N, M_2, M_3, T = np.einsum("mgab,mb->amg", H, F)
        bent, turned = 1.5 * np.pi * np.hypot(M_2, M_3), 3.0 * np.sqrt(3.0) * T
        squares = (N / area[:, None]) ** 2 + (bent**2 + turned**2) / across[:, None] ** 2
        return np.asarray(np.sqrt(squares.max(axis=1)))

    @property
    def law(self) -> tuple[Any, ...]:
        """The material, in the order of the kernels."""
        return self.curve, self.kinematic, self.wire, self.points

    @property
    def correction(self) -> Floats:
        """What the sections miss of the flexibility of Eq. (2.4), (P, 6, 6), Eq. (12.16)."""
        missed = np.linalg.inv(self.C)
        for kind, B in enumerate(missed):
            by_sections = np.empty((6, 6))
            settling.flexibility(self.H[kind], self.weight[kind], 1.0, self.wire, np.zeros((6, 6)), by_sections)
            B -= by_sections
        return np.asarray(missed)

    def respond(self, history: History, kind: Ints, D: Floats, begin: Beginning, threads: int) -> Response:
        """Answer the modes D (M, 6) of all elements; what `begin` holds is overwritten."""
        stiffness, energies = np.empty((len(D), 6, 6)), np.empty(len(D))
        past = (history.off, *history.sizes, history.pull, history.past, history.B, history.C)
        made_of = (self.H, self.lever, self.weight, self.string, *self.law)

        known = (begin.sections, begin.forces, begin.modes, begin.hard)

        def answer(part: tuple[int, int]) -> None:
            yielding.respond(*part, kind, D, *made_of, *past, *known, stiffness, energies)

        if threads == 1:
            answer((0, len(D)))
        else:
            # Those that flow lie together: small parts keep all threads busy.
            parts = pairwise(np.linspace(0, len(D), PARTS * threads + 1).astype(int).tolist())
            with ThreadPoolExecutor(threads) as pool:
                list(pool.map(answer, parts))
        return Response(begin.forces[:, :6].copy(), stiffness, energies)

    def settled(self, history: History, kind: Ints, D: Floats, begin: Beginning) -> History:
        """The history after a stroke that ended with the modes D (M, 6) and with what the last call found for them;
        `begin` follows to the modes that the same forces have now."""
        after = replace(history, **{name: values.copy() for name, values in vars(history).items()})
        after.ahead[:] = after.turning[:] = 0.0
        settling.settle(
            kind,
            D,
            begin.forces,
            *(self.H, self.lever, self.weight, self.string, self.curving, self.correction, self.height, self.length),
            *self.law,
            begin.sections,
            *history.sizes,
            history.turning,
            *(
                after.rest,
                after.turned,
                after.off,
                after.stretch,
                after.grown,
                after.pull,
                after.past,
                after.B,
                after.C,
                after.work,
            ),
        )
        begin.modes[:] = np.einsum("mab,mb->ma", after.B, begin.forces[:, :6])
        return after
