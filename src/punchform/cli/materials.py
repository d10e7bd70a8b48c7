"""`punchform materials`: what wires are made of."""

from __future__ import annotations

import json
import textwrap
from typing import Any

import numpy as np

from punchform.cli.exits import Exit
from punchform.cli.pictures import picture_file
from punchform.cli.talk import say
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.wire.material_plot import plot_material
from punchform.wire.materials import Material, material, materials

SHOWN = (0.0, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4)
"""Plastic strains at which a flow curve is printed."""

_HEADS = ("material", "E", "nu", "density", "yield", "tensile", "necks at", "law")
_UNITS = ("", "GPa", "", "kg/m^3", "MPa", "MPa", "strain", "")


def list_materials(*, as_json: bool, voice: Voice) -> Exit:
    """Print the table of all materials."""
    known = materials()
    if as_json:
        print(json.dumps([_json_ready(one) for one in known], indent=2, allow_nan=False))
        return Exit.DONE
    rows = [_HEADS, _UNITS, *map(_row, known)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(_HEADS))]
    for row in rows:
        cells = [
            row[0].ljust(widths[0]),
            *(cell.rjust(width) for cell, width in zip(row[1:-1], widths[1:], strict=False)),
        ]
        print("  ".join((*cells, row[-1])).rstrip())
    if voice is not Voice.QUIET:
        say('`punchform materials NAME` tells where the numbers come from; in a case file: material = "NAME"')
    return Exit.DONE


def show_material(name: str, *, as_json: bool, plot: str | None, voice: Voice) -> Exit:
    """Print the numbers of one material, their source and its flow curve, and draw that. Raises InputError."""
    one = material(name)
    image = None if plot is None else picture_file(plot, "such as -o curve.png")
    print(json.dumps(_json_ready(one), indent=2, allow_nan=False) if as_json else _text(one))
    if image is not None:
        plot_material(one, image)
        if voice is not Voice.QUIET:
            say(f"drew {image}")
    return Exit.DONE


def materials_command(name: str | None, *, as_json: bool, plot: str | None, voice: Voice) -> Exit:
    """All materials, or the one that is named. Raises InputError for an unknown name and a picture of all."""
    if name is not None:
        return show_material(name, as_json=as_json, plot=plot, voice=voice)
    if plot is not None:
        raise InputError.of("a picture is of one material", where=plot, hint="punchform materials NAME -o FILE.png")
    return list_materials(as_json=as_json, voice=voice)


def _row(one: Material) -> tuple[str, ...]:
    return (
        one.name,
        f"{one.youngs_modulus / 1000:g}",
        f"{one.poisson:g}",
        f"{one.density:g}",
        f"{one.yield_strength:g}",
        f"{one.tensile_strength:g}",
        f"{one.hardening.breaks_at:.3f}",
        one.law.partition(",")[0],
    )


def _json_ready(one: Material) -> dict[str, Any]:
    return {
        "name": one.name,
        "youngs_modulus_MPa": one.youngs_modulus,
        "poisson": one.poisson,
        "density_kg_m3": one.density,
        "yield_strength_MPa": one.yield_strength,
        "tensile_strength_MPa": one.tensile_strength,
        "law": one.law,
        "law_tensile_strength_MPa": one.law_strength,
        "necks_at_true_strain": one.hardening.breaks_at,
        "flow_curve": {"columns": ["plastic_strain", "true_stress_MPa"], "rows": one.hardening.curve.tolist()},
        "source": one.source,
        "remark": one.remark,
    }


def _text(one: Material) -> str:
    law = one.hardening
    proof = float(law.flow(0.002))
    facts = {
        "Young's modulus": f"{one.youngs_modulus / 1000:g} GPa",
        "Poisson's ratio": f"{one.poisson:g}",
        "density": f"{one.density:g} kg/m^3",
        "yield strength": f"{one.yield_strength:g} MPa, taken as the stress at which plastic strain begins",
        "0.2 % proof stress": f"{proof:.0f} MPa by the flow curve",
        "tensile strength": f"{one.tensile_strength:g} MPa; {one.law_strength:.0f} MPa by the flow curve, at a true "
        f"strain of {law.breaks_at:.3f}, where the wire begins to neck",
        "law": one.law,
        "source": one.source,
        "remark": one.remark,
    }
    parts = [one.name]
    for name, words in facts.items():
        parts += textwrap.wrap(words, 110, initial_indent=f"  {name:<18}  ", subsequent_indent=" " * 22)
    strains = [p for p in SHOWN if p + law.flow(p) / one.youngs_modulus <= (law.breaks_at or np.inf)]
    parts += ["", "  plastic strain  true stress  engineering stress"]
    for p in strains:
        stress = float(law.flow(p))
        load = stress * np.exp(-p - stress / one.youngs_modulus)
        parts.append(f"  {p:>14g}  {stress:>7.1f} MPa  {load:>14.1f} MPa")
    return "\n".join(parts)
