"""From a Case to the text of a case file with every key in it and every unit written out."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from punchform.case.places import quoted
from punchform.case.whole import SECTIONS, Case
from punchform.case.wire import MATERIAL

_WIDTH = 100


def write_case(case: Case) -> str:
    """The resolved case as TOML: defaults, units and the points of files included.

    Reading it back gives an equal Case. Absent keys (None) are left out: TOML has no word for them.
    """
    content = case.model_dump(mode="json", by_alias=True, exclude_none=True)
    parts = [f"schema = {content['schema']}\ntitle = {_value(content['title'])}"]
    if "stages" in content:
        parts[0] += f"\nstages = {_entry(content['stages'])}"
    for name in SECTIONS:
        if name in content:
            if name == "wire" and "stiffness" in content[name]:
                content[name] = {key: value for key, value in content[name].items() if key not in MATERIAL}
            lines = [f"[{name}]"] + [f"{quoted(key)} = {_entry(value)}" for key, value in content[name].items()]
            parts.append("\n".join(lines))
    return "\n\n".join(parts) + "\n"


def _entry(value: Any) -> str:
    """A value on one line, or long lists, those of a table too, with one entry per line."""
    line = _value(value)
    if len(line) <= _WIDTH:
        return line
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{quoted(key)} = {_entry(each)}" for key, each in value.items()) + " }"
    if isinstance(value, list):
        return "[\n" + "".join(f"    {_value(each)},\n" for each in value) + "]"
    return line


def _value(value: Any) -> str:
    if isinstance(value, str):
        # JSON escapes all that TOML wants escaped, but for one control character.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007F")
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{quoted(key)} = {_value(each)}" for key, each in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(each) for each in value) + "]"
    return repr(value)
