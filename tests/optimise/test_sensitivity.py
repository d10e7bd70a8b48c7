"""Derivatives by tangents and adjoints against differences of complete solves, and what is told of them."""

from __future__ import annotations

import json
import math
import re
from concurrent.futures import BrokenExecutor, Future, ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_dish import CHANGES, DISH, dish

from punchform.case import Case, number, read_case, varied
from punchform.cli import main
from punchform.errors import InputError
from punchform.mechanics import linear
from punchform.optimise import equilibria as at_rest
from punchform.optimise import tangents
from punchform.optimise.adjoint import adjoint
from punchform.optimise.equilibria import equilibria, why_not
from punchform.optimise.figures import FIGURES, Deviation
from punchform.optimise.knots import FOUR, SHORT, TWO, family, knots, slope, step_of
from punchform.optimise.looks import Seen, one_by_one, seen, shared
from punchform.optimise.numbers import crossing_by_crossing, numbers
from punchform.optimise.pools import given
from punchform.optimise.sensitivity import Sensitivity, gradients, sensitivities
from punchform.optimise.sweep import LOST
from punchform.optimise.tangents import tangent_runs
from punchform.optimise.tolerance_table import csv, result, table
from punchform.report.sensitivity import lines, words
from punchform.run import Run, run

NEAR = 0.5
"""Complete solves stand this much closer together than the knots of the tangents: one crossing may cross the edge of
the fillet between them, where the curvature of the punch jumps."""
FIXED = ("punch.profile.coefficients[0]", "punch.profile.coefficients[1]", "release.ribs[0].lift", "load.gravity")
"""Numbers that cannot vary in a relative of the dish, or change nothing there."""
WHOLLY = ("drawn in", "crossing springs, best fit")
"""Relatives of which every number is tested; of the others a wire's, a punch's, and what only they have."""
FEW = re.compile(r"wire\.diameter|punch\.fillet|release\.ribs.*|grid\.step\[\d\]|punch\.profile\.coefficients.*")


@cache
def done(name: str) -> Run:
    return run(dish(name))


def places(case: Case) -> list[str]:
    """All numbers whose slope exists and can be taken on both sides."""
    return [place for place in numbers(case) if not crossing_by_crossing(place) and not place.startswith(FIXED)]


def solved(case: Case, place: str) -> tuple[tuple[Run, ...], float]:
    """Complete runs at the offsets around a number, and the distance between them."""
    step = NEAR * step_of(case, place)
    return tuple(run(varied(case, {place: number(case, place) + step * offset})) for offset in FOUR), step


def rms(one: Run) -> float:
    assert one.accuracy is not None
    return one.accuracy.judged.rms


@pytest.mark.parametrize("name", CHANGES)
def test_the_adjoint_is_the_slope_of_complete_solves(name: str) -> None:
    """To 1e-5 of the slope; to rounding where nothing moves, as by what scales all forces alike."""
    base = done(name)
    assert why_not(base) == ""
    wanted = [place for place in places(base.case) if name in WHOLLY or FEW.fullmatch(place)]
    assert len(wanted) > 1
    found = gradients(base, wanted, ["rms"])["rms"]
    for place in wanted:
        runs, step = solved(base.case, place)
        direct = float(slope([rms(one) for one in runs], step))
        size = abs(number(base.case, place)) or step_of(base.case, place) / SHORT
        # What is below 1e-9 of the effect of the whole number is not in the digits of the solves.
        assert found[place] == pytest.approx(direct, rel=1e-5, abs=1e-9 / size), place


def test_what_counts_is_tested() -> None:
    """The numbers above are those a workshop would turn."""
    assert {"grid.step", "wire.diameter", "wire.poisson", "wire.centreline.height", "punch.fillet"} < set(places(DISH))
    assert "grid.crossing.stiffness" in places(dish("crossing springs, best fit"))
    assert "release.ribs[0].lift" in numbers(dish("lifted hoop"))
    assert "release.ribs[0].height" in places(dish("hoop at a height"))
    assert "punch.profile.coefficients[2]" in places(dish("polynomial, axial"))
    assert {"grid.step[0]", "grid.step[1]"} < set(places(dish("two steps, half-path")))


@pytest.mark.parametrize("name", ["drawn in", "crossing springs, best fit", "two steps, half-path"])
def test_the_adjoint_is_the_transpose_of_the_tangent(name: str) -> None:
    """Forwards and backwards through press and release give one number, for every measure and alignment."""
    base, deviations = done(name), [one for one, figure in FIGURES.items() if figure.deviation is not None]
    rest = equilibria(base)
    assert rest.factorisations == 3
    backwards = gradients(base, ["wire.diameter", "punch.fillet"], deviations)
    for place in ("wire.diameter", "punch.fillet"):
        step = step_of(base.case, place)
        at = knots(rest.ready, family(base.case, place), step)
        moved = tangent_runs(rest, at)
        for one in deviations:
            of = FIGURES[one].deviation
            assert of is not None
            measure, fitted = of.judged(base.case)
            pairs = zip(at, moved, strict=True)
            forwards = slope(
                [tangents.judged(rest, knot, there.final.state, measure, fitted=fitted).rms for knot, there in pairs],
                step,
            )
            assert backwards[one][place] == pytest.approx(float(forwards), rel=2e-6), (one, place)


def test_other_figures_follow_their_tangents() -> None:
    """Shear, energy, spring of the apex, and the compliance under a load, whose derivative is a third one."""
    base, names = done("drawn in"), ("max_shear", "energy", "apex", "max_sag", "compliance", "rms_deflection", "mass")
    wanted = ("wire.diameter", "punch.profile.focal_length")
    found = gradients(base, wanted, names)
    for place in wanted:
        runs, step = solved(base.case, place)
        for name in names:
            values = [FIGURES[name].of(one) for one in runs]
            direct = float(slope([value for value in values if value is not None], step))
            # A compliance has the digits that the load leaves of the forces.
            near = 1e-4 if name in ("compliance", "rms_deflection") else 1e-5
            assert found[name][place] == pytest.approx(direct, rel=near, abs=1e-12), (name, place)


def test_one_factorisation_for_each_stage(monkeypatch: pytest.MonkeyPatch) -> None:
    """A full gradient costs one factorisation for each stage, whatever the number of settings."""
    counted: list[int] = []
    made = linear.solver_for

    class Counting:
        def __init__(self, *given: Any) -> None:
            self.solver = made(*given)

        def factor(self, values: Any) -> Any:
            counted.append(1)
            return self.solver.factor(values)

    monkeypatch.setattr(at_rest, "solver_for", Counting)
    base = run(DISH.model_copy(update={"load": None}))
    gradients(base, places(base.case), ["rms"])
    assert len(counted) == 2
    assert base.released is not None
    assert base.formed.factorisations + base.released.factorisations > 10


def test_reasons_against_tangents() -> None:
    """What depends on its past, or follows a force, is told with its reason, and refused where it is asked for."""
    for changes, words_ in (
        ({"press.pull": ("1 N", "1 N")}, "pull"),
        ({"press.hold": {"force_per_length": "0.1 N/mm", "friction": 0.2}, "press.frame": "auto"}, "holder"),
        ({"release.hold": {"points": 2, "radius": "40 mm"}, "grid.symmetry": "full"}, "free to move"),
        ({"press.kinematics": "differences", "press.offset": "lower"}, "middle of its wires"),
    ):
        case = varied(DISH.model_copy(update={"load": None}), changes)
        assert words_ in why_not(run(case)), changes
    struck = Case.model_validate({**DISH.model_dump(exclude_unset=True), "stages": ("press", "release", "press")})
    assert "stages" in why_not(run(struck.model_copy(update={"load": None})))
    with pytest.raises(InputError, match="stages"):
        gradients(run(struck.model_copy(update={"load": None})), ["wire.diameter"], ["rms"])
    plain = DISH.model_dump(exclude_unset=True)
    plain.pop("load")
    for stages in (({"press": {"rim": "clamp"}}, "release"), ("press", {"release": {"hold": {"from_radius": 49.0}}})):
        assert "settings of its own" in why_not(run(Case.model_validate({**plain, "stages": stages})))
    assert why_not(run(Case.model_validate({**plain, "stages": ("press", "release")}))) == ""
    loose = varied(Case.model_validate(plain), {"wire.material": "304 annealed", "release.hold": "nothing"})
    assert "nothing holds" in why_not(run(varied(loose, {"press.strokes": 2})))


def test_frames_in_the_clamp_lie_as_the_flat_grid_does() -> None:
    """On a punch whose correction rings a little beyond the rim: the slope by the step is that of complete runs."""
    bumps = [["0 mm", "0.3 mm"], ["30 mm", "0.2 mm"], ["50 mm", "0.01 mm"], ["60 mm", "0 mm"], ["70 mm", "0 mm"]]
    corrected = {"press.rim": "clamp", "punch.correction": {"kind": "radial", "points": bumps}}
    base = run(varied(DISH.model_copy(update={"load": None}), corrected))
    found = gradients(base, ["grid.step"], ["rms", "energy"])
    runs, step = solved(base.case, "grid.step")
    assert found["rms"]["grid.step"] == pytest.approx(float(slope([rms(one) for one in runs], step)), rel=1e-5)
    energies = [one.formed.energy for one in runs]
    assert found["energy"]["grid.step"] == pytest.approx(float(slope(energies, step)), rel=1e-5)


@pytest.mark.parametrize("changes", [{"press.rim": "clamp", "press.strokes": 4}, {"press.strokes": 3}])
def test_wires_that_yield_are_followed_stroke_by_stroke(changes: dict[str, object]) -> None:
    """What flowed in a stroke goes on to the next, and into the release: against complete runs, 1e-6."""
    base = run(varied(DISH.model_copy(update={"load": None}), {"wire.material": "304 annealed", **changes}))
    wanted, names = (
        ("wire.hardening.strength", "punch.profile.focal_length", "grid.step"),
        ("rms", "max_plastic_strain"),
    )
    rest = equilibria(base)
    assert len(rest.trail) == changes["press.strokes"]
    found = gradients(base, wanted, names)
    for place in wanted:
        step = step_of(base.case, place)
        beside = [run(varied(base.case, {place: number(base.case, place) + step * offset})) for offset in TWO]
        for name in names:
            values = [FIGURES[name].of(one) for one in beside]
            direct = float(slope([value for value in values if value is not None], step))
            assert found[name][place] == pytest.approx(direct, rel=1e-6), (place, name)
    with pytest.raises(InputError, match="adjoint of wires that yield"):
        adjoint(rest, Deviation(None))


def test_a_holder_is_told_by_complete_runs() -> None:
    """Its clamp force has a slope too."""
    case = varied(DISH.model_copy(update={"load": None}), {"press.hold": {"force_per_length": 2.0, "friction": 0.15}})
    base = run(varied(case, {"press.strokes": 3}))
    found = sensitivities(base, ["press.hold.force_per_length", "wire.diameter"])
    assert "holder" in found.why_differences
    assert found.runs == 4
    assert {row.how for row in found.rows} == {"differences"}
    assert all(row.slopes["rms"] for row in found.rows)


def test_differences_are_slopes() -> None:
    """Complete runs on both sides give what the tangents give, to the square of their distance."""
    base = done("drawn in")
    smooth = sensitivities(base, ["wire.diameter", "punch.profile.focal_length"], names=("rms", "apex"))
    held = sensitivities(base, ["release.hold.from_radius"]).rows[0]
    assert held.how == "a step apart"
    assert held.shape is None
    from punchform.optimise.sensitivity import _by_differences

    apart = _by_differences(base.case, smooth.seen, [row.place for row in smooth.rows], ("rms", "apex"), one_by_one)
    for row in smooth.rows:
        assert apart[row.place].slopes["apex"] == pytest.approx(row.slopes["apex"], rel=2e-3)
        assert apart[row.place].shape == pytest.approx(row.shape, rel=2e-2)
    tapered = run(varied(base.case, {"target.taper": 12.0}))
    one = sensitivities(tapered, ["punch.profile.focal_length"]).rows[0]
    other = _by_differences(tapered.case, seen(tapered, ("rms",)), [one.place], ("rms",), one_by_one)[one.place]
    assert other.shape == pytest.approx(one.shape, rel=2e-2)


def test_complete_runs_are_shared_among_workers() -> None:
    """The same slopes from workers as from here; a worker that dies leaves a remark."""
    base = done("drawn in")
    case, names = base.case, ("rms", "apex")
    beside = [varied(case, {"wire.diameter": diameter}) for diameter in (0.79, 0.8, 0.81)]
    here = list(one_by_one(beside, names))
    there = list(shared(given(ThreadPoolExecutor(2)))(beside, names))
    assert [look.figures for look in there if isinstance(look, Seen)] == [
        look.figures for look in here if isinstance(look, Seen)
    ]

    class Dying(ThreadPoolExecutor):
        def submit(self, *_: Any, **__: Any) -> Any:
            future: Future[Any] = Future()
            future.set_exception(BrokenExecutor())
            return future

    assert list(shared(given(Dying(1)))(beside, names)) == [LOST] * 3


def test_a_tolerance_keeps_what_is_allowed() -> None:
    """The rms of a shape d + x d' reaches the limit at the tolerance, on the side where it grows faster."""
    rng = np.random.default_rng(3)
    d, rate = rng.normal(size=200), 0.7 * rng.normal(size=200) + 0.1
    here, shape = float(np.sqrt(np.mean(d**2))), float(np.sqrt(np.mean(rate**2)))
    one = Sensitivity("a.b", 1.0, "mm", {"rms": float(np.mean(d * rate)) / here}, shape, "tangent")
    limit = one.tolerance(here, 2.0)
    assert limit is not None
    sides = [float(np.sqrt(np.mean((d + sign * limit * rate) ** 2))) for sign in (1, -1)]
    assert max(sides) == pytest.approx(2.0, rel=1e-12)
    assert one.tolerance(2.5, 2.0) == 0.0
    idle = Sensitivity("a.b", 1.0, "mm", {"rms": 0.0}, 0.0, "tangent")
    assert idle.tolerance(here, 2.0) == math.inf


def test_the_table_begins_with_what_matters() -> None:
    """Rows by falling effect; what has none is named; tolerances once the shape is compensated where it is beyond."""
    base = done("drawn in")
    found = sensitivities(base)
    told = table(found, "rms", 0.6)
    effects = [abs(row.effect) for row in told.rows if row.effect is not None]
    assert effects == sorted(effects, reverse=True)
    assert not told.compensated
    assert "Without effect: " in words(told)[-1]
    assert "wire.youngs_modulus" in words(told)[-1]
    real = [row for row in told.rows if row.alone is not None and math.isfinite(row.alone)]
    assert all(row.shape for row in real)
    assert {row.of.place for row in real}.isdisjoint({"wire.youngs_modulus", "wire.density"})
    assert all(row.together == pytest.approx((row.alone or 0.0) / math.sqrt(len(real))) for row in real)
    beyond = table(found, "rms", 0.1)
    assert beyond.compensated
    assert any("punchform compensate" in sentence for sentence in words(beyond))
    assert len(lines(told)) <= len(found.rows) + 1
    assert csv(told).count("\n") == len(found.rows) + 1
    json.dumps(result((told,)), allow_nan=False)


def test_the_command_prints_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Table on stdout, folder with table, figure, report and result.json; it is written again only when told to."""
    from punchform.case import write_case

    file, folder = tmp_path / "dish.toml", tmp_path / "out"
    file.write_text(write_case(DISH), encoding="utf-8")
    arguments = ["sensitivity", str(file), "-o", str(folder), "--vary", "wire.diameter", "--vary", "punch.fillet"]
    assert main(arguments) == 0
    assert "punch.fillet" in capsys.readouterr().out
    assert {one.name for one in folder.iterdir()} == {
        "case.toml", "figures", "report.html", "result.json", "sensitivity.csv"
    }  # fmt: skip
    assert main(arguments) == 2
    capsys.readouterr()
    assert main([*arguments, "--overwrite", "--json", "--of", "apex", "--of", "rms"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert [row["place"] for row in content["numbers"]] == ["wire.diameter", "punch.fillet"]
    assert set(content["numbers"][0]["slopes"]) == {"rms", "apex"}


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--of", "beauty"], "there is no figure 'beauty'"),
        (["--vary", "wire.diametr"], "no such setting"),
        (["--vary", "wire.material"], "is not a number"),
        (["--allowed", "5 kg"], "--allowed 5 kg"),
        (["--allowed", "-1 mm"], "must be more than 0"),
        (["--workers", "0"], "0 workers are asked for"),
    ],
)
def test_bad_options_are_told(arguments: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    """One message, exit code 2."""
    assert main(["sensitivity", "packaged:dish600" if "--allowed" in arguments else "packaged:check", *arguments]) == 2
    assert told in capsys.readouterr().err


def test_a_case_without_target_has_slopes_but_no_tolerances() -> None:
    """Shear and energy do not need a target."""
    case = read_case("packaged:check").model_copy(update={"target": None, "release": None})
    small = varied(case, {"grid.step": "20 mm", "wire.diameter": "1.5 mm"})
    found = sensitivities(run(small), ["wire.diameter"], names=("energy",))
    row = found.rows[0]
    assert row.slopes["energy"]
    assert row.slopes["rms"] is None
    assert row.shape is None
    assert row.tolerance(0.1, 1.0) is None
    told = table(found, "energy", None)
    assert any("no [target]" in sentence for sentence in words(told))


def test_a_run_beside_the_number_may_fail() -> None:
    """What goes wrong beside the number is a remark, not the end."""
    base = done("drawn in")

    def failing(cases: Any, names: Any) -> Any:
        return ["no equilibrium" for _ in cases]

    row = sensitivities(base, ["release.hold.from_radius"], many=failing).rows[0]
    assert row.slopes["rms"] is None
    assert "no equilibrium" in row.remark
    assert isinstance(sensitivities(base, []).seen, Seen)


def test_the_page_shows_what_the_command_prints(capsys: pytest.CaptureFixture[str]) -> None:
    """The table in docs/sensitivity.md, character by character."""
    page = (Path(__file__).parents[2] / "docs" / "sensitivity.md").read_text(encoding="utf-8")
    assert main(["sensitivity", "packaged:check", "--quiet"]) == 0
    assert capsys.readouterr().out.rstrip() in page
