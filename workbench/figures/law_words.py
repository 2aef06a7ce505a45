"""A law with numbers in words and symbols, as it stands above its panel."""

import re
from collections.abc import Mapping
from typing import Any

import xarray as xr

from studies.law_kinds import MONOTONE

from ..data import labels

NO_BREAK = "\N{NO-BREAK SPACE}"
LETTERS = {"pi": "π", "bending_stiffness": "EI", "torsional_stiffness": "GJ"}  # as a study names them
LONGEST = 60  # letters of a formula beside a curve


def sentence(ds: xr.Dataset, row: Mapping[str, Any]) -> str:
    """``push in the middle equals FZ²·ρ/(4·EI) within 1 %, along FZ``.

    Parameters
    ----------
    ds
        The dataset of the law.
    row
        A row of `law_verdicts.verdicts`.
    """
    array, axis = ds[row["observable"]], labels.axis_symbol(row["axis"])
    noun, rule, kind = labels.symbol(array), row["rule"], row["kind"]
    if kind == MONOTONE:
        return labels.typeset(f"{labels.long_name(array)} {row['does']} with {axis}")
    if kind == "equals":
        near = f"{100 * rule['relative']:.4g}{NO_BREAK}%" if "relative" in rule else _number(rule["absolute"], array)
        said = f"{noun} equals {formula(ds, rule['formula'], array)} within {near}, along {axis}"
    elif kind == "bounded":
        said = f"{noun} is {bounds(ds, rule, array)}, along {axis}"
    elif kind == "scales":
        said = f"{noun} is a power of {axis}, its exponent {rule['exponent']:.4g} within {rule['within']:.4g}"
    else:
        place = f"{formula(ds, rule['x'], ds[row['axis']])} within {_number(rule['within'], ds[row['axis']])}"
        said = f"{noun} passes {formula(ds, rule['passes'], array)} at {axis} = {place}"
    return labels.typeset(said)


def bounds(ds: xr.Dataset, rule: Mapping[str, Any], array: xr.DataArray) -> str:
    """``at least 0.9 and at most 1``."""
    ends = (("least", "at least"), ("most", "at most"))
    return " and ".join(f"{word} {formula(ds, rule[key], array)}" for key, word in ends if key in rule)


def formula(ds: xr.Dataset, value: Any, array: xr.DataArray) -> str:
    """A formula in symbols, or a number with the unit of a variable; an expression by its own formula, or by its name.

    ``FZ**2*rho/(4*bending_stiffness)`` is ``FZ²·ρ/(4·EI)``. A formula of more than `LONGEST` letters leaves no room for
    the curves: then an expression is named, and any other formula is cut off with "…".
    """
    if not isinstance(value, str):
        return _number(value, array)
    if value in ds and "expression" in ds[value].attrs:
        whole = _in_symbols(ds, str(ds[value].attrs["expression"]))
        return whole if len(whole) <= LONGEST else _symbol(ds, value)
    whole = _in_symbols(ds, value)
    return whole if len(whole) <= LONGEST else f"{whole[: LONGEST - 1].rstrip()}…"


def _in_symbols(ds: xr.Dataset, value: str) -> str:
    text = re.sub(r"[A-Za-z_]\w*", lambda found: _symbol(ds, found[0]), value)
    text = re.sub(r"\*\*\s*(?:\((-?[\d.]+)\)|(-?[\d.]+))", lambda found: _exponent(found[1] or found[2]), text)
    return re.sub(r"\s*\*\s*", "·", text.replace("**", "^"))


def _symbol(ds: xr.Dataset, name: str) -> str:
    if name in LETTERS:
        return LETTERS[name]
    return name.replace("_", " ") if name in ds and "expression" in ds[name].attrs else labels.symbol_of(name)


def _exponent(text: str) -> str:
    """A whole exponent raised, any other after a caret."""
    return text.translate(labels.SUPERSCRIPTS) if "." not in text else f"^{text}".replace("-", "−")


def _number(value: float, array: xr.DataArray) -> str:
    """A number in the unit of a variable's label, which no line ends between."""
    return labels.value(float(value), array).replace(" ", NO_BREAK)
