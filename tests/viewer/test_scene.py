"""What the viewer shows is what the tables and figures of the report tell, in every kind of run."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
import stretched
import tiny_dish

from punchform.accuracy import deviations
from punchform.arrays import Floats
from punchform.case import read_case
from punchform.case.reading import case_from_text
from punchform.drape import drape
from punchform.report.drape import write_drape_report
from punchform.report.viewer import Pose, Scene, scene_of, scene_of_net, scene_of_shell
from punchform.report.viewer.skins import punch_skin
from punchform.run import Run, run
from punchform.shell import form_shell
from punchform.whole import node_shear

STAGES = 'schema = 1\nstages = ["press", { trim = { radius = "62 mm" } }, "release"]'


@pytest.fixture(scope="module")
def dish() -> Run:
    return run(tiny_dish.case('[load]\npressure = "100 Pa"\n'))


@pytest.fixture(scope="module")
def cut() -> Run:
    text = tiny_dish.TEXT.replace("schema = 1", STAGES).replace('from_radius = "60 mm"', 'from_radius = "55 mm"')
    return run(case_from_text(text))


def figure(pose: Pose, key: str) -> Floats:
    """The values of a quantity in a pose."""
    return next(one.values for one in pose.figures if one.key == key)


def names(scene: Scene) -> list[str]:
    return [pose.name for pose in scene.poses]


def test_a_pose_for_each_stage(dish: Run) -> None:
    scene = scene_of(dish)
    assert names(scene) == ["flat", "in the tool", "released", "loaded"]
    assert scene.poses[scene.begin].name == "released"
    assert [pose.tool for pose in scene.poses] == [True, True, False, False]


def test_positions_are_those_of_the_stages(dish: Run) -> None:
    scene = scene_of(dish)
    assert dish.released is not None
    assert dish.loaded is not None
    for pose, whole in zip(scene.poses[1:], (dish.formed, dish.released, dish.loaded), strict=True):
        assert np.array_equal(pose.positions, whole.whole.positions)
    assert np.array_equal(scene.poses[0].positions, dish.formed.whole.flat)


def test_figures_of_wires_belong_to_their_pieces(dish: Run) -> None:
    scene, whole = scene_of(dish), dish.formed.whole
    place = {frozenset(pair): k for k, pair in enumerate(zip(whole.start.tolist(), whole.end.tolist(), strict=True))}
    own = np.array([place[frozenset(pair)] for pair in scene.ends.tolist()])
    assert np.array_equal(np.sort(own), np.arange(len(whole.family)))
    pressed = scene.poses[1]
    assert np.array_equal(figure(pressed, "axial_force"), whole.F[own, 0])
    assert np.array_equal(figure(pressed, "moment"), whole.F[own, 4])
    assert np.array_equal(figure(pressed, "stress"), whole.stress[own])
    assert np.array_equal(scene.family, whole.family[own])


def test_figures_of_nodes_are_those_of_the_files(dish: Run) -> None:
    scene, whole = scene_of(dish), dish.formed.whole
    assert np.array_equal(figure(scene.poses[1], "contact_force"), whole.contact)
    shear = np.degrees(node_shear(len(whole.flat), whole.cells, whole.cell_shear))
    np.testing.assert_allclose(figure(scene.poses[1], "shear"), shear, rtol=1e-14, atol=1e-13)
    assert dish.released is not None
    assert np.array_equal(figure(scene.poses[2], "release_moved"), dish.released.moved[:, 2])


def test_the_deviation_is_that_of_the_judged_nodes(dish: Run) -> None:
    scene, accuracy = scene_of(dish), dish.accuracy
    assert accuracy is not None
    assert [one.key for one in scene.quantities[:2]] == ["deviation_held", "deviation_fit"]
    shown = figure(scene.poses[2], "deviation_held")
    assert np.array_equal(np.isfinite(shown), accuracy.mask)
    judged = accuracy.as_held.deviations.of(accuracy.judge.measure)
    assert np.array_equal(shown[accuracy.mask], judged[accuracy.mask])
    assert scene.quantities[0].marks[1].value == pytest.approx(0.5)


def test_the_reference_on_the_target_is_a_deviation_away(dish: Run) -> None:
    pose, accuracy = scene_of(dish).poses[2], dish.accuracy
    assert accuracy is not None
    assert [name for name, _ in pose.references] == ["in the tool", "the target"]
    nearest = pose.references[1][1]
    inside = np.isfinite(nearest).all(axis=1)
    assert inside.sum() >= accuracy.nodes
    away = np.linalg.norm(pose.positions - nearest, axis=1)[accuracy.mask]
    np.testing.assert_allclose(away, np.abs(accuracy.aligned.deviations.normal[accuracy.mask]), atol=1e-9)


def test_strokes_lie_between_flat_and_formed_on_the_lowered_punch() -> None:
    done = stretched.dish()
    scene = scene_of(done)
    assert names(scene)[:5] == ["flat", "stroke 1 of 4", "stroke 2 of 4", "stroke 3 of 4", "in the tool"]
    assert [pose.share for pose in scene.poses[:5]] == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
    for pose in scene.poses[1:4]:
        assert (
            np.abs(pose.share * done.formed.surface.height(pose.positions[:, :2]) - pose.positions[:, 2]).max() < 1e-6
        )
    assert {"axial_strain", "plastic_strain"} <= {one.key for one in scene.quantities}


def test_what_was_cut_off_is_there_before_and_not_after(cut: Run) -> None:
    scene = scene_of(cut)
    assert names(scene) == ["flat", "press 1: in the tool", "trim 1: trimmed", "release 1: released"]
    gone = np.isnan(scene.poses[3].positions[:, 0])
    assert gone.any()
    assert np.isfinite(scene.poses[1].positions).all()
    assert np.array_equal(gone, np.isnan(scene.poses[2].positions[:, 0]))
    whole = cut.final.whole
    later = {(round(x, 6), round(y, 6)): k for k, (x, y, _) in enumerate(whole.flat.tolist())}
    for node in np.flatnonzero(~gone)[::7]:
        x, y, _ = scene.poses[0].positions[node].tolist()
        assert np.array_equal(scene.poses[3].positions[node], whole.positions[later[round(x, 6), round(y, 6)]])
    force = figure(scene.poses[3], "axial_force")
    assert np.array_equal(np.isnan(force), gone[scene.ends].any(axis=1))
    assert np.nansum(force) == pytest.approx(whole.F[:, 0].sum())


def test_wires_cut_between_crossings_have_all_their_nodes() -> None:
    text = tiny_dish.TEXT.replace('step = "10 mm"', 'step = "10 mm"\nsubdivide = 2')
    done = run(case_from_text(text))
    scene = scene_of(done)
    assert set(scene.between.tolist()) == {0, 1}
    assert len(scene.ends) == len(done.formed.whole.family)
    assert np.isnan(figure(scene.poses[2], "deviation_held")[scene.between > 0]).all()


def test_without_release_and_target_the_formed_grid_is_shown() -> None:
    text = tiny_dish.TEXT[: tiny_dish.TEXT.index("[release]")]
    scene = scene_of(run(case_from_text(text)))
    assert names(scene) == ["flat", "in the tool"]
    assert scene.colour == "shear"
    assert [skin.key for skin in scene.skins] == ["punch"]


def test_skins_lie_on_their_surfaces(dish: Run) -> None:
    punch, target = scene_of(dish).skins
    points = punch.points.reshape(-1, 3)
    assert np.abs(dish.formed.surface.distance(points)).max() < 1e-9
    assert float(np.hypot(*points.T[:2]).max()) == pytest.approx(
        float(np.hypot(*dish.formed.whole.positions.T[:2]).max())
    )
    assert dish.accuracy is not None
    pose = dish.accuracy.aligned.fit.pose
    assert np.abs(deviations(target.points.reshape(-1, 3), dish.accuracy.target, pose).normal).max() < 1e-9


def test_rings_are_closer_where_the_punch_bends(dish: Run) -> None:
    rho = punch_skin(dish.formed.surface, 70.0).points[:, 0, 0]
    gaps = np.diff(rho)
    assert (gaps > 0).all()
    fillet = (rho[1:] > 50) & (rho[1:] < 60)
    assert gaps[fillet].mean() < 0.7 * gaps[rho[1:] < 30].mean()


def test_a_net_that_ends_before_the_blank_does(tmp_path: Path) -> None:
    text = tiny_dish.TEXT[: tiny_dish.TEXT.index("[release]")]
    for shallow, deep in (
        ('kind = "paraboloid", focal_length = "60 mm"', 'kind = "sphere", radius = "54 mm"'),
        ('fillet = "20 mm"', 'fillet = "7.2 mm"'),
        ('step = "10 mm"', 'step = "4.5 mm"'),
        ('shape = "circle", radius = "70 mm"', 'shape = "rectangle", size = ["180 mm", "180 mm"]'),
    ):
        assert shallow in text
        text = text.replace(shallow, deep)
    done = drape(case_from_text(text), origin=(42.0, 0.0))
    scene = scene_of_net(done)
    assert not done.net.complete
    missing = np.isnan(scene.poses[1].positions[:, 0])
    assert 0 < missing.sum() < len(missing)
    assert np.isfinite(figure(scene.poses[1], "shear")[~missing]).any()
    write_drape_report(done, tmp_path)
    assert 'data-scene="scene"' in (tmp_path / "report.html").read_text("utf-8")


def test_a_gridshell_has_forces_and_no_punch() -> None:
    done = form_shell(read_case(Path(str(files("punchform") / "cases" / "gridshell.toml"))))
    scene = scene_of_shell(done)
    assert names(scene) == ["flat", "standing"]
    assert scene.skins == ()
    assert np.sort(figure(scene.poses[1], "axial_force")) == pytest.approx(np.sort(done.formed.whole.F[:, 0]))
