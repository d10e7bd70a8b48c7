"""How large a page with a 3D viewer is, how long a browser takes to open it, and how fast the picture turns.

    python benchmarks/viewer_pages.py [NODES ...]

Scenes are made of closed forms: a paraboloid pressed and let go, with the figures that a run has. Each page is opened in
a headless Chromium that draws without a graphics card. Needs `pip install punchform[test]` and a Chromium.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

from punchform.arrays import Floats
from punchform.report.viewer import Figure, Pose, Quantity, Scene, Skin, pack, program, style

SIZES = (5_000, 20_000, 100_000)
RADIUS, FOCAL = 600.0, 500.0
TURNS = 30
CHROMIUM = "/usr/bin/chromium"
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
QUANTITIES = (
    Quantity("deviation", "normal deviation from the target", "mm", "node", signed=True),
    Quantity("shear", "shear angle", "°", "node", signed=True),
    Quantity("contact_force", "contact force", "N", "node", signed=True),
    Quantity("axial_force", "axial force F1", "N", "wire", signed=True),
    Quantity("moment", "bending moment F5", "N mm", "wire", signed=True),
    Quantity("stress", "largest stress in the wire", "MPa", "wire"),
)
TURN = f"""async () => {{
  const viewer = document.querySelector(".pf-viewer").viewer;
  const gl = viewer.stage.renderer.getContext();
  const pixel = new Uint8Array(4);
  const begun = performance.now();
  for (let k = 0; k < {TURNS}; k += 1) {{
    viewer.stage.turn(1, 0);
    viewer.stage.draw();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    await new Promise(requestAnimationFrame);
  }}
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
        pairs = np.column_stack((before.T.ravel(), after.T.ravel()) if axis == 0 else (before.T.ravel(), after.T.ravel()))
        pairs = pairs[(pairs >= 0).all(axis=1)]
        ends.append(pairs)
        family.append(np.full(len(pairs), 1 + axis))
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
    values = (3.0 * size * lobes, shear, 2.0 * size * (1 - lobes), size * force, moment, np.abs(moment) * 30 + np.abs(force))
    return tuple(Figure(quantity.key, told) for quantity, told in zip(QUANTITIES, values, strict=True))


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


def main(sizes: tuple[int, ...]) -> None:
    """Print the table."""
    from playwright.sync_api import sync_playwright

    print(f"{'nodes':>8} {'wire pieces':>12} {'page MB':>8} {'bytes/node':>10} {'open s':>7} {'turn ms':>8} {'slide ms':>8}")
    with sync_playwright() as play, tempfile.TemporaryDirectory() as folder:
        browser = play.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        for nodes in sizes:
            scene = paraboloid(nodes)
            path = Path(folder) / f"{nodes}.html"
            path.write_text(page_of(scene), encoding="utf-8")
            size = path.stat().st_size
            tab = browser.new_page(viewport={"width": 1280, "height": 900})
            tab.goto(path.as_uri())
            tab.wait_for_function("document.querySelector('.pf-viewer').viewer?.stage.pictures > 0", timeout=60_000)
            opened = tab.evaluate("document.querySelector('.pf-viewer').viewer && performance.now()") / 1000
            turned = tab.evaluate(TURN)
            slid = tab.evaluate(TURN.replace("viewer.stage.turn(1, 0)", "viewer.ask({ time: 1 + (k % 10) / 10 })"))
            text = len(pack(scene).text)
            print(
                f"{len(scene.index):>8} {len(scene.ends):>12} {size / 1e6:>8.2f} {text / len(scene.index):>10.1f} "
                f"{opened:>7.2f} {turned:>8.0f} {slid:>8.0f}"
            )
            tab.close()
        browser.close()


if __name__ == "__main__":
    main(tuple(int(size) for size in sys.argv[1:]) or SIZES)
