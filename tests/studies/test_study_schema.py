"""The JSON schema of study files allows the shipped studies, and refuses files that are none."""

import re
import tomllib
from typing import Any

import pytest

from solver.problem.declared_fields import ALL_FIELDS
from studies.language.loader import study_files
from studies.language.study import Study
from studies.language.study_schema import NOTES, study_schema

SCHEMA = study_schema()
TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "integer": int, "number": (int, float)}
BOUNDS = {
    "minimum": lambda value, bound: value >= bound,
    "exclusiveMinimum": lambda value, bound: value > bound,
    "maximum": lambda value, bound: value <= bound,
    "exclusiveMaximum": lambda value, bound: value < bound,
}
KNOWN = {
    *BOUNDS, "$ref", "$defs", "$schema", "type", "enum", "anyOf", "properties", "additionalProperties", "required",
    "items", "minItems", "maxLength", "pattern", "description", "default", "title",
}  # fmt: skip
BASE = """
title = "One rod"
units = { length = "cm", force = "N" }
base.R = 0.75
base.beta = "30deg"
base.L = "20 cm"
"""


def wrong(value: Any, schema: dict[str, Any], where: str = "") -> list[str]:
    """The places where a value breaks a schema, by the words of draft 2020-12 that the schema uses."""
    assert not {*schema} - KNOWN
    if "$ref" in schema:
        return wrong(value, SCHEMA["$defs"][schema["$ref"].rpartition("/")[2]], where)
    if "anyOf" in schema:
        return [] if any(not wrong(value, way) for way in schema["anyOf"]) else [where]
    kinds = schema.get("type", [])
    allowed = [TYPES[kind] for kind in ([kinds] if isinstance(kinds, str) else kinds)]
    if allowed and not any(isinstance(value, kind) and isinstance(value, bool) == (kind is bool) for kind in allowed):
        return [where]
    broken = "enum" in schema and value not in schema["enum"]
    if isinstance(value, (int, float)):
        broken |= not all(holds(value, schema[name]) for name, holds in BOUNDS.items() if name in schema)
    if isinstance(value, str):
        broken |= not re.search(schema.get("pattern", ""), value) or len(value) > schema.get("maxLength", len(value))
    places = [where] * broken
    if isinstance(value, list):
        places += [where] * (len(value) < schema.get("minItems", 0))
        places += [place for each in value for place in wrong(each, schema.get("items", {}), f"{where}[]")]
    if isinstance(value, dict):
        places += [f"{where}.{name}" for name in schema.get("required", ()) if name not in value]
        others = schema.get("additionalProperties", True)
        for name, each in value.items():
            part = schema.get("properties", {}).get(name, others)
            if isinstance(part, bool):
                places += [] if part else [f"{where}.{name}"]
            else:
                places += wrong(each, part, f"{where}.{name}")
    return places


@pytest.mark.parametrize("name", study_files())
def test_every_shipped_study_is_valid(name: str) -> None:
    assert wrong(tomllib.loads(study_files()[name].read_text(encoding="utf-8")), SCHEMA) == []


@pytest.mark.parametrize(
    "more, where",
    [
        ("", []),
        ("axes.E.values = [1e4, '2 MPa']", []),
        ("axes.Q.values = [1.0]", [".axes.Q"]),
        ("base.colour = 1", [".base.colour"]),
        ("base.R = -0.75", [".base.R"]),
        ("base.side = 'beside'", [".base.side"]),
        ("stations = 1", [".stations"]),
        ("stations = 'many'", [".stations"]),
        ("outputs = ['push']", [".outputs[]"]),
        ("[[laws]]\nclaim = 'a'", [".laws[].observable", ".laws[].axis", ".laws[].source"]),
    ],
)
def test_a_file_is_refused_for_an_unknown_key_a_wrong_type_and_a_value_out_of_its_range(more: str, where: Any) -> None:
    name = more.partition(" ")[0]
    kept = [line for line in BASE.splitlines() if not line.startswith(f"{name} ")]
    assert wrong(tomllib.loads("\n".join([*kept, more])), SCHEMA) == where


def test_every_key_is_explained_and_every_field_has_its_help() -> None:
    assert {*NOTES} == {*Study.model_fields} == {*SCHEMA["properties"]}
    assert [*SCHEMA["$defs"]["Base"]["properties"]] == [*ALL_FIELDS]
    assert all(row["description"] for row in SCHEMA["$defs"]["Base"]["properties"].values())


def test_the_schema_has_the_range_of_every_field_that_has_one() -> None:
    limits = SCHEMA["$defs"]["Base"]["properties"]
    for name, row in ALL_FIELDS.items():
        if row.range is not None and not row.choices:
            ends = row.range.low, row.range.high
            schema = limits[name]
            assert (schema.get("minimum", schema.get("exclusiveMinimum")), schema.get("maximum", float("inf"))) == ends
