"""The JSON schema of study files, by which editors complete keys, explain them and mark errors.

It is that of the model `Study`, with the fields of a case as they are declared. What only the values of several keys
together decide is left to `load`.
"""

from collections.abc import Mapping
from typing import Any

from solver.problem.declared_fields import ALL_FIELDS, CaseField
from solver.problem.quantities import unit_of

from .study import OUTPUTS, Study

DIALECT = "https://json-schema.org/draft/2020-12/schema"
NUMBER = ("number", "string")  # a number, or a text with its unit
WITH_UNIT = {  # the keys of models whose numbers may be such texts
    "Axis": ("values", "from", "to"),
    "Distribution": ("from", "to", "mean", "std"),
    "Which": ("dbeta0", "energy"),
    "Law": ("at",),
}
NOTES = {  # the keys at the top of a study
    "name": "The stored file is NAME.h5; default: the name of this file.",
    "title": "One line of text.",
    "units": "The units of length and of force of all numbers.",
    "reading": "Which of the twelve readings of Table 1 is used; without it no value comes from the table.",
    "base": "The fields of the rod, the cylinder and the start or the ends that are the same in all cases.",
    "let_go": "Whether each rod is solved on a cylinder that holds it on, and is then let go.",
    "equilibrium": "Which equilibrium of an ends problem is taken.",
    "axes": "The fields that vary, with their values; the cases are all combinations.",
    "sample": "Fields that vary together: one drawn value of each for every sample.",
    "zip": "Fields that vary together: lists of equal length.",
    "table": "Fields that vary together: a file with a row for each case.",
    "refine": "Adds cases to the grid of the axes where a watched number changes.",
    "expressions": "Formulas that are stored like observables.",
    "observables": "The observables that are stored, one number a case.",
    "outputs": "The arrays along the rod that are stored.",
    "stations": "The number of points along the rod.",
    "tol": "A case is solved if its estimated error is at most tol times max(1, condition).",
    "method": "auto, or the name of a method.",
    "laws": "What an observable does along an axis, and the sentence that claims it.",
}


def study_schema() -> dict[str, Any]:
    """The JSON schema of study files, draft 2020-12, as a value that `json.dumps` takes."""
    schema = _plain(Study.model_json_schema())
    models, keys = schema["$defs"], schema["properties"]
    for model, names in WITH_UNIT.items():
        for name in names:
            _take_units(models[model]["properties"][name])
    numbers = [name for name, row in ALL_FIELDS.items() if not row.choices]
    models["Base"]["properties"] = {name: _field(row) for name, row in ALL_FIELDS.items()}
    keys["axes"] |= {"additionalProperties": False, "properties": _each(numbers, {"$ref": "#/$defs/Axis"})}
    models["Sample"]["additionalProperties"] = False
    models["Sample"]["properties"] |= _each(numbers, {"$ref": "#/$defs/Distribution"})
    lists = {"type": "array", "items": {"type": [*NUMBER]}, "minItems": 1}
    keys["zip"] |= {"additionalProperties": False, "properties": _each(numbers, lists)}
    formula = {"type": "object", "properties": _each(("formula", "unit"), {"type": "string"})}
    keys["expressions"]["additionalProperties"] = {"anyOf": [{"type": "string"}, formula]}
    keys["outputs"]["items"]["enum"] = [*OUTPUTS]
    for model in models.values():  # without the parameters and examples that are meant for Python
        model["description"] = model["description"].partition("\n\nParameters\n")[0]
    for name, note in NOTES.items():
        keys[name]["description"] = note
    return {"$schema": DIALECT, **schema, "title": "A study of rods on cylinders", "description": "A study file."}


def _each(names: Any, schema: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """The names of fields, with their long names, each with a schema of its own."""
    words = {name: ALL_FIELDS[name].long_name for name in names if name in ALL_FIELDS}
    return {name: {**schema, **({"description": words[name]} if name in words else {})} for name in names}


def _field(row: CaseField) -> dict[str, Any]:
    """The schema of a field: its words, or its range, and its help."""
    said, limits = row.long_name, _limits(row)
    if not row.choices:
        unit = unit_of(row.quantity, {"length": "length", "force": "force"})
        said += f"{row.more} [{unit}]"
    return limits | {"description": "; ".join([said, *([row.rules] if row.rules else [])])}


def _limits(row: CaseField) -> dict[str, Any]:
    """The words of a field, or the type and bounds of a number; one with a unit is judged by `load`."""
    if row.choices:
        return {"enum": [*row.choices]}
    limits: dict[str, Any] = {"type": [*NUMBER]}
    if row.range is not None:
        limits["minimum" if row.range.closed else "exclusiveMinimum"] = row.range.low
        limits |= {"maximum": row.range.high} if row.range.high < float("inf") else {}
    return limits


def _take_units(schema: dict[str, Any]) -> None:
    """Allow texts in place of numbers."""
    for part in (schema, schema.get("items"), schema.get("additionalProperties")):
        if isinstance(part, dict) and part.get("type") == "number":
            part["type"] = [*NUMBER]


def _plain(schema: Any) -> Any:
    """A schema without null, which TOML has not, and without the titles that repeat a key."""
    if isinstance(schema, list):
        return [_plain(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    kept = {key: _plain(value) for key, value in schema.items() if not (key == "default" and value is None)}
    if isinstance(kept.get("title"), str):
        del kept["title"]
    if "anyOf" in kept:
        ways = [way for way in kept.pop("anyOf") if way != {"type": "null"}]
        kept |= ways[0] if len(ways) == 1 else {"anyOf": ways}
    return kept
