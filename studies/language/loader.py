"""Reads a study from TOML; an error is one sentence with file, line, value and choices; and writes it.

TOML is read within limits. Written are the keys that were given, without the defaults.
"""

import re
import reprlib
import tomllib
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from solver.problem.errors import InputError, choices, near
from solver.problem.field_values import doubt, doubt_size
from solver.problem.notices import kind_of, warn

from ..grammar.axes import NUMBERS, Axis, Base, Misplaced, Units, Values, Which, is_angle
from ..grammar.formulas import tables_in_current_names
from ..laws.judgement import Law
from . import study_checks
from .case_tables import Table
from .refinement import Refine
from .samples import Distribution
from .study import Study
from .study_checks import key_of
from .variation import SOURCES

SHIPPED = Path(__file__).parents[1]

Where = tuple[str | int, ...]

# Limits far beyond any study, checked before parsing takes time or memory.
MOST_TEXT = 64_000_000  # characters, or bytes of a file
MOST_KEYS = 1000  # of a table, and tables of a list
MOST_PARTS = 20  # of a dotted key
MOST_SAID = 800  # characters of an error message
_MODELS: dict[str, type[BaseModel]] = {
    "units": Units,
    "base": Base,
    "axes": Axis,
    "sample": Distribution,
    "table": Table,
    "laws": Law,
    "equilibrium": Which,
    "refine": Refine,
}
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


def names() -> list[str]:
    """The names of the shipped studies.

    Returns
    -------
    list of str
        In alphabetical order.

    Examples
    --------
    >>> from studies import names
    >>> names()[:3]
    ['belt', 'capstan', 'fig6']
    """
    return sorted(study_files())


def study_files() -> dict[str, Path]:
    """The file of each shipped study, by its name."""
    return {path.stem: path for path in SHIPPED.rglob("*.toml")}


def load(study: str | Path, cases: Path | None = None, draw: bool = True) -> Study:
    """The study of a shipped name or of a TOML file.

    Parameters
    ----------
    study : str or Path
        A name of `names`, or a file that ends in .toml.
    cases : Path, optional
        A table of cases in place of that of the study.
    draw : bool
        Whether its samples are drawn and its cases validated.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        For an unknown name, a file that cannot be read, and an invalid study; the message has the line and the choices.

    Examples
    --------
    >>> from studies import load
    >>> study = load("fig7_1_modulus")
    >>> study.title, study.variation.size, list(study.axes)
    ('Fig. 7 (1): the elastic modulus', 9, ['E'])
    """
    text = str(study)
    path = Path(text)
    if path.suffix.lower() != ".toml":
        if path.is_file() or path.suffix == ".h5":
            reads = "stored results are read by the commands check, summary, plot, scene and export"
            raise InputError(f"no study {text!r}: its name does not end in .toml; {reads}")
        if text not in names():
            known = f"choose from {choices(names())}, or give a .toml file"
            if path.is_dir():
                raise InputError(f"{text} is a folder, not a study; {known}")
            raise InputError(f"no study {text!r}{near(text, names())}; {known}")
        path = study_files()[text]
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):  # reading a pipe might never end
            raise InputError(f"{one_line(str(path))} is not a regular file")
        if path.is_file() and path.stat().st_size > MOST_TEXT:
            raise InputError(f"{path} has {path.stat().st_size} bytes; the limit is {MOST_TEXT}")
        source = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{path} is not a text file in UTF-8") from None
    except OSError as error:
        raise InputError(f"cannot read the study {one_line(str(path))}: {error.strerror}") from None
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{one_line(str(path))} is not a file name: {error}") from None
    context = {"folder": path.parent, "cases": cases, "draw": draw}
    name = re.sub(r"[^A-Za-z0-9_-]+", "_", path.stem).lstrip("_-") or "study"
    return loads(source, path.name, name, context)


def loads(
    text: str, label: str = "study", default_name: str = "study", context: Mapping[str, Any] | None = None
) -> Study:
    """The study of a TOML text.

    Parameters
    ----------
    text, label, default_name : str
        The text, its name in error messages, and the name of the study where the text has none.
    context : dict, optional
        "samples": a `Dimension`, or None, in place of what the text describes, which is then not read or drawn;
        "folder": that of its table of cases, default: the current one; "cases": a table in place of its own; "draw":
        False leaves the samples undrawn and the cases unchecked.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        With the line, the value and the choices.

    Examples
    --------
    >>> from studies.language.loader import loads
    >>> study = loads('''
    ... title = "One rod"
    ... units = { length = "cm", force = "N" }
    ... base = { E = 1e4, nu = 0.25, a = 0.25, L = 20.0, R = 0.75, beta = "30deg", dbeta = 0.5, M3 = 0.0 }
    ... ''')
    >>> study.variation.size, study.case().rod.L
    (1, 20.0)
    """
    text = text.removeprefix("\N{ZERO WIDTH NO-BREAK SPACE}")  # the byte order mark that some editors write
    try:
        data = tables_of(text)
        study = _study(data, text, default_name, context or {})
    except Refused as error:
        where = line_of(lines_of(text), error.where) if error.where else ""
        raise InputError(one_line(f"{label}{where}{':' if error.of_a_key else ''} {error}")) from None
    samples = study.variation.samples if study.table else None
    for sentence in _notices(data, text, label, samples.fields if samples else None):
        warn(sentence, kind_of(sentence))
    return study


def notices(text: str, label: str = "study") -> list[str]:
    """The notices about the numbers of a study that look as if another unit is meant, with file and line.

    `loads` and `load` issue each as an `AngleWarning` or, of a size, as a `UnitWarning`.
    """
    try:
        return _notices(tables_of(text), text, label)
    except Refused:
        return []


def _notices(data: Mapping[str, Any], text: str, label: str, cases: Mapping[str, Values] | None = None) -> list[str]:
    """The notice about each such number, with its line.

    data: the tables of a valid study, as the file has them. cases: the columns of its table of cases.
    """
    columns = [(("table", name), values[np.abs(values) > np.pi]) for name, values in (cases or {}).items()]
    every = [*_plain_values(data), *columns]
    fields = {str(where[1]) for where, _ in every}
    doubts = [(where, _doubt(str(where[1]), value, data["units"], fields)) for where, value in every]
    said = [(where, sentence) for where, sentence in doubts if sentence]
    lines = lines_of(text) if said else {}
    return [one_line(f"{label}{line_of(lines, where)}: {sentence}") for where, sentence in said]


def _study(given: dict[str, Any], text: str, default_name: str, context: Mapping[str, Any]) -> Study:
    named = {key: given[key] for key in ("expressions", "refine", "observables", "laws") if key in given}
    today = tables_in_current_names(named)
    data = given | today
    data.setdefault("name", default_name)
    cases = context.get("cases")
    if cases is not None:
        table = data.get("table")
        data["table"] = {**(table if isinstance(table, dict) else {}), "file": str(cases.absolute())}
    try:
        study = Study.model_validate(data)
        is_known, folder = "samples" in context, context.get("folder", Path())
        study = study.with_samples(context["samples"] if is_known else study_checks.read_samples(study, folder))
        study_checks.check(study)
    except ValidationError as error:
        where, sentence = sentence_of(error)
        raise Refused(sentence, where) from None
    except Misplaced as error:
        raise Refused(str(error), error.path) from None
    study._text = text if cases is None and today == named else dumps(study)
    if not context.get("draw", True):
        return study
    try:
        _check_ends(study)
        study.case()
    except InputError as error:
        raise Refused(str(error), _blame(str(error), study)) from None
    return study


def _check_ends(study: Study) -> None:
    """Raise `InputError` unless each sampled field is valid at both ends of its distribution, whatever was drawn."""
    if study.sample is None:
        return
    first = {name: values[0] for name, values in study.variation.dimensions.fields.items()}
    for name, distribution in study.sample.fields.items():
        for end in distribution.support:
            try:
                study.case_of({**first, name: end})
            except InputError as error:
                if _field(str(error)) != name:  # of another field, at its first sample
                    continue
                raise InputError(f"{error}; the distribution reaches it: {distribution.reach(name)}") from None


def _blame(message: str, study: Study) -> Where:
    """The key of an error of the solver: ``Rod.E must be ...`` is about axes.E or base.E."""
    field = _field(message)
    if field in study.axes:
        return ("axes", field)
    return key_of(study, field) if field in study.variation.sampled else ("base", field)


def _field(message: str) -> str:
    """The field that an error of the solver is about, or an empty text."""
    match = re.match(r"(?:Rod|Cylinder|Start|Ends)\.(\w+)", message)
    return match.group(1) if match else ""


def _doubt(name: str, value: Any, units: Mapping[str, str], fields: Collection[str]) -> str:
    """The notice about values of one of the fields that may be meant in another unit; empty where none is."""
    return doubt(name, value) if is_angle(name) else doubt_size(name, value, units, fields)


def _plain_values(data: Mapping[str, Any]) -> Iterator[tuple[Where, Any]]:
    """The key of each field, and the values that have no key `unit` beside them."""
    for table in ("base", "zip"):
        for name, value in (data.get(table) or {}).items():
            yield (table, name), value
    for table in ("axes", "sample"):
        for name, value in (data.get(table) or {}).items():
            if isinstance(value, dict) and "unit" not in value:
                yield (table, name), [value[key] for key in NUMBERS if key in value]


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
        keys = [field.alias or name for name, field in model.model_fields.items()]
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
