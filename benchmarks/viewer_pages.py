"""How large a page with a viewer is, how long a browser takes to open it, and how fast the picture turns.

    python benchmarks/viewer_pages.py --write docs/performance.md     # between `<!-- table: viewer -->` and its end
    python benchmarks/viewer_pages.py --reports RUN ...               # of whole reports in the folders of runs

Scenes are made of closed forms: a paraboloid pressed and let go, with the figures that a run has. Each page is opened
in a headless Chromium that draws without a graphics card. Needs `pip install punchform[test]` and a Chromium.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser, sync_playwright
from tables import put_between

from punchform.arrays import Floats
from punchform.report.viewer import Figure, Pose, Quantity, Scene, Skin, pack, program, style

RADIUS, FOCAL = 600.0, 500.0
ROUGH = 1e-3
"""What no neighbour foretells of a figure, as a share of the largest: real figures are as rough as that."""
TURNS = 20
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
QUANTITIES = (
    Quantity("deviation", "normal deviation from the target", "mm", "node", signed=True),
    Quantity("shear", "shear angle", "°", "node", signed=True),
    Quantity("contact_force", "contact force", "N", "node", signed=True),
    Quantity("axial_force", "axial force F1", "N", "wire", signed=True),
    Quantity("moment", "bending moment F5", "N mm", "wire", signed=True),
    Quantity("stress", "largest stress in the wire", "MPa", "wire"),
)
FINISHED = """
  const viewer = document.querySelector(".pf-viewer").viewer;
  const gl = viewer.stage.renderer.getContext();
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));"""
"""Reading a pixel waits until the picture is there."""
PICTURES = f"""() => {{
  const begun = performance.now();
  for (let k = 0; k < {TURNS}; k += 1) {{ {FINISHED} %s; viewer.stage.draw(); }}
  {FINISHED}
  return (performance.now() - begun) / {TURNS};
}}"""


def paraboloid(nodes: int) -> Scene:
    """A scene of about so many nodes: flat, pressed and released, with fields as rough as those of a woven grid."""
    half = int(np.sqrt(nodes / np.pi))
    line = np.arange(-half - 1, half + 2)
    i, j = (axis.ravel() for axis in np.meshgrid(line, line, indexing="ij"))
    kept = np.hypot(i, j) <= np.sqrt(nodes / np.pi)
    index = np.column_stack((i, j))[kept]
    number = np.full((len(line), len(line)), -1)
    number[tuple((index + half + 1).T)] = np.arange(len(index))
    x = index * (RADIUS / half)
    flat = np.column_stack((x, np.zeros(len(x))))
    height = (RADIUS**2 - (x**2).sum(axis=1)) / (4 * FOCAL)
    pressed = np.column_stack((x * (1 - (x**2).sum(axis=1, keepdims=True) / (24 * FOCAL**2)), height))
    lobes = np.cos(4 * np.arctan2(x[:, 1], x[:, 0])) * (x**2).sum(axis=1) / RADIUS**2
    released = pressed + np.column_stack((0 * lobes, 0 * lobes, 3.0 * lobes))
    ends, family = [], []
    for axis, (before, after) in enumerate(((number[:-1], number[1:]), (number[:, :-1].T, number[:, 1:].T))):
        pairs = np.column_stack((before.T.ravel(), after.T.ravel()))
        ends.append(pairs[(pairs >= 0).all(axis=1)])
        family.append(np.full(len(ends[-1]), 1 + axis))
    wires = np.concatenate(ends)
    weave = np.where(index[wires[:, 0]].sum(axis=1) % 2, 1.0, -1.0)
    force = 5.0 * lobes[wires].mean(axis=1) + 0.7 * weave
    return Scene(
        title=f"{len(index)} nodes",
        index=index,
        between=np.zeros(len(index), dtype=np.int64),
        ends=wires,
        family=np.concatenate(family),
        diameter=0.5,
        poses=(
            Pose("flat", "the blank", flat, share=0.0),
            Pose("in the tool", "pressed", pressed, _figures(x, lobes, force, weave, 1.0)),
            Pose("released", "let go", released, _figures(x, lobes, force, weave, 0.4), (("in the tool", pressed),)),
        ),
        quantities=QUANTITIES,
        skins=(_dome(),),
        begin=2,
        colour="deviation",
    )


def _figures(x: Floats, lobes: Floats, force: Floats, weave: Floats, size: float) -> tuple[Figure, ...]:
    shear = np.degrees(np.arctan(x[:, 0] * x[:, 1] / (4 * FOCAL**2)))
    moment = 20.0 * size * weave + force
    values = (
        3.0 * size * lobes,
        shear,
        2.0 * size * (1 - lobes),
        size * force,
        moment,
        np.abs(moment) * 30 + np.abs(force),
    )
    noise = np.random.default_rng(1)
    return tuple(
        Figure(quantity.key, told + ROUGH * np.abs(told).max() * noise.standard_normal(len(told)))
        for quantity, told in zip(QUANTITIES, values, strict=True)
    )


def _dome() -> Skin:
    angle = np.linspace(0, 2 * np.pi, 96, endpoint=False)
    rho = np.linspace(0, RADIUS, 64)[:, None]
    height = (RADIUS**2 - rho**2) / (4 * FOCAL) + 0 * angle
    return Skin("punch", "punch", np.stack((rho * np.cos(angle), rho * np.sin(angle), height), axis=-1), falls=True)


def page_of(scene: Scene) -> str:
    """A page with nothing but the viewer of a scene."""
    packed = pack(scene)
    return (
        f'<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>{scene.title}</title><style>{style()}</style>'
        f'<div class="pf-scenes"><div class="pf-viewer" data-scene="{packed.name}"></div></div>'
        f'<script type="application/json" id="{packed.name}">{packed.text}</script><script>{program()}</script></html>'
    )


def timed(browser: Browser, page: Path) -> tuple[float, float, float]:
    """Seconds until the first picture of a page is there, and milliseconds of a turn and of another shape."""
    tab = browser.new_page(viewport={"width": 1280, "height": 900})
    tab.goto(page.resolve().as_uri())
    tab.wait_for_function("document.querySelector('.pf-viewer').viewer?.stage.pictures > 0")
    opened = tab.evaluate(f"() => {{ {FINISHED} return performance.now(); }}")
    turned = tab.evaluate(PICTURES % "viewer.stage.turn(1, 0)")
    slid = tab.evaluate(PICTURES % "viewer.ask({ time: 1 + (k % 10) / 10 })")
    tab.close()
    return opened / 1e3, turned, slid


def row(browser: Browser, nodes: int, folder: Path) -> str:
    """One line of a scene of closed forms: sizes and times."""
    scene = paraboloid(nodes)
    path = folder / f"{nodes}.html"
    path.write_text(page_of(scene), encoding="utf-8")
    opened, turned, slid = timed(browser, path)
    each = len(pack(scene).text) / len(scene.index)
    return (
        f"| {len(scene.index)} | {len(scene.ends)} | {path.stat().st_size / 1e6:.2f} | {each:.0f} "
        f"| {opened:.2f} | {turned:.0f} | {slid:.0f} |"
    )


def report_row(browser: Browser, run: Path) -> str:
    """One line of a whole report: the page of a run folder."""
    told = json.loads((run / "result.json").read_text(encoding="utf-8"))
    page = run / "report.html"
    opened, turned, slid = timed(browser, page)
    size = page.stat().st_size / 1e6
    return f"| {told['case_title']} | {told['grid']['nodes']} | {size:.2f} | {opened:.2f} | {turned:.0f} | {slid:.0f} |"


SCENES = ("nodes", "wire pieces", "page, MB", "bytes a node", "seconds to open", "ms a turn", "ms a shape")
REPORTS = ("report", "crossings", "page, MB", "seconds to open", "ms a turn", "ms a shape")


def table(head: Sequence[str], rows: Callable[[Browser], Iterable[str]]) -> str:
    """The table in Markdown, and what it was measured with."""
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head), *rows(browser)]
        version = browser.version
        browser.close()
    return "\n".join([*lines, "", f"({platform.machine()}, {os.cpu_count()} cores, Chromium {version})"])


def main() -> None:
    """Print the table, and write it into a page when asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, nargs="+", default=[1_000, 5_000, 20_000, 100_000])
    parser.add_argument("--reports", type=Path, nargs="+", metavar="RUN", help="run folders, in place of scenes")
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    if arguments.reports:
        text = table(REPORTS, lambda browser: [report_row(browser, run) for run in arguments.reports])
    else:
        with tempfile.TemporaryDirectory() as folder:
            text = table(SCENES, lambda browser: [row(browser, nodes, Path(folder)) for nodes in arguments.nodes])
    print(text)
    if arguments.write:
        put_between(arguments.write, "reports" if arguments.reports else "viewer", text)


if __name__ == "__main__":
    main()
