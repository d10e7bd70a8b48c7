"""`punchform form`: from a case file to a run folder."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, cast

from punchform.case import parse, read_text
from punchform.cli.drawing import Drawing
from punchform.cli.exits import Exit
from punchform.cli.shell import form_gridshell
from punchform.cli.talk import WRITING, Talk, notes, say
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.export.result import all_notes, largest
from punchform.export.told import told
from punchform.press import Formed
from punchform.report.accuracy_words import judgement
from punchform.run import Run, run
from punchform.store import RESULT, check_folder, write_run

if TYPE_CHECKING:
    from punchform.release import Released
    from punchform.trim import Trimmed


def form(path: str, output: str, *, overwrite: bool, voice: Voice, as_json: bool) -> Exit:
    """Press the grid of a case over its punch, or move its wire ends, and write the run folder.

    Raises InputError for a case or folder that cannot be used (before anything is solved where possible) and
    NoEquilibrium when the solve ends without one.
    """
    source = read_text(path)
    case = parse(source)
    check_folder(output, overwrite=overwrite)
    if case.press.ends is not None:
        return form_gridshell(source, case, output, overwrite=overwrite, voice=voice, as_json=as_json)
    with Talk(voice) as talk:
        try:
            done = run(case, observe=talk)
        except InputError as error:
            raise source.placed(error) from None
        talk.begin(WRITING)
        drawing = Drawing(talk)
        folder = write_run(done, output, overwrite=overwrite, extras=(drawing,))
    drawing.settle(folder)
    notes(all_notes(done), voice)
    print((folder / RESULT).read_text(encoding="utf-8").rstrip() if as_json else summary(done, folder))
    if not done.formed.outcome.usable:
        say(f"error: {done.formed.outcome.value}")
        return Exit.NO_EQUILIBRIUM
    return Exit.OUT_OF_TOLERANCE if done.accuracy is not None and done.accuracy.within is False else Exit.DONE


def summary(done: Run, folder: Path) -> str:
    """What a person wants to know first about a run, in a few lines."""
    formed, whole = done.formed, done.formed.whole
    facts = {
        "grid": f"{whole.crossings} crossings, {len(whole.family)} wire pieces; "
        f"{formed.solved_nodes} {'crossings' if whole.crossings == len(whole.index) else 'nodes'} solved",
        "outcome": formed.outcome.value,
        "energy": f"{formed.energy:.7g} mJ",
        "effort": _effort(formed),
        "largest shear": f"{math.degrees(formed.max_shear):.3g} deg",
        **_strain(formed),
        "largest stress": _stress(formed),
        "draw-in": f"{formed.draw_in:.3g} mm",
        "press force": f"{formed.push:.4g} N along the axis",
        **_holder(formed),
        **after(done),
        "report": str(folder / "report.html"),
    }
    width = max(map(len, facts))
    return "\n".join([done.case.title, *(f"  {name:<{width}}  {fact}" for name, fact in facts.items())])


def after(done: Run) -> dict[str, str]:
    """The facts of the stages after the press, as far as the case asks for them."""
    facts, shown = _stages(done), told(done)
    if shown.released is not None:
        gone = shown.released
        i, j = gone.whole.index[gone.lowest]
        facts["released"] = (
            f"{gone.energy:.7g} mJ left; apex {gone.apex:+.3g} mm, lowest {gone.max_sag:+.3g} mm at ({i}, {j}); "
            f"{gone.factorisations} factorisations, {gone.seconds['total']:.2f} s"
        )
        facts |= _springback(gone)
    if shown.loaded is not None:
        facts["loaded"] = f"{shown.loaded.load:.4g} N move the shape by {shown.loaded.rms_deflection:.3g} mm rms"
    if done.accuracy is not None:
        facts["accuracy"] = judgement(done.accuracy)
    return facts


def _holder(formed: Formed) -> dict[str, str]:
    grip = formed.grip
    if grip is None:
        return {}
    return {
        "holder": f"{100 * grip.slipped:.3g} % of its crossings slipped, by up to {grip.largest_slip:.3g} mm; "
        f"{grip.work:.4g} mJ of friction"
    }


def _stages(done: Run) -> dict[str, str]:
    """All stages by their names, where the case names them, and what was cut off."""
    if done.case.stages is None:
        return {}
    trims = {stage.name: cast("Trimmed", stage.done) for stage in done.stages if stage.kind == "trim"}
    return {"stages": ", ".join(stage.name for stage in done.stages)} | {
        name: f"{cut.crossings_cut} crossings beyond {cut.radius:g} mm cut off, {cut.whole.crossings} left"
        for name, cut in trims.items()
    }


def _strain(formed: Formed) -> dict[str, str]:
    """The largest strain of elastic wires; of those that yield how much longer they are, and what has flowed."""
    longest = f"{100 * formed.max_axial_strain:.3g} %"
    if formed.hardening is None:
        return {"largest strain": f"{longest} by the pull along a wire"}
    share = formed.strain_to_break
    used = "" if share is None else f", {100 * share:.3g} % of the true strain at which it necks"
    flowed = f"{100 * formed.yielded:.3g} % of the wire pieces have yielded"
    return {
        "elongation": f"up to {longest} along a wire{used}",
        "plastic strain": f"up to {100 * formed.max_plastic_strain:.3g} %; {flowed}",
    }


def _springback(gone: Released) -> dict[str, str]:
    """Where the springback comes from, where that is known."""
    if gone.split is None:
        return {}
    let = f", by the rim {gone.split.rim.rms:.3g}" if gone.split.rim.largest else ""
    return {
        "springback": f"{gone.split.total.rms:.3g} mm rms; by the pull {gone.split.membrane.rms:.3g}, by bending "
        f"{gone.split.bending.rms:.3g}{let}, not told apart {gone.split.remainder.rms:.3g}"
    }


def _effort(formed: Formed) -> str:
    strokes = f" in {len(formed.strokes)} strokes" if len(formed.strokes) > 1 else ""
    factored = f", {formed.factorisations} factorisations ({formed.linear_solver})" if formed.factorisations else ""
    return f"{formed.steps} steps{strokes}{factored}, {formed.seconds['total']:.2f} s"


def _stress(formed: Formed) -> str:
    stress, ratio = largest(formed.whole.stress), largest(formed.whole.stress_ratio)
    if stress is None:
        return "not known: the stiffness was given"
    return f"{stress:.4g} MPa" + ("" if ratio is None else f", {ratio:.3g} of the yield strength")
