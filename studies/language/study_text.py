"""The text of a study: TOML read within limits, the line of each key, the sentence of an error; and written.

Written are the keys that were given, without the defaults.
"""

import re
import reprlib
import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np
import tomli_w
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from solver.problem.errors import choices, near

from ..grammar.axes import Axis, Base, Misplaced, Units, Which
from ..laws.verdicts import Law
from .case_tables import Table
from .lattice import Refine
from .model import Study
from .paired import SOURCES
from .samples import Distribution

Where = tuple[str | int, ...]

# Limits far beyond any study, checked before parsing takes time or memory.
MOST_TEXT = 64_000_000  # characters, or bytes of a file
MOST_KEYS = 1000  # of a table, and tables of a list
MOST_PARTS = 20  # of a dotted key
MOST_SAID = 800  # characters of an error message
_MODELS: dict[str, type[BaseModel]] = {
    "units": Units, "base": Base, "axes": Axis, "sample": Distribution, "table": Table, "laws": Law,
    "equilibrium": Which, "refine": Refine,
}  # fmt: skip
_HEADER = re.compile(r"^\s*(\[\[?)([^\[\]]+)\]")
_QUANTITY = re.compile(r"\s*[-+]?\.?\d")
_PART = re.compile(r"""[\w-]+|"[^"]*"|'[^']*'""")
_DEEP_KEY = re.compile(rf"""(?<![\w"'-])(?:[\w"'-]++\s*+\.\s*+){{{MOST_PARTS}}}""")
_REPR = reprlib.Repr()
_REPR.maxlevel, _REPR.maxlist, _REPR.maxdict, _REPR.maxstring, _REPR.maxother = 2, 3, 3, 60, 60
_KEY = re.compile(r"""^\s*((?:[\w-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[\w-]+|"[^"]*"|'[^']*'))*)\s*=""")


class Refused(Exception):
    """The reason why a text is refused. where: the key; of_a_key: whether the message starts after a colon."""

    def __init__(self, message: str, where: Where = (), of_a_key: bool = True) -> None:
        super().__init__(message)
        self.where, self.of_a_key = where, of_a_key


def tables_of(text: str) -> dict[str, Any]:
    """The TOML as dictionaries; refuses a text beyond the limits."""
    if len(text) > MOST_TEXT:
        raise Refused(f"has {len(text)} characters; the limit is {MOST_TEXT}", of_a_key=False)
    if match := _DEEP_KEY.search(text):
        raise Refused(f"has a key of more than {MOST_PARTS} parts: {_show(match.group())}", of_a_key=False)
    try:
        data = tomllib.loads(text)
    except RecursionError:
        raise Refused("is nested too deeply for a study", of_a_key=False) from None
    except ValueError as error:  # a TOML error, or Python's for a number of thousands of digits
        raise Refused(f"is not valid TOML: {error}{_repeat(text, str(error))}", of_a_key=False) from None
    tables: list[Any] = [data]
    while tables:
        table = tables.pop()
        inner = table.values() if isinstance(table, dict) else table
        if len(inner) > MOST_KEYS and (isinstance(table, dict) or any(isinstance(entry, dict) for entry in inner)):
            raise Refused(f"has a table of {len(inner)} entries; the limit is {MOST_KEYS}", of_a_key=False)
        tables += [entry for entry in inner if isinstance(entry, (dict, list))]
    return data


def _repeat(text: str, message: str) -> str:
    """The key that is given twice, and the line, if the message of the TOML error is about such a key."""
    if not message.startswith("Cannot overwrite a value"):
        return ""
    lines = text.rstrip().split("\n")
    match = re.search(r"at line (\d+)", message)
    number = int(match.group(1)) if match else len(lines)
    line = lines[number - 1] if number <= len(lines) else ""
    key, header = _KEY.match(line), _HEADER.match(line)
    name = key.group(1) if key else header.group(2) if header else ""
    return f": line {number} gives {f'the key {name.strip()}' if name else 'a key'} again"


def one_line(text: str) -> str:
    """A sentence on one line; characters that cannot be printed are escaped."""
    line = "".join(sign if sign.isprintable() else " " if sign in "\n\t" else repr(sign)[1:-1] for sign in text)
    return line if len(line) <= MOST_SAID else f"{line[: MOST_SAID - 3]}..."


def _show(value: object) -> str:
    """A value, shortened for a message."""
    text = _REPR.repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _keys(model: type[BaseModel]) -> list[str]:
    return [field.alias or name for name, field in model.model_fields.items()]


def sentence_of(error: ValidationError) -> tuple[Where, str]:
    """The key and the sentence of the first error; an unknown key precedes the missing key that it causes."""
    complaints = sorted(error.errors(), key=lambda e: e["type"] != "extra_forbidden")
    first = complaints[0]
    where: Where = first["loc"]
    kind, value = first["type"], first["input"]
    cause = first.get("ctx", {}).get("error")
    if isinstance(cause, Misplaced):
        return (*where, *cause.path), str(cause)
    if cause is not None:
        return where, str(cause)
    if kind == "extra_forbidden":
        model = _MODELS.get(str(where[0]), Study) if len(where) > 1 else Study
        keys = _keys(model)
        inside = f" in {_key_in_words(where[:-1])}" if len(where) > 1 else ""
        return where, f"no key {_show(where[-1])}{inside}{near(where[-1], keys)}; choose from {choices(keys)}"
    if kind == "missing":
        owner = _key_in_words(where[:-1]) if len(where) > 1 else "the study"
        return where[:-1], f"{owner} needs the key {where[-1]!r}"
    if kind == "string_pattern_mismatch":
        return where, f"{_key_in_words(where)} must be letters, digits, - and _ only, got {_show(value)}"
    if kind == "float_type" and isinstance(value, str) and _QUANTITY.match(value):
        alone = "write the number alone; the table units says in which units all numbers are"
        return where, f"{_key_in_words(where)} must be a number without a unit, got {_show(value)}: {alone}"
    said = first["msg"].replace("Input should", "must", 1)
    if kind in ("model_type", "dict_type"):
        said = "must be a table"
    return where, f"{_key_in_words(where)} {said}, got {_show(value)}"


def _key_in_words(where: Where) -> str:
    """``("axes", "E", "count")`` as ``axes.E.count``, ``("laws", 0)`` as ``laws[1]``."""
    text = ""
    for part in where:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def lines_of(text: str) -> dict[Where, int]:
    """Key path -> number of its line; the keys of an inline table have the line of the table."""
    lines: dict[Where, int] = {}
    table: Where = ()
    counts: dict[str, int] = {}
    quoted = ""
    for number, line in enumerate(text.split("\n"), 1):
        if quoted:
            quoted = "" if quoted in line else quoted
            continue
        if header := _HEADER.match(line):
            table = _parts(header.group(2))
            if header.group(1) == "[[":
                name = header.group(2).strip()
                counts[name] = counts.get(name, -1) + 1
                table = (*table, counts[name])
            for n in range(1, len(table) + 1):
                lines.setdefault(table[:n], number)
        elif key := _KEY.match(line):
            path = (*table, *_parts(key.group(1)))
            for n in range(len(table) + 1, len(path) + 1):
                lines.setdefault(path[:n], number)
        for mark in ('"""', "'''"):
            if line.count(mark) % 2:
                quoted = mark
    return lines


def _parts(dotted: str) -> Where:
    return tuple(part.strip("\"'") for part in _PART.findall(dotted))


def line_of(lines: dict[Where, int], where: Where) -> str:
    """``, line 7`` for a key, or for the table that holds it; empty if unknown."""
    for n in range(len(where), 0, -1):
        if where[:n] in lines:
            return f", line {lines[where[:n]]}"
    return ""


def dumps(study: Study, **tables: Mapping[str, Any]) -> str:
    """A TOML text that loads as the same study, with other tables.

    tables: ``axes`` replaces the axes that it names; ``zip``, lists, or ``table`` gives the samples in place of those
    of the study. Comments of the original text are lost.
    """
    other = {*SOURCES} if {*SOURCES} & {*tables} else None
    said = study.model_dump(by_alias=True, exclude_unset=True, exclude_none=True, exclude=other)
    axes = {"axes": {**said["axes"], **tables["axes"]}} if "axes" in tables else {}
    return tomli_w.dumps({**said, **tables, **axes})


def axis_table(values: NDArray[np.float64]) -> dict[str, Any]:
    """The table of an axis with exactly these values, (n,): from, to and count if these reproduce them, else a list."""
    first, last, count = float(values[0]), float(values[-1]), values.size
    if count > 2:
        even = {"from": first, "to": last, "count": count}
        if np.array_equal(np.linspace(first, last, count), values):
            return even
        if first * last > 0 and np.array_equal(np.geomspace(first, last, count), values):
            return {**even, "spacing": "geometric"}
    return {"values": [float(value) for value in values]}
