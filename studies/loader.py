"""From a TOML file to a study; what is wrong is told in one sentence: file, line, value and choices."""

import re
import tomllib
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from solver.errors import InputError, choices

from .axes import Axis, Base, Misplaced, Units, Which
from .laws import Law
from .model import Study

SHIPPED = Path(__file__).parent

Where = tuple[str | int, ...]

_MODELS: dict[str, type[BaseModel]] = {"units": Units, "base": Base, "axes": Axis, "laws": Law, "equilibrium": Which}
_HEADER = re.compile(r"^\s*(\[\[?)\s*([^\[\]]+?)\s*\]")
_PART = re.compile(r"""[\w-]+|"[^"]*"|'[^']*'""")
_KEY = re.compile(r"""^\s*((?:[\w-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[\w-]+|"[^"]*"|'[^']*'))*)\s*=""")


def names() -> list[str]:
    """The names of the shipped studies."""
    return sorted(path.stem for path in SHIPPED.glob("*.toml"))


def load(study: str | Path) -> Study:
    """The study of a shipped name or of a TOML file. Raises `InputError`, with the line and the choices."""
    text = str(study)
    path = Path(text)
    if path.suffix != ".toml":
        if text not in names():
            near = _near(text, names())
            raise InputError(f"no study {text!r}{near}; choose from {choices(names())}, or give a .toml file")
        path = SHIPPED / f"{text}.toml"
    try:
        source = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{path} is not a text file in UTF-8") from None
    except OSError as error:
        raise InputError(f"cannot read the study {path}: {error.strerror}") from None
    return loads(source, path.name, default_name=_as_name(path.stem))


def loads(text: str, label: str = "study", default_name: str = "study") -> Study:
    """The study of a TOML text; `label` names it in what is refused. Raises `InputError`."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{label} is not TOML: {error}") from None
    lines = _lines(text)
    data.setdefault("name", default_name)
    try:
        study = Study.model_validate(data)
    except ValidationError as error:
        where, sentence = _sentence(error)
        raise InputError(f"{label}{_line(lines, where)}: {sentence}") from None
    study._text = text
    try:
        study.case()
    except InputError as error:
        raise InputError(f"{label}{_line(lines, _blamed(str(error), study))}: {error}") from None
    return study


def _as_name(stem: str) -> str:
    """A file's stem as a name that a study may have."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", stem).lstrip("_-") or "study"


def _near(name: object, known: Any) -> str:
    close = get_close_matches(str(name), [str(k) for k in known], 1)
    return f", did you mean {close[0]!r}" if close else ""


def _keys(model: type[BaseModel]) -> list[str]:
    return [field.alias or name for name, field in model.model_fields.items()]


def _sentence(error: ValidationError) -> tuple[Where, str]:
    """Where, and one sentence: the first complaint; an unknown key goes before what it leaves missing."""
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
        inside = f" in {_told(where[:-1])}" if len(where) > 1 else ""
        return where, f"no key {where[-1]!r}{inside}{_near(where[-1], keys)}; choose from {choices(keys)}"
    if kind == "missing":
        owner = _told(where[:-1]) if len(where) > 1 else "the study"
        return where[:-1], f"{owner} needs the key {where[-1]!r}"
    if kind == "string_pattern_mismatch":
        return where, f"{_told(where)} must be letters, digits, - and _ only, got {value!r}"
    said = first["msg"].replace("Input should", "must", 1)
    if kind in ("model_type", "dict_type"):
        said = "must be a table"
    shown = repr(value) if len(repr(value)) <= 60 else repr(value)[:57] + "..."
    return where, f"{_told(where)} {said}, got {shown}"


def _told(where: Where) -> str:
    """``("axes", "E", "count")`` as ``axes.E.count``, ``("laws", 0)`` as ``laws[1]``."""
    text = ""
    for part in where:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def _blamed(message: str, study: Study) -> Where:
    """The key that a refusal by the solver is about: ``Rod.E must be ...`` is axes.E or base.E."""
    found = re.match(r"(?:Rod|Cylinder|Start|Ends)\.(\w+)", message)
    field = found.group(1) if found else ""
    return ("axes", field) if field in study.axes else ("base", field)


def _lines(text: str) -> dict[Where, int]:
    """Key path -> number of its line. Keys inside an inline table are not told apart from their table."""
    lines: dict[Where, int] = {}
    table: Where = ()
    counts: dict[str, int] = {}
    quoted = ""
    for number, line in enumerate(text.splitlines(), 1):
        if quoted:
            quoted = "" if quoted in line else quoted
            continue
        if header := _HEADER.match(line):
            table = _parts(header.group(2))
            if header.group(1) == "[[":
                name = header.group(2)
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


def _line(lines: dict[Where, int], where: Where) -> str:
    """``, line 7`` of the key, or of the table it stands in; empty where none is known."""
    for n in range(len(where), 0, -1):
        if where[:n] in lines:
            return f", line {lines[where[:n]]}"
    return ""
