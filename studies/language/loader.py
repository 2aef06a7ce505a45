"""Reads a study from TOML; an error is one sentence with file, line, value and choices."""

import re
from collections.abc import Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from solver.problem import angles
from solver.problem.angles import doubt
from solver.problem.errors import InputError, choices, near

from ..grammar.axes import NUMBERS, is_angle
from ..grammar.dimensions import Values
from . import paired
from .model import Study
from .study_text import MOST_TEXT, Refused, Where, dumps, line_of, lines_of, one_line, sentence_of, tables_of

SHIPPED = Path(__file__).parents[1]


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
    ['capstan', 'fig6', 'fig7_1_modulus']
    """
    return sorted(path.stem for path in SHIPPED.glob("*.toml"))


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
    >>> study.title, study.size, list(study.axes)
    ('Fig. 7 (1): the elastic modulus', 9, ['E'])
    """
    text = str(study)
    path = Path(text)
    if path.suffix.lower() != ".toml":
        if path.suffix == ".h5":
            reads = "the commands check, summary, plot, scene and export read it"
            raise InputError(f"no study {text!r}: a file .h5 holds stored results, and {reads}; give a .toml file")
        if text not in names():
            known = f"choose from {choices(names())}, or give a .toml file"
            if path.is_dir():
                raise InputError(f"{text} is a folder, not a study; {known}")
            raise InputError(f"no study {text!r}{near(text, names())}; {known}")
        path = SHIPPED / f"{text}.toml"
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
    return loads(source, path.name, _as_name(path.stem), context)


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
    >>> study.size, study.case().rod.L
    (1, 20.0)
    """
    try:
        data = tables_of(text)
        study = _study(data, text, default_name, context or {})
    except Refused as error:
        where = line_of(lines_of(text), error.where) if error.where else ""
        raise InputError(one_line(f"{label}{where}{':' if error.of_a_key else ''} {error}")) from None
    cases = study.samples.fields if study.table and study.samples else None
    for sentence in _notices(data, text, label, cases):
        angles.warn(sentence)
    return study


def notices(text: str, label: str = "study") -> list[str]:
    """The notices about the numbers of a study that are read in rad but look like degrees, with file and line.

    `loads` and `load` issue each as an `AngleWarning`.
    """
    try:
        return _notices(tables_of(text), text, label)
    except Refused:
        return []


def _notices(data: Mapping[str, Any], text: str, label: str, cases: Mapping[str, Values] | None = None) -> list[str]:
    notices = _doubts(data, cases)
    lines = lines_of(text) if notices else {}
    return [one_line(f"{label}{line_of(lines, where)}: {sentence}") for where, sentence in notices]


def _study(data: dict[str, Any], text: str, default_name: str, context: Mapping[str, Any]) -> Study:
    data.setdefault("name", default_name)
    cases = context.get("cases")
    if cases is not None:
        given = data.get("table")
        data["table"] = {**(given if isinstance(given, dict) else {}), "file": str(cases.absolute())}
    try:
        study = Study.model_validate(data, context=context)
    except ValidationError as error:
        where, sentence = sentence_of(error)
        raise Refused(sentence, where) from None
    study._text = text if cases is None else dumps(study)
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
    first = {name: values[0] for name, values in study.coordinates().items()}
    for name, distribution in study.sample.fields.items():
        for end in distribution.support:
            try:
                study.case_of({**first, name: end})
            except InputError as error:
                if _field(str(error)) != name:  # of another field, at its first sample
                    continue
                raise InputError(f"{error}; the distribution reaches it: {distribution.reach(name)}") from None


def _as_name(stem: str) -> str:
    """The stem of a file as a valid name of a study."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", stem).lstrip("_-") or "study"


def _blame(message: str, study: Study) -> Where:
    """The key of an error of the solver: ``Rod.E must be ...`` is about axes.E or base.E."""
    field = _field(message)
    if field in study.axes:
        return ("axes", field)
    return paired.key(study, field) if field in study.sampled else ("base", field)


def _field(message: str) -> str:
    """The field that an error of the solver is about, or an empty text."""
    match = re.match(r"(?:Rod|Cylinder|Start|Ends)\.(\w+)", message)
    return match.group(1) if match else ""


def _doubts(data: Mapping[str, Any], cases: Mapping[str, Values] | None = None) -> list[tuple[Where, str]]:
    """The key and the notice of each such number.

    data: the tables of a valid study, as the file has them. cases: the columns of its table of cases.
    """
    columns = ((("table", name), values[np.abs(values) > np.pi]) for name, values in (cases or {}).items())
    every = chain(_angles(data), ((where, values) for where, values in columns if is_angle(where[1])))
    said = ((where, doubt(str(where[1]), value)) for where, value in every)
    return [(where, sentence) for where, sentence in said if sentence]


def _angles(data: Mapping[str, Any]) -> Iterator[tuple[Where, Any]]:
    """The key of each angle, and the values that have no key `unit` beside them."""
    for table in ("base", "zip"):
        for name, value in (data.get(table) or {}).items():
            if is_angle(name):
                yield (table, name), value
    for table in ("axes", "sample"):
        for name, value in (data.get(table) or {}).items():
            if is_angle(name) and isinstance(value, dict) and "unit" not in value:
                yield (table, name), [value[key] for key in NUMBERS if key in value]
