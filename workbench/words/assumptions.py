"""What a command or the live page takes for fields that are not given, in a sentence."""

from collections.abc import Collection, Mapping
from typing import Any

UNITS = ("unit of length", "unit of force")  # of which the sentence on units tells


def units_sentence(units: Mapping[str, str], more: str = "") -> str:
    """``Lengths in mm, forces in N.``; more: what is in which unit beside these."""
    return f"Lengths in {units['length']}, forces in {units['force']}{more}."


def assumption(assumed: Mapping[str, Any], hidden: Collection[str] = ()) -> str:
    """``Not given, so assumed: solid, outside, MZ = M3 = 0.``; empty where all fields are given.

    assumed: value by field. hidden: the fields that are not told.
    """
    values = {name: value for name, value in assumed.items() if name not in (*hidden, *UNITS)}
    words = [value for value in values.values() if isinstance(value, str)]
    zeros = [name for name, value in values.items() if value == 0]
    others = [f"{name} = {value:g}" for name, value in values.items() if not isinstance(value, str) and value != 0]
    listed = [*words, *others, *([f"{' = '.join(zeros)} = 0"] if zeros else [])]
    return f"Not given, so assumed: {', '.join(listed)}." if listed else ""
