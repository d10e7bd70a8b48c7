"""The keys of the case file as tables, from the JSON schema that `punchform schema` prints."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from punchform.case.schema import json_schema

Schema = dict[str, Any]
HEAD = ("| key | value | when left out | what it is |", "|---|---|---|---|")
HUGE = 1e5
TINY = 1e-5


def markdown() -> str:
    """One table for the top of the file, one for every section and for every table inside a section."""
    return "\n".join(_Keys(json_schema()).lines())


class _Keys:
    """Walks the schema section by section; a table that several sections share is shown once."""

    def __init__(self, schema: Schema) -> None:
        self.schema = schema
        self.parts: dict[str, Schema] = schema["$defs"]

    def lines(self) -> Iterator[str]:
        yield from ("## The top of the file", "")
        sections = self.schema["properties"]
        yield from self._table(self.schema)
        shown: set[str] = set()
        for key, value in sections.items():
            for name in self._tables_in(value):
                if key != "stages" and name not in shown:
                    yield from self._section(f"`[{key}]`", name, shown, level=2)
        yield from ("## Tables of `stages`", "")
        for name in self._tables_in(sections["stages"]):
            yield from self._section(f"`{_words(name)}`", name, shown, level=3)

    def _section(self, title: str, name: str, shown: set[str], level: int) -> Iterator[str]:
        shown.add(name)
        part = self.parts[name]
        yield from (f"(case-{name.lower()})=", f"{'#' * level} {title}", "")
        yield from (" ".join(_cell(part["description"]).split()), "")
        yield from self._table(part)
        for key, value in part.get("properties", {}).items():
            for inner in self._tables_in(value):
                if inner not in shown:
                    yield from self._section(self._inner_title(key, inner), inner, shown, level=3)
        extra = part.get("additionalProperties")
        if isinstance(extra, dict):
            for inner in self._tables_in(extra):
                if inner not in shown:
                    yield from self._section(f"`{_words(inner)}`", inner, shown, level=3)

    def _inner_title(self, key: str, name: str) -> str:
        properties = self.parts[name].get("properties", {})
        for kind in ("kind", "shape"):
            if kind in properties and "const" in properties[kind]:
                return f'`{key} = {{ {kind} = "{properties[kind]["const"]}" }}`'
        return f"`{key} = {{ {', '.join(list(properties)[:2])} }}`"

    def _table(self, part: Schema) -> Iterator[str]:
        properties = part.get("properties", {})
        if not properties:
            extra = part.get("additionalProperties")
            if isinstance(extra, dict):
                yield from (*HEAD, f'| `"place.of.a.number"` | {self._value(extra)} | | |', "")
            return
        yield from HEAD
        required = part.get("required", [])
        for key, value in properties.items():
            default = "**required**" if key in required else _default(value)
            yield f"| `{key}` | {self._value(value)} | {default} | {_cell(value.get('description', ''))} |"
        yield ""

    def _value(self, value: Schema) -> str:
        """What may stand behind the equals sign, in words."""
        if "$ref" in value:
            name = value["$ref"].rpartition("/")[2]
            return f"[{_shape_of(self.parts[name], name)}](#case-{name.lower()})"
        if "const" in value:
            return f"`{json.dumps(value['const'])}`"
        if "enum" in value:
            return " or ".join(f"`{json.dumps(one)}`" for one in value["enum"])
        choices = [one for one in value.get("anyOf", value.get("oneOf", [])) if one.get("type") != "null"]
        if choices:
            return " or ".join(dict.fromkeys(self._choices(choices)))
        return self._simple(value)

    def _choices(self, choices: list[Schema]) -> Iterator[str]:
        """Each choice in words; a number beside a text with an example is one quantity."""
        example = next((one["examples"][0] for one in choices if "examples" in one), None)
        for one in choices:
            if example is not None and one.get("type") == "number":
                yield _quantity(example, one)
            elif "examples" not in one:
                yield self._value(one)

    def _simple(self, value: Schema) -> str:
        kind = value.get("type")
        if kind == "array":
            return self._list(value)
        if kind == "object":
            extra = value.get("additionalProperties")
            return f"table of {self._value(extra)}" if isinstance(extra, dict) else "table"
        if isinstance(kind, list):
            return "number or text"
        words = {"integer": "whole number", "number": "number", "boolean": "true or false", "string": "text"}
        return words[kind or "string"] + _limits(value)

    def _list(self, value: Schema) -> str:
        entries = value.get("prefixItems")
        if entries and len(entries) > 3:
            return f"{len(entries)} rows of {len(entries[0].get('prefixItems', [0] * 6))} numbers"
        if entries:
            inner = [self._value(one) for one in entries]
            if len(set(inner)) == 1:
                return f"list of {len(inner)}: {inner[0]}"
            return "list of " + ", ".join(inner)
        return f"list of {self._value(value['items'])}"

    def _tables_in(self, value: Schema) -> Iterator[str]:
        """Names of the tables that a value may be, in order."""
        if "$ref" in value:
            yield value["$ref"].rpartition("/")[2]
        for word in ("anyOf", "oneOf", "prefixItems"):
            for one in value.get(word, []):
                yield from self._tables_in(one)
        for word in ("items", "additionalProperties"):
            if isinstance(value.get(word), dict):
                yield from self._tables_in(value[word])


def _shape_of(part: Schema, name: str) -> str:
    properties = part.get("properties", {})
    for kind in ("kind", "shape"):
        if kind in properties and "const" in properties[kind]:
            return f'`{{ {kind} = "{properties[kind]["const"]}" }}`'
    keys = list(properties)
    return f"`{{ {', '.join(keys[:2])} }}`" if 0 < len(keys) <= 2 else f"table ({_words(name)})"


def _quantity(example: str, number: Schema) -> str:
    text = "number" if example.replace(".", "").isdigit() else f'quantity such as `"{example}"`'
    return text + _limits(number)


def _limits(value: Schema) -> str:
    """The limits that say something; the far ones only guard against slips of units."""
    low, high = value.get("minimum"), value.get("maximum")
    above, below = value.get("exclusiveMinimum"), value.get("exclusiveMaximum")
    told = []
    if above is not None:
        told.append(f"more than {above:g}")
    elif low is not None and (abs(low) > TINY or low == 0) and abs(low) < HUGE:
        told.append(f"at least {low:g}")
    if below is not None:
        told.append(f"less than {below:g}")
    elif high is not None and abs(high) < HUGE:
        told.append(f"at most {high:g}")
    if "maxLength" in value:
        told.append(f"at most {value['maxLength']} letters")
    return ", " + " and ".join(told) if told else ""


def _default(value: Schema) -> str:
    default = value.get("default")
    if default is None or isinstance(default, dict) or (isinstance(default, list) and default):
        return ""
    return f"`{json.dumps(default)}`"


def _words(name: str) -> str:
    """HoldFrom -> hold from."""
    apart = "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in name)
    return apart.strip().removesuffix(" case")


def _cell(text: str) -> str:
    """Prose that is safe in a cell of a table: names in double backticks and bars are kept from meaning something."""
    return text.replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*").replace("\n", " ").replace("[", "\\[")
