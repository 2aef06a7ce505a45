"""The keys of a study: names, types, defaults and limits, from the JSON schema of the model that reads them."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from studies import Study

# the tables of a study file -> their model; the first is the file itself
TABLES = {
    "Study": "Keys at the top",
    "Units": "[units]",
    "Base": "[base]",
    "Axis": "[axes.NAME]",
    "Sample": "[sample]",
    "Distribution": "[sample.FIELD]",
    "Table": "[table]",
    "Refine": "[refine]",
    "Which": "[equilibrium]",
    "Law": "[[laws]]",
}
LIMITS = {
    "minimum": "≥ {}",
    "exclusiveMinimum": "> {}",
    "maximum": "≤ {}",
    "exclusiveMaximum": "< {}",
    "minLength": "at least {} characters",
    "maxLength": "at most {} characters",
    "pattern": "matches `{}`",
    "minItems": "at least {} values",
    "maxItems": "at most {} values",
}
WORDS = {"number": "number", "integer": "whole number", "string": "text", "boolean": "true or false", "null": "nothing"}


def write(folder: Path) -> None:
    """Write the page."""
    lines = ["# Reference: keys of a study", "", "Made from the model that reads a study. Any other key is refused."]
    lines += ["[The study file](study-file.md) says what each key means. A study that is read from a file has the name"]
    lines += ["of the file by default.", ""]
    for model, heading in TABLES.items():
        lines += [f"## `{heading}`" if heading.startswith("[") else f"## {heading}", ""]
        lines += ["| key | type | default | limits |", "|---|---|---|---|"]
        lines += ["| " + " | ".join(row) + " |" for row in rows(model)] + [""]
    path = folder / "reference" / "study-keys.md"
    path.write_text("\n".join(lines), encoding="utf-8")


def schema() -> dict[str, Any]:
    """The JSON schema of each model by its name."""
    whole = Study.model_json_schema()
    return {"Study": whole, **whole["$defs"]}


def rows(model: str) -> list[tuple[str, str, str, str]]:
    """Key, type, default and limits of each key of a model."""
    one = schema()[model]
    required = one.get("required", ())
    return [
        (f"`{key}`", _type(field), "required" if key in required else _default(field), _limits(field))
        for key, field in one["properties"].items()
    ]


def _type(field: Mapping[str, Any]) -> str:
    """The type of a key in words."""
    if "anyOf" in field:
        return " or ".join(dict.fromkeys(_type(one) for one in field["anyOf"] if one.get("type") != "null"))
    if "$ref" in field:
        name = field["$ref"].rpartition("/")[2]
        return f"table {_cell(TABLES.get(name, name))}"
    if "enum" in field:
        return " or ".join(f"`{json.dumps(value)}`" for value in field["enum"])
    if "const" in field:
        return f"`{json.dumps(field['const'])}`"
    if field.get("type") == "array":
        return f"list of: {_type(field.get('items', {}))}"
    if field.get("type") == "object":
        values = field.get("additionalProperties")
        return f"table, each value: {_type(values)}" if isinstance(values, dict) else "table"
    return WORDS.get(str(field.get("type")), "any value")


def _default(field: Mapping[str, Any]) -> str:
    if field.get("default") in (None, {}, []) or isinstance(field["default"], dict):
        return "none"
    return f"`{json.dumps(field['default'], ensure_ascii=False)}`"


def _limits(field: Mapping[str, Any]) -> str:
    """The limits of a key, those of its choices included."""
    every = [field, *field.get("anyOf", ())]
    found = [text.format(_cell(str(one[key]))) for one in every for key, text in LIMITS.items() if key in one]
    return ", ".join(dict.fromkeys(found))


def _cell(text: str) -> str:
    return text.replace("|", r"\|")
