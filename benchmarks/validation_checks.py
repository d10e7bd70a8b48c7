"""The checks of docs/validation.md: each computes one figure and knows, from elsewhere, what it must be.

They use the functions of the tests, which hold the same figures and many more; `test` names where.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

TESTS = Path(__file__).resolve().parents[1] / "tests"
sys.path[:0] = [
    str(TESTS / room) for room in ("", "limits", "calculix", "net", "accuracy", "wire", "mechanics", "optimise")
]


@dataclass(frozen=True)
class Check:
    """One figure: what it is, what it must be and who says so, what was found, how far off it may be, and its test.

    `most` is the largest difference that the test allows, in the unit of the figure.
    """

    what: str
    expected: float
    source: str
    found: float
    most: float
    test: str

    @property
    def off(self) -> float:
        """How far off it is."""
        return abs(self.found - self.expected)


def order(coarse: float, fine: float) -> float:
    """The order of an error whose step was halved."""
    return float(np.log2(coarse / fine))


def wire() -> Iterator[Check]:
    """The stiffness of one wire between two crossings."""
    import test_crimped_wire_solids as solids
    import test_wire_flexibility as flexible
    import test_wire_table_1 as table

    test = "tests/wire/test_wire_flexibility.py"
    s, L = flexible.STEEL, 7.5
    textbook = L**3 / (3 * s.EI) + L / s.kappa_GA
    found = float(flexible.flexibility(flexible.straight_line(L), s)[2, 2])
    yield Check("straight wire, end deflection under 1 N [mm]", textbook, "Timoshenko cantilever", found, 1e-9, test)
    wanted = flexible.quarter_circle(5.0, s)
    off = [flexible.relative(flexible.flexibility(flexible.arc(5.0, n), s), wanted) for n in (40, 80)]
    yield Check("quarter circle, order in the number of chords", 2.0, "closed form", order(*off), 0.005, test)
    test = "tests/wire/test_wire_table_1.py"
    worst = float(np.abs(table.deviations(segments=8)).max())
    yield Check("the paper's Table 1 as eight chords, largest difference [%]", 0.0, "the paper", worst, 0.75, test)
    test = "tests/calculix/test_crimped_wire_solids.py"
    solid = solids.deviations(np.array(solids.RECORD["runs"][0]["B"]))
    twist = abs(solid.pop("C35"))
    worst = max(abs(value) for value in solid.values())
    source = "CalculiX, solid elements (kept)"
    yield Check("crimped wire, 11 of 12 entries of C, largest difference [%]", 0.0, source, worst, 1.0, test)
    yield Check("the twelfth, C35, a small difference of large numbers [%]", 0.0, source, twist, 4.0, test)


def large_bending() -> Iterator[Check]:
    """A straight wire bent far: elastica, buckling, a wire over a hill."""
    import test_elastica as elastica

    test = "tests/limits/test_elastica.py"
    for push, (sunk, _) in elastica.ELASTICA.items():
        found = float(elastica.cantilever(push, 0.0, 16, True)[0])
        what = f"elastica, PL²/EI = {push:g}: deflection of the end over L, 16 elements"
        yield Check(what, sunk, "published table", found, 2e-6, test)
    found = float(elastica.cantilever(0.0, 5.0, 32, True)[0])
    yield Check("own weight, wL³/EI = 5, 32 elements", elastica.OWN_WEIGHT[0], "published table", found, 1e-4, test)
    for chord, wanted, counts in ((True, 4.0, (4, 8)), (False, 2.0, (32, 64))):
        off = [float(elastica.errors(5.0, 0.0, count, chord)[0]) for count in counts]
        frame = "the chord" if chord else "the frame at O"
        yield Check(f"order of an element read from {frame}", wanted, "Eq. (3.5), (3.14)", order(*off), 0.15, test)
    found = elastica.buckling_load(8, True)
    yield Check("buckling load over π²EI/L², 8 elements", 1.0, "Euler", found, 4e-5, test)
    low, high = 0.9, 1.1
    while high - low > 1e-7:
        middle = 0.5 * (low + high)
        stable = elastica.torque_is_stable(16, middle * elastica.GREENHILL, True)
        low, high = (middle, high) if stable else (low, middle)
    yield Check("buckling torque over 8.987 EI/L, clamped, 16 elements", 1.0, "Greenhill", high, 2e-4, test)
    found = elastica.laid_over_the_hill(64, True)
    yield Check("bending energy of a wire over a hill, over that of the curve", 1.0, "quadrature", found, 4e-5, test)


def nets() -> Iterator[Check]:
    """The net of wires that keep their length, and the press as its limit."""
    import test_exact_nets as exact
    import test_inextensible as limit
    import test_net_continuum as continuum
    import test_thread_tension as thread

    test, program = "tests/limits/test_exact_nets.py", "independent program"
    off = np.abs(exact.sphere_net(1.0, 0.1, 9) - exact.quarter_of("net_sphere_R1_chord0.1")).max()
    yield Check("Chebyshev net on the unit sphere, largest difference", 0.0, program, float(off), 1e-11, test)
    x = exact.chords_of_parabola(0.5, 0.05, 17, first=0.025)
    off = np.abs(exact.translated(x, 0.5) - exact.quarter_of("net_paraboloid_f0.5_chord0.05")).max()
    yield Check("net on a paraboloid, f = 0.5, largest difference", 0.0, program, float(off), 1e-11, test)
    net = exact.sphere_net(1.0, 0.005, 260)
    diagonal = np.arange(1, 260)
    polar = np.degrees(np.arccos(net[diagonal, diagonal, 2]))
    shear = np.degrees(np.abs(exact.shear(net)[diagonal - 1, diagonal - 1]))
    for colatitude, wanted in exact.DIAGONAL_SHEAR.items():
        what = f"shear on the diagonal of a sphere at {colatitude}° [deg]"
        yield Check(what, wanted, "Eq. (6.4)", float(np.interp(colatitude, polar, shear)), 2e-3, test)
    errors = []
    for step in continuum.STEPS[:2]:
        grid = continuum.rectangle((round(0.9 / step),) * 2, (step, step), symmetry="quarter")
        laid = continuum.lay_net(grid, continuum.Sphere(1.0))
        middle = grid.flat[laid.cells].mean(axis=1)
        errors.append(float(np.abs(laid.shear - (np.pi / 2 - continuum.omega(middle.prod(axis=1)))).max()))
    test = "tests/net/test_net_continuum.py"
    yield Check("order in the step of the laid net's shear", 2.0, "continuum, Eq. (6.4)", order(*errors), 0.2, test)
    errors = [limit.largest(limit.limit("sphere", n) - limit.exact("sphere", n)) for n in (6, 12)]
    test = "tests/limits/test_inextensible.py"
    yield Check("pressed grid, EA → ∞: order in the step", 2.0, "exact net", order(*errors), 0.1, test)
    errors = [limit.largest(limit.positions("sphere", 12, m) - limit.limit("sphere", 12)) for m in (1e3, 1e4)]
    yield Check("pressed grid: order in 1/EA", 1.0, "exact net", float(np.log10(errors[0] / errors[1])), 0.005, test)
    name = next(iter(thread.NETS))
    errors = []
    for count in (12, 24):
        nodes, normals = thread.exact(thread.NETS[name], count, more=1)
        ends = thread.along(nodes, 0)[count, :-1], thread.along(nodes, 1)[:-1, count]
        cut = slice(0, count + 1)
        axis, _ = thread.at_nodes(thread.tensions(nodes[cut, cut], normals[cut, cut], ends, edge=0.5)[0])
        errors.append(float(axis[0] / thread.NETS[name].tension[0] - 1))
    test = "tests/limits/test_thread_tension.py"
    yield Check("thread tension of a pulled net: order in the step", 2.0, "continuum table", order(*errors), 0.02, test)


def check_case() -> Iterator[Check]:
    """The packaged check case, section 11 of the theory, and the ways to solve it."""
    import test_check_case as check

    from punchform import read_case, run

    test, prototype = "tests/test_check_case.py", "independent prototype"
    case = read_case("packaged:check").model_copy(update={"release": None, "load": None})
    formed = run(case).formed
    yield Check("energy, frame at O [mJ]", 6600.058, prototype, formed.energy, 6.6e-3, test)
    place = formed.whole.positions[check.at(formed.whole, 20, 20)]
    yield Check("height of crossing (20, 20) [mm]", 41.50836, prototype, float(place[2]), 1e-4, test)
    chord = run(check.changed(case, press={"frame": "chord"})).formed.energy
    yield Check("energy, chord [mJ]", 6614.378, "recorded earlier, not independent", chord, 6.6e-3, "this table")
    paper = check.changed(case, grid={"weave": "same"}, press={"kinematics": "differences", "offset": "lower"})
    found = run(paper).formed.energy
    yield Check("energy, the paper's kinematics [mJ]", 7007.043, prototype, found, 7e-3, test)
    flat = run(check.changed(case, press={"start": "flat"})).formed.energy
    yield Check(
        "energy from the paper's flat start, over that from the net",
        1.0,
        "the same minimum",
        flat / formed.energy,
        1e-9,
        test,
    )
    full = run(check.changed(case, grid={"symmetry": "full"})).formed.energy
    yield Check("energy of the whole grid, over four quarters", 1.0, "symmetry", full / formed.energy, 1e-9, test)
    other = run(check.changed(case, solver={"linear": "scipy"})).formed.energy
    yield Check("energy with another linear solver, over ours", 1.0, "SciPy", other / formed.energy, 1e-9, test)


def gridshells() -> Iterator[Check]:
    """The elastic gridshell of ten rods."""
    import test_gridshell as shells

    test, source = "tests/limits/test_gridshell.py", "published, extrapolated"
    shell = shells.hemisphere(4)
    height, energy = shells.extrapolated(shells.APEX), shells.extrapolated(shells.ENERGY)
    yield Check("height of its middle [mm]", height, source, shell.height, 5e-4 * height, test)
    yield Check("energy [mJ]", energy, source, shell.energy, 2e-3 * energy, test)


def release_and_load() -> Iterator[Check]:
    """What is let go and loaded: beams, plates, and nonlinear beams of another program."""
    import released_net
    import test_release_closed_forms as closed
    import test_released_net as calculix

    test = "tests/limits/test_release_closed_forms.py"
    strip, element, length = closed.cantilever(9, closed.LoadCase(gravity=(0.0, 0.0, -1e-3)))
    arm = strip.whole.positions[:, 0] - strip.whole.positions[:, 0].max() + length
    force, section = -strip.applied[:, 2], element.section
    bent = force * arm**2 * (3 * length - arm) / (6 * section.EI) + force * arm / section.kappa_GA
    ratio = closed.tip(strip) / (bent[arm > 0].sum() / 3)
    yield Check("strip under its weight, tip over the row of cantilevers", 1.0, "beam theory", ratio, 1e-7, test)
    side, off = 100.0, []
    untwisted = closed.replace(closed.SECTION, GJ=1e-7 * closed.SECTION.EI)
    for count in (8, 16):
        step = side / count
        laid = closed.grid(step=(step, step), size=(1.001 * side, 1.001 * side), weave="stacked")
        elements = closed.straight(laid.step, untwisted)
        plate = closed.loaded(closed.let_go(laid, elements, "rim"), elements, closed.LoadCase(pressure=closed.SMALL))
        exact = closed.navier(plate.whole.flat[:, 0], plate.whole.flat[:, 1], side, untwisted.EI / step)
        off.append(float(np.abs(plate.moved[:, 2] - exact).max() / exact.max()))
    yield Check("square grid on its rim, order to the plate", 2.0, "Navier's series", order(*off), 0.02, test)
    test, source = "tests/calculix/test_released_net.py", "CalculiX, nonlinear beams (kept)"
    for crossing in released_net.CROSSINGS:
        released, loaded = calculix.ours(crossing)
        found = calculix.kept(crossing)
        size = np.linalg.norm(released.moved, axis=1).max()
        off_release = float(np.linalg.norm(released.whole.positions - found["x"], axis=1).max() / size)
        off_load = loaded.moved - (found["y"] - found["x"])
        share = float(np.linalg.norm(off_load, axis=1).max() / loaded.largest_deflection)
        what = f"{crossing} net let go, largest difference over the largest move [%]"
        yield Check(what, 0.0, source, 100 * off_release, 0.5, test)
        yield Check(f"{crossing} net loaded, likewise [%]", 0.0, source, 100 * share, 0.5, test)


def yielding() -> Iterator[Check]:
    """Wires that yield, from the section to the element."""
    import test_crimped_pull as solids
    import test_section_springback as sections

    from punchform.wire.materials import materials

    test, source = "tests/mechanics/test_section_springback.py", "published table"
    annealed = sections.law(193e3, 205, 0, sections.POINTS)
    for radius, wanted in zip((100, 30, 10), (0.5382, 0.8563, 0.9519), strict=True):
        what = f"304 annealed bent to {radius} mm and let go: part of the curvature kept"
        yield Check(what, wanted, source, sections.kept(annealed, radius), 5e-3, test)
    hardening = sections.law(193e3, 205, 193e3 * 2500 / (193e3 - 2500), sections.POINTS)
    found = sections.sprung(hardening, 0.04)
    yield Check("stretched by 4 % and bent: part that springs back", 0.01295, source, found, 5e-3, test)
    test, source = "tests/calculix/test_crimped_pull.py", "CalculiX, plastic solids (kept)"
    for held, most in ((False, 5.0), (True, 2.0)):
        forces, _ = solids.pull(solids.HEIGHT, solids.FIBRES, held=held)
        off = 100 * np.abs(forces / solids.PULLED["held_force" if held else "free_force"] - 1).max()
        what = f"crimped wire pulled straight, crimp {'held' if held else 'free'}: force, largest difference [%]"
        yield Check(what, 0.0, source, float(off), most, test)
    fine = solids.section(solids.fibres.round_points(8, 32))
    rows = zip(*(solids.BENT[name] for name in ("stretch", "curvature", "bent_first", "curvature_kept")), strict=True)
    off = max(abs(solids.kept(fine, s, c, bent_first=bool(first)) - left / c) for s, c, first, left in rows)
    yield Check("stretched, bent and let go: part kept, largest difference", 0.0, source, float(off), 0.01, test)
    worst = max(abs(one.law_strength / one.tensile_strength - 1) for one in materials())
    test = "tests/wire/test_materials.py"
    yield Check("tensile strength of the library's laws [%]", 0.0, "data sheets", 100 * worst, 2.0, test)


def accuracy() -> Iterator[Check]:
    """Best fits and the loss of gain."""
    import test_accuracy_fit as fits

    from punchform.antenna import SPEED_OF_LIGHT, error_for_loss, loss

    test, source = "tests/accuracy/test_accuracy_fit.py", "analytic"
    fit = fits.fitted(fits.displaced(), "6-parameter", "normal")
    yield Check("displaced paraboloid: focal length found [mm]", 303.2, "as made", float(fit.pose.f), 1e-9, test)
    points = fits.with_error(fits.DISC, (fits.DISC.x**2 - fits.DISC.y**2) / fits.RADIUS**2)
    for how, wanted in (("axial", 0.408248), ("normal", 0.374957), ("half-path", 0.344688)):
        found = fits.fitted(points, "4-parameter", how).rms
        yield Check(f"astigmatism of 1 mm, {how} rms after the fit [mm]", wanted, source, found, 5e-7, test)
    for alignment, wanted in (("4-parameter", 0.108745), ("6-parameter", 0.008778)):
        found = fits.fitted(fits.coma(), alignment, "axial").rms
        yield Check(f"coma of 1 mm, {alignment} fit [mm]", wanted, source, found, 5e-7, test)
    test = "tests/antenna/test_antenna_ruze.py"
    yield Check("Ruze's factor, (4π)² 10/ln 10 [dB]", 685.8104, "Ruze", loss(1.0, 1.0), 5e-5, test)
    wavelength = SPEED_OF_LIGHT / 8.42
    found = loss(0.63, wavelength) - loss(0.15, wavelength)
    yield Check("0.63 mm made 0.15 mm at 8.42 GHz: gain won [dB]", 0.2025, "Katow and Guiar", found, 5e-5, test)
    yield Check("loss of λ/20 [dB]", 1.715, "published table", loss(1.0, 20), 5e-4, test)
    yield Check("λ over the error that costs 1 dB", 26.2, "published table", 1 / error_for_loss(1.0, 1.0), 0.05, test)


def optimisation() -> Iterator[Check]:
    """Slopes and sweeps."""
    import test_sensitivity as slopes
    import tiny_dish

    from punchform.optimise.designs import combinations, variation
    from punchform.optimise.pools import InOrder, processes
    from punchform.optimise.sweep import sweep
    from punchform.run import run

    case = tiny_dish.case()
    test = "tests/optimise/test_sensitivity.py"
    for place in ("punch.profile.focal_length", "wire.diameter"):
        found = slopes.gradients(run(case), [place], ["rms"])["rms"][place]
        runs, step = slopes.solved(case, place)
        ratio = found / float(slopes.slope([slopes.rms(one) for one in runs], step))
        what = f"slope of the rms with {place}, over differences of runs"
        yield Check(what, 1.0, "four complete runs", ratio, 1e-5, test)
    designs = list(combinations([variation(case, "wire.diameter=0.6 mm,0.7 mm")]))
    ways = ({one.key: one.figures for one in sweep(case, designs, executor=way)} for way in (InOrder(), processes(2)))
    same = float(next(ways) == next(ways))
    test, what = "tests/optimise/test_sweep.py", "sweep in two processes, the same to the last bit (1: yes)"
    yield Check(what, 1.0, "one loop", same, 0.0, test)


ROOMS = {
    "The wire": wire,
    "Large bending of a wire": large_bending,
    "Nets that keep their length": nets,
    "The check case": check_case,
    "Gridshells": gridshells,
    "Release and load": release_and_load,
    "Wires that yield": yielding,
    "Accuracy and antenna": accuracy,
    "Optimisation": optimisation,
}
"""The checks by the part of the program that they are of."""
