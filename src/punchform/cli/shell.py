"""`punchform form` of a case without a punch: a gridshell and its folder."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from punchform.case import Case, CaseText, write_case
from punchform.cli.exits import Exit
from punchform.cli.talk import WRITING, Talk
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.export.result import largest
from punchform.export.shell import shell_json, write_shell_tables
from punchform.export.vtp import SHAPE
from punchform.kept import keep
from punchform.report.shell import write_shell_report
from punchform.shell import Shell, form_shell
from punchform.store import CASE, KEPT, NODES, RESULT, WIRES, write_folder


def form_gridshell(source: CaseText, case: Case, output: str, *, overwrite: bool, voice: Voice, as_json: bool) -> Exit:
    """Move the wire ends of a case to their points and write the run folder.

    Raises InputError for a case that makes no gridshell and NoEquilibrium when the solve ends without one.
    """
    with Talk(voice) as talk:
        try:
            done = form_shell(case, observe=talk)
        except InputError as error:
            raise source.placed(error) from None
        talk.begin(WRITING)
        folder = write_shell(done, output, overwrite=overwrite)
    print((folder / RESULT).read_text(encoding="utf-8").rstrip() if as_json else summary(done, folder))
    return Exit.DONE


def write_shell(done: Shell, output: str | Path, *, overwrite: bool = False) -> Path:
    """Write the folder of a gridshell and return its path; see `write_folder` for what it raises.

    case.toml, result.json, nodes.csv, wires.csv, shape.vtp, run.npz, figures and report.html.
    """

    def write(folder: Path) -> None:
        (folder / CASE).write_text(write_case(done.case), encoding="utf-8", newline="\n")
        (folder / RESULT).write_text(shell_json(done), encoding="utf-8", newline="\n")
        write_shell_tables(done, nodes=folder / NODES, wires=folder / WIRES, shape=folder / SHAPE)
        keep(done, folder / KEPT)
        write_shell_report(done, folder)

    return write_folder(output, write, overwrite=overwrite)


def summary(done: Shell, folder: Path) -> str:
    """What a person wants to know first about a gridshell, in a few lines."""
    formed, whole = done.formed, done.formed.whole
    stress = largest(whole.stress)
    facts = {
        "grid": f"{whole.crossings} crossings and ends, {len(whole.family)} wire pieces; {formed.solved_nodes} nodes",
        "outcome": formed.outcome.value,
        "energy": f"{formed.energy:.7g} mJ",
        "effort": f"{formed.steps} steps, {done.seconds:.2f} s",
        "height": f"{formed.height:.6g} mm above the lowest end",
        "largest reaction": f"{np.linalg.norm(formed.reactions, axis=1).max():.4g} N at one of {len(done.ends)} ends",
        "largest stress": "not known: the stiffness was given" if stress is None else f"{stress:.4g} MPa",
        "report": str(folder / "report.html"),
    }
    width = max(map(len, facts))
    return "\n".join([done.case.title, *(f"  {name:<{width}}  {fact}" for name, fact in facts.items())])
