"""Numbers, units, symbols and axis labels as text, for diagrams, scenes, the report and the live page."""

import re
from collections.abc import Iterable, Mapping
from math import floor, log10
from typing import Any

import numpy as np
import xarray as xr

from solver.problem.quantities import QUANTITIES
from studies.grammar.axes import SAMPLE, quantity_of

from .unit_habits import distinct_texts, unit_and_size

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MANY_TURNS = 3600.0  # degrees, from which an angle is said in turns
LETTERS = 5  # of a symbol; more are a name
NO_BREAK = "\N{NO-BREAK SPACE}"
STIFFNESSES = {"pi": "π", "bending_stiffness": "EI", "torsional_stiffness": "GJ"}  # as a study names them
LONGEST = 60  # letters of a formula beside a curve
DIGITS = 4  # of the largest number of a column
COUNTS = {"bends": "the number of bends", "loops": "the number of loops"}  # in a sentence; their symbols are plural


def number(value: float, digits: int = 4) -> str:
    """A number with at most that many digits: ``10910``, ``0.625``, ``2e+06``; exponents only where they shorten it."""
    if value == 0 or not abs(value) < float("inf"):
        return f"{value:g}"
    power = floor(log10(abs(value)))
    if not -4 <= power <= 5:
        return f"{value:.{digits}g}"
    text = f"{round(value, digits - 1 - power):.{max(digits - 1 - power, 0)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def alike(values: Iterable[float], digits: int = 4) -> list[str]:
    """Numbers side by side, all with as many digits as the one with most of them, at most so many.

    >>> alike([6.58, 7.197, 0.0])
    ['6.580', '7.197', '0']
    """
    texts = [number(value, digits) for value in values]
    pointed = [text for text in texts if "." in text and "e" not in text]
    most = max((len(re.sub(r"\D", "", text).lstrip("0")) for text in pointed), default=0)

    def in_full(text: str) -> str:
        missing = most - len(re.sub(r"\D", "", text).lstrip("0"))
        plain = missing <= 0 or "e" in text or not any(digit in text for digit in "123456789")
        return text if plain else f"{text}{'' if '.' in text else '.'}{'0' * missing}"

    return [in_full(text) for text in texts]


def column(values: Iterable[float], errors: Iterable[float] = ()) -> list[str]:
    """Numbers one above the other with the same decimals, none beyond the largest of their errors.

    The largest number has four digits, and the least at least one; numbers that differ by more powers of ten have each
    their own.

    >>> column([0.142, 0.0909, 0.0]), column([10.109, 2.803], [0.139, 0.14]), column([15000.0, 0.02])
    (['0.1420', '0.0909', '0'], ['10.1', '2.8'], ['15000', '0.02'])
    """
    values = [*values]
    powers = [floor(log10(abs(value))) for value in values if value and abs(value) < float("inf")]
    if not powers or max(powers) - min(powers) > DIGITS or not -4 <= min(powers) <= max(powers) <= 5:
        return [powers_of_ten(number(value, DIGITS)) for value in values]
    least, places = max(-min(powers), 0), max(DIGITS - 1 - max(powers), -min(powers), 0)
    if error := max((error for error in errors if error < float("inf")), default=0.0):
        places = max(min(places, -floor(log10(error))), least)
    while places > least and all(
        round(value, places) == round(value, places - 1) for value in values if value == value
    ):
        places -= 1
    return [f"{value:.{places}f}" if value else "0" for value in values]


def unit(text: str) -> str:
    """``N/cm^2`` as ``N/cm²``; nothing for a plain number."""
    return "" if text == "1" else text.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")


def is_angle(array: xr.DataArray) -> bool:
    """Whether it is stored in rad; labels and diagrams have angles in degrees."""
    return array.attrs.get("units") == "rad"


def in_label_unit(array: xr.DataArray, values: Any) -> Any:
    """Values of a variable in the unit of its label: degrees for an angle, else the one in which it is stated."""
    return np.degrees(values) if is_angle(array) else np.asarray(values, dtype=float) * _unit_and_size(array)[1]


def value(number_: float, array: xr.DataArray, digits: int = 4) -> str:
    """A value of a variable with its unit: ``10910 N/cm²``, ``15°``, from ten turns on ``79.58 turns``; a number of a
    sample in full."""
    if array.name == SAMPLE:
        return str(int(number_))
    shown, unit_ = float(in_label_unit(array, number_)), f" {_unit_of(array)}"
    if is_angle(array):
        shown, unit_ = (shown / 360, " turns") if abs(shown) >= MANY_TURNS else (shown, "°")
    return f"{powers_of_ten(number(shown, digits))}{unit_}".rstrip().replace("-", "−")


def values_alike(array: xr.DataArray, values: Any) -> list[str]:
    """Values of a variable side by side, as `alike`, each with its unit: ``−616.0 N cm``, ``−699.8 N cm``."""
    unit_ = "°" if is_angle(array) else f" {_unit_of(array)}"
    numbers = alike(in_label_unit(array, values))
    return [f"{powers_of_ten(text)}{unit_}".rstrip().replace("-", "−") for text in numbers]


def level(array: xr.DataArray, low: float, high: float) -> str:
    """A value between two ends that all cases have in common: ``3``; 0 where it lies there: ``0 within 10⁻⁹``."""
    middle, half = (low + high) / 2, (high - low) / 2
    if array.dtype.kind == "f" and low <= 0 <= high and half:
        return f"{value(0.0, array)} within {value(half, array, 1)}"
    return value(middle, array)


def distinct(array: xr.DataArray, values: Any) -> list[str]:
    """Values of a variable with their unit, as `value`, with as many digits as it takes to tell them apart."""
    return distinct_texts(values, lambda number_, digits: value(number_, array, digits), 4)


def axis_symbol(axis: str) -> str:
    """The letter of an axis; `beta` as an axis is the angle at the start."""
    return quantity_of(axis).symbol


def equation(array: xr.DataArray, number_: float, digits: int = 4) -> str:
    """A value of an axis with its letter: ``E = 10910 N/cm²``."""
    return f"{symbol(array)} = {value(number_, array, digits)}"


def axis_label(array: xr.DataArray, long: bool = True, held: str = "") -> str:
    """``Young's modulus  E [N/cm²]``, or with `long=False` ``E [N/cm²]``; angles in degrees.

    held: the values at which other axes are held, which stand behind it.
    """
    symbol_ = symbol(array)
    text = f"{long_name(array)}  " if long and long_name(array) != symbol_ else ""
    return f"{text}{symbol_}{_bracket(array)}" + (f", at {held}" if held else "")


def label(array: xr.DataArray, long: bool = False) -> str:
    """``mean κ [1/cm]``: symbol and unit of a stored variable; angles in degrees.

    long: ``axial force  F_Z [N]``, or without the symbol where that is no more than a shorter name.
    """
    name, letters = long_name(array), symbol(array)
    whole = letters.replace(" ", "\N{NO-BREAK SPACE}")
    is_word = len(letters) > LETTERS or letters in name or bool(re.fullmatch("[a-z]{3,}", letters))
    text = letters if not long else name if is_word else f"{name}  {whole}"
    return f"{text}{_bracket(array)}"


def symbol(array: xr.DataArray) -> str:
    """The symbol of a stored variable; default: its name. The name of an expression in words."""
    text = str(array.attrs.get("symbol", array.name))
    return text.replace("_", " ") if "expression" in array.attrs else text


def symbol_of(name: str) -> str:
    """The symbol of a quantity; of an expression its name."""
    return QUANTITIES[name].symbol if name in QUANTITIES else name


def noun_of(name: str) -> str:
    """A quantity as the subject of a sentence: ``the number of bends``, else its symbol."""
    return COUNTS.get(name) or symbol_of(name)


def long_name(array: xr.DataArray) -> str:
    """The long name of a stored variable, without what stands in brackets."""
    return quantity_name(str(array.attrs.get("long_name", array.name)))


def quantity_name(words: str) -> str:
    """A long name without what stands in brackets, with the symbols of loads: ``M3`` as ``M₃``."""
    return re.sub(r"\b(FZ|MZ|M3)\b", lambda load: axis_symbol(load[0]), typeset(words.partition(" (")[0]))


def sentence(text: str) -> str:
    """A clause as a sentence: ``S`` of a word, but ``s = 0``; a full stop, but after a question or another one.

    >>> sentence("is its unit right?"), sentence("s = 0 is the lower end"), sentence("a rod bends.")
    ('Is its unit right?', 's = 0 is the lower end.', 'A rod bends.')
    """
    return capital(text) if text.endswith(("?", ".")) else f"{capital(text)}."


def capital(text: str) -> str:
    """A text with a capital letter at its beginning, but for a letter of physics: ``s = 0``, ``β rises``."""
    is_letter = (text[1:2] == " " and not re.match("a [a-z]", text)) or not text[:1].isascii()
    return text if is_letter else text[:1].upper() + text[1:]


def typeset(text: str) -> str:
    """Plain text with the letters of physics: ``beta'(0) = -1e-05 rad (5 deg)`` as ``β₀′ = −10⁻⁵ rad (5°)``."""
    for plain, letters in (
        (r"\bbeta'\(0\)", "β₀′"),
        (r"\bbeta'", "β′"),
        (r"\bbeta\b", "β"),
        (r"\bkappa\b", "κ"),
        (r"(?<=\d) deg\b", "°"),
    ):
        text = re.sub(plain, letters, text)
    return minus_signs(powers_of_ten(re.sub(r"(?<=\d)\.\.(?=[-\d])", " to ", text)))


def powers_of_ten(text: str) -> str:
    """The text with powers of ten in print: ``1.3e-05`` as ``1.3·10⁻⁵``, ``1e+06`` as ``10⁶``."""

    def power(match: re.Match[str]) -> str:
        digits, ten = match[1], f"10{str(int(match[2])).translate(SUPERSCRIPTS)}"
        return ten if digits == "1" else f"{digits}·{ten}"

    return re.sub(r"(\([^()]*\)|(?<![\w.])\d+(?:\.\d+)?)e([+-]?\d+)(?!\w)", power, text)


def formula(expressions: Mapping[str, str], text: str | float, array: xr.DataArray) -> str:
    """A formula in symbols, or a number with the unit of a variable; an expression by its own formula, or by its name.

    ``2*pi*sqrt(2*bending_stiffness/abs(FZ))`` is ``2·π·√(2·EI/|FZ|)``. A formula of more than `LONGEST` letters leaves
    no room for the curves: then an expression is named, and any other formula is cut off with "…". expressions: name ->
    formula, as stored.
    """
    if not isinstance(text, str):
        return one_word(text, array)
    whole = _in_symbols(expressions, expressions.get(text, text))
    if len(whole) <= LONGEST:
        return whole
    return _symbol(expressions, text) if text in expressions else f"{whole[: LONGEST - 1].rstrip()}…"


def definitions(expressions: Mapping[str, str], formulas: Iterable[str]) -> list[str]:
    """A sentence on what the expressions are that formulas name, and those that these name; none without any.

    ``pull`` gives ``Here pull = MZ/ρ − EI/ρ².``
    """
    named, left = dict[str, str](), list(formulas)
    while left:
        for name in re.findall(r"[A-Za-z_]\w*", left.pop(0)):
            if name in expressions and name not in named:
                named[name] = f"{_symbol(expressions, name)} = {_in_symbols(expressions, expressions[name])}"
                left.append(expressions[name])
    text = minus_signs(typeset("; ".join(named.values()))).replace("= -", "= −")
    return [f"Here {text}."] if named else []


def _in_symbols(expressions: Mapping[str, str], formula: str) -> str:
    text = re.sub(r"[A-Za-z_]\w*", lambda found: _symbol(expressions, found[0]), formula)
    text = re.sub(r"\babs\(((?:[^()]|\([^()]*\))*)\)", r"|\1|", text).replace("sqrt(", "√(")
    text = re.sub(r"\*\*\s*(?:\((-?[\d.]+)\)|(-?[\d.]+))", lambda found: _exponent(found[1] or found[2]), text)
    return re.sub(r"\s*\*\s*", "·", text.replace("**", "^").replace(" - ", " − "))


def _symbol(expressions: Mapping[str, str], name: str) -> str:
    if name in STIFFNESSES:
        return STIFFNESSES[name]
    if name.endswith("_error"):
        return f"error({_symbol(expressions, name.removesuffix('_error'))})"
    return name.replace("_", " ") if name in expressions else symbol_of(name)


def _exponent(text: str) -> str:
    """A whole exponent raised, any other after a caret."""
    return text.translate(SUPERSCRIPTS) if "." not in text else f"^{text}".replace("-", "−")


def one_word(number_: float, array: xr.DataArray) -> str:
    """A number in the unit of a variable's label, which no line ends between."""
    return value(float(number_), array).replace(" ", NO_BREAK)


def law_text(row: Mapping[str, Any], text: str) -> str:
    """A text about a law (a row of `stored_verdicts.verdicts`), with symbols for names of observables and axes."""
    letters = {law["observable"]: noun_of(law["observable"]) for law in (row, *row.get("also", ()))}
    letters |= {axis: axis_symbol(axis) for axis in (row.get("axis"), *row["at"]) if axis}
    return typeset(re.sub(r"\w+", lambda word: letters.get(word[0], word[0]), text))


def mathematical(text: str) -> str:
    """``FZ²·ρ`` in the mathematical text of Matplotlib, with a low Z; MZ and FY too; ``x^(1/3)`` with a power."""
    text = re.sub(r"(?<![^\W\d_])([FM])([YZ])(?![A-Za-z0-9_])", r"$\1_\2$", text)
    return re.sub(r"\^(\([\w ./·+−]+\)|−?[\d.]*\d|[^\W\d_]+)", r"$^{\\mathregular{\1}}$", text)


def plain(text: str) -> str:
    """The text before `mathematical`."""
    return re.sub(r"\$([FM])_([YZ])\$", r"\1\2", re.sub(r"\$\^\{\\mathregular\{(.*?)\}\}\$", r"^\1", text))


def minus_signs(text: str) -> str:
    """The text with minus signs for hyphens before numbers."""
    return re.sub(r"(?<![\w.])-(?=[\d.])", "−", text)


def tick(value: float, _: object = None) -> str:
    """The number of a tick in full: no offset and no power of ten beside the axis."""
    return minus_signs(powers_of_ten(f"{value:.10g}"))


def power_of_ten(value: float, _: object = None) -> str:
    """The number of a tick on a logarithmic axis: ``10⁻³``; nothing where it is no power of ten."""
    exponent = f"{log10(value):.10g}" if value > 0 else ""
    return f"10{exponent.translate(SUPERSCRIPTS)}" if exponent.lstrip("-").isdigit() else ""


def _unit_and_size(array: xr.DataArray) -> tuple[str, float]:
    return unit_and_size(str(array.attrs.get("units", "1")), str(array.name))


def _unit_of(array: xr.DataArray) -> str:
    return unit(_unit_and_size(array)[0])


def _bracket(array: xr.DataArray) -> str:
    text = "°" if is_angle(array) else _unit_of(array)
    return f" [{text}]" if text else ""
