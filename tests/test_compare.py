"""`punchform compare`, from a folder and a file to a folder; and what is said about a measured shape."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from fake_run import fake_run

from punchform.arrays import Floats
from punchform.case import write_case
from punchform.cli import main
from punchform.cli.compare import read_predicted
from punchform.cli.exits import Exit
from punchform.errors import InputError
from punchform.export.compare import POINT_COLUMNS
from punchform.export.tables import write_nodes, write_wires
from punchform.measured import Comparison, Predicted, Wish, compare, read_cloud, statistics
from punchform.measured.callouts import call_outs
from punchform.measured.pose import Pose, rotation
from punchform.report.figures.measured import deviation_colours
from punchform.store import CASE, NODES, RESULT, WIRES

NOISE = 0.05
TURN = np.radians(0.4) * np.array([0.6, 0.8, 0.0])
SHIFT = np.array([3.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run on a grid of 15 mm whose diagonals sink by up to 6 mm when it is released."""
    formed = fake_run(step=15.0)
    folder = tmp_path_factory.mktemp("runs") / "run"
    folder.mkdir()
    (folder / CASE).write_text(write_case(formed.case), encoding="utf-8")
    (folder / RESULT).write_text('{"schema": 1, "version": "0"}', encoding="utf-8")
    write_wires(folder / WIRES, formed.formed)
    positions = formed.formed.whole.positions
    x, y, _ = positions.T
    rho, angle = np.minimum(np.hypot(x, y) / 300, 1.0), np.arctan2(y, x)
    sunk = 6 * 16 * (rho * (1 - rho)) ** 2 * (0.5 - 0.5 * np.cos(4 * angle) + 0.15 * np.sin(2 * angle + 0.3))
    write_nodes(folder / NODES, formed.formed, positions - np.array([0.0, 0.0, 1.0]) * sunk[:, None])
    return folder


def measured(run: Path, *, seed: int = 1, count: int = 250, sag: float = 1.0) -> tuple[Floats, Floats]:
    """Points at random nodes of the run, tilted, shifted and with noise, and the nodes' (i, j); `sag` scales theirs."""
    rng = np.random.default_rng(seed)
    _, predicted = read_predicted(run)
    formed = read_formed(run)
    rows = rng.choice(len(formed), count, replace=False)
    points = formed[rows] + sag * (predicted.nodes - formed)[rows] + rng.normal(0, NOISE, (count, 3))
    return Pose(rotation(TURN), SHIFT).to_measured(points), predicted.index[rows].astype(np.float64)


def read_formed(run: Path) -> Floats:
    table = np.genfromtxt(run / NODES, delimiter=",", names=True)
    return np.column_stack([table[axis] for axis in "xyz"])


def write_points(path: Path, points: Floats, nodes: Floats | None = None, *, factor: float = 1.0) -> Path:
    names = [f"P{k}" for k in range(len(points))] if nodes is None else [f"{i:.0f}:{j:.0f}" for i, j in nodes]
    rows = (f"{name},{x:.9g},{y:.9g},{z:.9g}" for name, (x, y, z) in zip(names, factor * points, strict=True))
    path.write_text("\n".join(("id,x,y,z", *rows, "")), encoding="utf-8")
    return path


def compared(run: Path, path: Path, wish: Wish | None = None, tolerance: float | None = None) -> Comparison:
    case, predicted = read_predicted(run)
    return compare(case, predicted, read_cloud(path), wish, tolerance=tolerance)


def test_the_command_writes_a_folder_that_can_be_replaced(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points = write_points(tmp_path / "cloud.csv", *measured(run))
    arguments = ["compare", str(run), str(points), "-o", str(tmp_path / "out"), "--tolerance", "8 mm"]
    assert main(arguments) == Exit.DONE
    assert "yes, the measured shape follows the prediction" in capsys.readouterr().out
    assert main(arguments) == Exit.UNUSABLE_INPUT
    assert "--overwrite" in capsys.readouterr().err
    assert main([*arguments[:-1], "0.1 mm", "--overwrite", "--json", "--quiet"]) == Exit.OUT_OF_TOLERANCE
    printed = capsys.readouterr()
    assert printed.err == ""
    content = json.loads(printed.out)
    assert content == json.loads((tmp_path / "out" / "comparison.json").read_text(encoding="utf-8"))
    assert content["within"] is False
    assert content["target"]["in_tol"] + content["target"]["out_tol"] == pytest.approx(1.0)
    assert 8 <= len(content["call_outs"]) <= 20
    files = {str(path.relative_to(tmp_path / "out")) for path in (tmp_path / "out").rglob("*.*")}
    figures = {
        f"figures/{name}.{kind}"
        for name in ("deviation_map", "deviation_histogram", "prediction_map", "call_outs")
        for kind in ("png", "svg")
    }
    assert files == {"comparison.json", "points.csv", "result.json", "report.html", *figures}


@pytest.mark.parametrize("to", ["nodes", "prediction"])
def test_tilt_and_shift_are_recovered_with_their_errors(run: Path, tmp_path: Path, to: str) -> None:
    points, nodes = measured(run)
    path = write_points(tmp_path / "cloud.csv", points, nodes if to == "nodes" else None)
    done = compared(run, path, None if to == "nodes" else Wish(to="prediction"))
    fit = done.alignment.fit
    assert done.alignment.to == to
    assert (np.abs(fit.pose.shift - SHIFT) < 3.5 * fit.errors[:3]).all()
    assert (np.abs(fit.pose.rotation_vector - TURN) < 3.5 * fit.errors[3:]).all()
    assert fit.errors[:3].max() < 0.1
    assert fit.scatter == pytest.approx(NOISE, rel=0.15)
    table = done.prediction.table
    assert table is not None
    assert table.rms == pytest.approx(NOISE, rel=0.15)


def test_a_best_fit_to_the_target_says_what_it_cannot_know(run: Path, tmp_path: Path) -> None:
    done = compared(run, write_points(tmp_path / "cloud.csv", measured(run)[0]))
    assert done.alignment.to == "target"
    assert done.alignment.fit.determined.tolist() == [True] * 5 + [False]
    assert any("turn about the axis" in note for note in done.notes)
    assert any("can hardly be told apart" in note for note in done.notes)


@pytest.mark.parametrize(("sag", "word"), [(1.0, "yes"), (0.55, "in part"), (-1.0, "no")])
def test_the_verdict_on_the_shape_does_not_hang_on_the_alignment(
    run: Path, tmp_path: Path, sag: float, word: str
) -> None:
    points, nodes = measured(run, sag=sag)
    path = write_points(tmp_path / "cloud.csv", points, nodes)
    for wish in (Wish(), Wish("as-given"), Wish(to="target")):
        assert compared(run, path, wish).shape.verdict.startswith(word)


def test_as_given_changes_no_point(run: Path, tmp_path: Path) -> None:
    done = compared(run, write_points(tmp_path / "cloud.csv", measured(run)[0]), Wish("as-given"))
    np.testing.assert_array_equal(done.aligned, done.cloud.points)


def test_the_rim_datum_is_the_plane_and_circle_of_the_named_points(run: Path, tmp_path: Path) -> None:
    points, _ = measured(run)
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    rim = np.column_stack((300 * np.cos(angle), 300 * np.sin(angle), np.zeros(12)))
    rim += np.random.default_rng(2).normal(0, NOISE, rim.shape)
    rim = Pose(rotation(TURN), SHIFT).to_measured(rim)
    path = write_points(tmp_path / "cloud.csv", np.vstack((points, rim)))
    named = ",".join(f"P{len(points) + k}" for k in range(12))
    done = compared(run, path, Wish("rim", rim_points=named, clock=(f"P{len(points) + 3}", np.pi / 2)))
    fit = done.alignment.fit
    assert int(fit.used.sum()) == 12
    assert (np.abs(fit.pose.shift - SHIFT) < 3.5 * fit.errors[:3]).all()
    assert (np.abs(fit.pose.rotation_vector - TURN) < 3.5 * fit.errors[3:]).all()
    x, y, _ = done.aligned[len(points) + 3]
    assert np.arctan2(y, x) == pytest.approx(np.pi / 2, abs=1e-9)


def test_the_rim_without_names_takes_its_middle_from_a_fit_and_says_so(run: Path, tmp_path: Path) -> None:
    done = compared(run, write_points(tmp_path / "cloud.csv", measured(run)[0]), Wish("rim"))
    assert done.alignment.fit.determined.tolist() == [True] * 5 + [False]
    np.testing.assert_allclose(done.alignment.pose.shift[:2], SHIFT[:2], atol=2.0)
    assert any("--rim-points" in note for note in done.notes)


@pytest.mark.parametrize("wish", [Wish(), Wish(to="target"), Wish(to="prediction")])
def test_outliers_are_flagged_and_leave_only_on_request(run: Path, tmp_path: Path, wish: Wish) -> None:
    points, nodes = measured(run)
    inner = np.flatnonzero(np.hypot(*points[:, :2].T) < 200)[[3, 40]]
    points[inner] += [[0, 0, 60.0], [0, 0, -45.0]]
    path = write_points(tmp_path / "cloud.csv", points, nodes)
    kept = compared(run, path, wish)
    assert set(np.flatnonzero(kept.outliers)) == set(inner)
    assert kept.counted.all()
    dropped = compared(run, path, Wish(to=wish.to, drop_outliers=True))
    assert set(np.flatnonzero(~dropped.counted)) == set(inner)
    assert not dropped.alignment.fit.used[inner].any()
    assert dropped.judged.table is not None
    assert dropped.judged.table.n == int((dropped.judged.inside & dropped.counted).sum())
    assert any("left out of fit and statistics" in note for note in dropped.notes)


def test_an_upside_down_cloud_is_turned_over_and_said(run: Path, tmp_path: Path) -> None:
    points, _ = measured(run)
    path = write_points(tmp_path / "cloud.csv", points @ np.diag([1.0, -1.0, -1.0]) + np.array([900.0, 0.0, 70.0]))
    done = compared(run, path, Wish(to="prediction"))
    assert any("upside down" in note for note in done.notes)
    assert done.prediction.table is not None
    assert done.prediction.table.rms == pytest.approx(NOISE, rel=0.15)


def test_a_cloud_in_metres_must_say_so(run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    points = write_points(tmp_path / "cloud.csv", measured(run)[0], factor=1e-3)
    arguments = ["compare", str(run), str(points), "-o", str(tmp_path / "out"), "--quiet"]
    assert main(arguments) == Exit.UNUSABLE_INPUT
    assert "--units m" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    assert main([*arguments, "--units", "m", "--tolerance", "1 m"]) == Exit.DONE


def test_without_a_target_the_prediction_is_judged(run: Path, tmp_path: Path) -> None:
    case, predicted = read_predicted(run)
    path = write_points(tmp_path / "cloud.csv", measured(run)[0])
    done = compare(case.model_copy(update={"target": None}), predicted, read_cloud(path))
    assert done.target is None
    assert done.within is None
    assert done.alignment.to == "prediction"
    assert "without a target" in done.shape.verdict


def test_a_target_with_the_profile_of_the_punch_is_the_punch(run: Path, tmp_path: Path) -> None:
    case, predicted = read_predicted(run)
    done = compared(run, write_points(tmp_path / "cloud.csv", measured(run)[0]), Wish("as-given"))
    assert done.target is not None
    from punchform.punch import surface

    inside = done.target.inside
    np.testing.assert_allclose(done.target.value[inside], surface(case.tool).distance(done.aligned)[inside], atol=1e-9)
    assert predicted.stage == "released"


def test_the_table_of_points_holds_what_was_measured_and_found(run: Path, tmp_path: Path) -> None:
    points, nodes = measured(run)
    path = write_points(tmp_path / "cloud.csv", points, nodes)
    main(["compare", str(run), str(path), "-o", str(tmp_path / "out"), "--quiet"])
    with (tmp_path / "out" / "points.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert tuple(rows[0]) == POINT_COLUMNS
    assert len(rows) == len(points)
    row = next(row for row in rows if row["dev_target"])
    vector = np.array([float(row[f"d{axis}"]) for axis in "xyz"])
    assert np.linalg.norm(vector) == pytest.approx(abs(float(row["dev_target"])), rel=1e-6)
    assert any(not row["dev_target"] for row in rows)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--fit-to", "target", "--align", "rim"], "--align best-fit"),
        (["--rim-points", "P1"], "--align rim"),
        (["--align", "rim", "--rim-points", "Q*"], "no point has the name Q*"),
        (["--align", "rim", "--rim-points", "P1,P2"], "at least 3"),
        (["--align", "rim", "--clock", "P1"], "P7=90 deg"),
        (["--align", "rim", "--clock", "Q1=0 deg"], "no point has the name Q1"),
        (["--fit-to", "nodes"], "named by nodes"),
        (["--tolerance", "1 kg"], "--tolerance"),
        (["--tolerance", "0 mm"], "above zero"),
        (["--units", "km"], "--units"),
    ],
)
def test_wishes_that_cannot_be_met_are_said(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str], said: str
) -> None:
    points = write_points(tmp_path / "cloud.csv", measured(run)[0])
    assert main(["compare", str(run), str(points), "-o", str(tmp_path / "out"), *more]) == Exit.UNUSABLE_INPUT
    printed = capsys.readouterr()
    assert said in printed.err
    assert printed.out == ""


@pytest.mark.parametrize("place", [".", ".."])
def test_the_run_itself_is_never_replaced(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], place: str
) -> None:
    points = write_points(tmp_path / "cloud.csv", measured(run)[0])
    assert main(["compare", str(run), str(points), "-o", str(run / place), "--overwrite"]) == Exit.UNUSABLE_INPUT
    assert "replace the run" in capsys.readouterr().err
    assert (run / NODES).is_file()


def test_the_points_that_are_compared_are_never_replaced(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As those in the folder of an export, which --overwrite would otherwise replace."""
    folder = tmp_path / "files"
    folder.mkdir()
    (folder / RESULT).write_text('{"schema": 1, "version": "0"}')
    points = write_points(folder / "cloud.csv", measured(run)[0])
    command = ["compare", str(run), str(points), "-o", str(folder), "--overwrite"]
    assert main(command) == Exit.UNUSABLE_INPUT
    assert "replace" in capsys.readouterr().err
    assert points.is_file()


def test_a_cloud_of_nothing_near_the_run_is_said(run: Path, tmp_path: Path) -> None:
    line = np.outer(np.linspace(0, 600, 9), [1.0, 0.0, 0.0])
    nodes = np.column_stack((np.arange(9), np.arange(9))).astype(np.float64)
    case, predicted = read_predicted(run)
    flat = Predicted(predicted.index, predicted.flat, predicted.nodes * np.array([1.0, 0.0, 0.0]), "formed")
    with pytest.raises(InputError, match="one line"):
        compare(case, flat, read_cloud(write_points(tmp_path / "line.csv", line, nodes)))


def test_statistics_of_known_numbers() -> None:
    table = statistics(np.array([-2.0, -0.5, 0.0, 0.5, 3.0]), 1.0)
    assert (table.minimum, table.maximum, table.average, table.n) == (-2.0, 3.0, 0.2, 5)
    assert table.rms == pytest.approx(np.sqrt(13.5 / 5))
    assert table.var == pytest.approx(np.var([-2.0, -0.5, 0.0, 0.5, 3.0], ddof=1)) == pytest.approx(table.std**2)
    assert (table.plus_avg, table.minus_avg) == (1.75, -1.25)
    assert (table.in_tol, table.out_tol, table.over_tol, table.under_tol) == pytest.approx((0.6, 0.4, 0.2, 0.2))
    assert statistics(np.ones(1)).within is None


def test_call_outs_hold_the_worst_and_lie_apart() -> None:
    rng = np.random.default_rng(4)
    points, deviations = rng.uniform(-100, 100, (500, 3)), rng.normal(0, 1, 500)
    inside = np.arange(500) % 2 == 0
    rows = call_outs(points, deviations, inside)
    worst = np.flatnonzero(inside)[np.argmax(np.abs(deviations[inside]))]
    assert rows[0] == worst
    assert 8 <= len(rows) == len(set(rows.tolist())) <= 20
    assert inside[rows].all()
    apart = np.linalg.norm(points[rows][:, None] - points[rows], axis=2) + 1e9 * np.eye(len(rows))
    assert apart.min() > 25
    assert len(call_outs(points[:3], deviations[:3], np.ones(3, np.bool_))) == 3
    assert not len(call_outs(points, deviations, np.zeros(500, np.bool_)))


def test_the_colours_are_symmetric_and_green_within_the_tolerance() -> None:
    scale, colours = deviation_colours(np.array([-1.0, 0.2, 4.0]), 0.5)
    assert scale.vmin == -float(scale.vmax or 0.0)
    inner, outer = colours(scale(np.array([-0.4, 0.4]))), colours(scale(np.array([-0.7, 0.7])))
    np.testing.assert_allclose(inner[0], inner[1])
    assert inner[0, 1] > inner[0, 0] > inner[0, 2] or inner[0, 1] == inner[0].max()
    assert outer[0, 2] > outer[0, 0]
    assert outer[1, 0] > outer[1, 2]
