"""The flow curve of a material, and the tensile test that it predicts."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from punchform.wire.materials import Material

FLOW = "#2878b5"
TEST = "#c0392b"
BEYOND = 1.25
"""How far the flow curve is drawn beyond the strain at which the wire necks."""


def plot_material(material: Material, path: str | Path) -> None:
    """Draw true and engineering stress over their strains, Eqs. (12.30), (12.34), into a file (png, svg or pdf)."""
    from matplotlib.figure import Figure

    law, E = material.hardening, material.youngs_modulus
    assert law.breaks_at is not None
    # Most of the bend is near yield: points stand closer there.
    p = BEYOND * law.breaks_at * np.linspace(0.0, 1.0, 400) ** 2
    stress = law.flow(p)
    true = np.concatenate(([0.0], p + stress / E))
    stress = np.concatenate(([0.0], stress))
    pulled = true <= law.breaks_at
    figure = Figure(figsize=(7, 4.6), layout="constrained")
    axes = figure.subplots()
    axes.plot(true, stress, color=FLOW, label="true stress over true strain")
    load = stress * np.exp(-true)
    axes.plot(np.expm1(true[pulled]), load[pulled], color=TEST, label="engineering stress over engineering strain")
    end = float(np.expm1(law.breaks_at))
    axes.plot([end], [material.law_strength], "o", color=TEST)
    axes.annotate(
        f"necks at {material.law_strength:.0f} MPa",
        (end, material.law_strength),
        (0, -14),
        textcoords="offset points",
        ha="right",
    )
    axes.set_title(f"{material.name}: {material.law}", fontsize=10)
    axes.set_xlabel("strain [-]")
    axes.set_ylabel("stress [MPa]")
    axes.set_xlim(0.0, None)
    axes.set_ylim(0.0, None)
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right", frameon=False)
    figure.savefig(path, dpi=130)
