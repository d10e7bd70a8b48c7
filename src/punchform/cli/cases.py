"""`punchform new` and `schema`: what helps to write a case file."""

from __future__ import annotations

import json
from pathlib import Path

from punchform.case import TEMPLATE, json_schema, packaged_text
from punchform.cli.exits import Exit
from punchform.cli.talk import say
from punchform.cli.voice import Voice
from punchform.errors import InputError


def new(file: str, *, overwrite: bool, voice: Voice) -> Exit:
    """Write the commented starting case. Raises InputError when the file is there already."""
    try:
        with Path(file).open("w" if overwrite else "x", encoding="utf-8", newline="\n") as stream:
            stream.write(packaged_text(TEMPLATE))
    except (FileExistsError, IsADirectoryError):
        if Path(file).is_dir():
            raise InputError.of("is a folder", where=file or "''", hint="give the name of a file") from None
        raise InputError.of(
            "the file is there already", where=file, hint="give --overwrite to replace it, or another name"
        ) from None
    if voice is not Voice.QUIET:
        say(f"wrote {file}; next: punchform form {file} -o results")
    return Exit.DONE


def schema() -> Exit:
    """Print the JSON schema of the case file."""
    print(json.dumps(json_schema(), indent=2, ensure_ascii=False))
    return Exit.DONE
