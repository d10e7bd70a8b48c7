"""The JSON schema of the case file, for editors that complete and check while one types."""

from __future__ import annotations

from typing import Any

from punchform.case.materials import library
from punchform.case.whole import Case


def json_schema() -> dict[str, Any]:
    """The JSON schema (draft 2020-12) of the case file; every quantity names its unit in its description.

    Pydantic derives it from the models; what their validators accept beyond their types is said here.
    """
    schema = Case.model_json_schema(by_alias=True)
    parts = schema["$defs"]
    schema["required"] = ["schema", *schema["required"]]
    ends = {"required": ["press"], "properties": {"press": {"required": ["ends"]}}}
    schema["oneOf"] = [{"required": ["punch"]}, ends]
    parts["PressCase"]["properties"]["ends"]["anyOf"].insert(0, {"type": "string"})
    for part in parts.values():
        choice = [key for key in ("kind", "shape") if "const" in part.get("properties", {}).get(key, {})]
        part["required"] = [*choice, *part.get("required", [])]
    for name in ("PointsLine", "TableProfile", "TableHardening", "TensileHardening", "FieldPoints", "RadialPoints"):
        parts[name]["required"].remove("points")
        parts[name]["oneOf"] = [{"required": ["points"]}, {"required": ["file"]}]
    parts["CosineLine"]["required"].remove("height")
    objectives = parts["OptimiseCase"]["properties"]["objectives"]
    objectives["items"] = {"anyOf": [{"type": "string"}, objectives["items"]]}
    _one_or_two(parts["GridCase"]["properties"]["step"])
    _number_or_text(parts["PolynomialProfile"]["properties"]["coefficients"])
    _material_or_matrix(parts["WireCase"])
    spread = parts["ScatterCase"]["additionalProperties"]
    parts["ScatterCase"]["additionalProperties"] = {"anyOf": [{"type": ["number", "string"]}, spread]}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _one_or_two(step: dict[str, Any]) -> None:
    pair = {key: step.pop(key) for key in ("type", "prefixItems", "minItems", "maxItems")}
    step["anyOf"] = [*pair["prefixItems"][0]["anyOf"], pair]


def _number_or_text(coefficients: dict[str, Any]) -> None:
    coefficients["items"] = {"type": ["number", "string"]}


def _material_or_matrix(wire: dict[str, Any]) -> None:
    for key in ("diameter", "youngs_modulus"):
        del wire["properties"][key]["default"]
    named = {"type": "string", "enum": list(library())}
    wire["properties"]["material"] |= {"anyOf": [named, {"type": "null"}]}
    paper = {"properties": {"stiffness": {"const": "paper"}}, "required": ["stiffness"]}
    wire["anyOf"] = [
        {"required": ["diameter", "youngs_modulus"]},
        {"required": ["diameter", "material"]},
        {"required": ["diameter", "stiffness"]},
        paper,
    ]
