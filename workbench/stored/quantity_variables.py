"""The variables of files by the quantities that they are: names, dimensions, units, labels. Needs no xarray."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from solver.observe import observables
from solver.observe.observables import OBSERVABLES
from solver.problem.case import GIVEN, STIFFNESS, fourth_powers
from solver.problem.declared_fields import CHOICES, PARTS
from solver.problem.field_values import is_said
from solver.problem.quantities import quantity, unit_of
from studies.grammar.axes import SAMPLE, WORDS, quantity_of
from studies.grammar.formulas import parse
from studies.language.study import OUTPUTS

if TYPE_CHECKING:
    import xarray as xr

    from solver import Case
    from studies import Study

LOADS = ("FZ", "MZ", "M3")
JUDGED = ("error", "condition")  # how exact the answer of a case is
SECTION = ("E", "nu", "inner_radius", "EI", "GJ")  # the fields of a rod's section: a file stores those that it has
OF_THE_CASE = ("rho", *(name for name in (*PARTS["rod"], *PARTS["cylinder"]) if name not in CHOICES))
COMPONENTS = {"xyz": ("x", "y", "z"), "director": ("d1", "d2", "d3")}
INNER = {"position": ("xyz",)}  # dimensions after u, of an output that is not one number at each station
# The name in the file -> the output. Forces along the rod never take the name of an axis: F1 is the force at the start.
CURVES = {f"{name}_along" if name in ("F1", "F2", "F3") else name: name for name in OUTPUTS}


def curve_name(output: str) -> str:
    """The name in the file of an output along the rod: ``beta``, ``F1_along``."""
    return output if output in CURVES else f"{output}_along"


def dimension(field: str) -> str:
    """The dimension of an axis: the quantity that the study's field is, so that `beta` of a start problem is beta0."""
    return quantity_of(field).name


def inner_shape(output: str) -> tuple[int, ...]:
    """How many numbers an output has at each station, as a shape: () for one."""
    return tuple(len(COMPONENTS[dim]) for dim in INNER.get(output, ()))


def own_dimension(study: "Study", field: str) -> str:
    """The dimension along which a field of the study varies: its own, or that of the samples."""
    return SAMPLE if field in study.variation.sampled else dimension(field)


def field_of(study: "Study", name: str) -> str:
    """The study's field of an axis or quantity that the dataset names; any other name as it is."""
    return next((field for field in study.fields if field not in WORDS and dimension(field) == name), name)


def labels(name: str, units: Mapping[str, str]) -> dict[str, str]:
    """The attributes of a variable of that quantity: units (not of texts and flags), long_name, symbol."""
    row = quantity(name)
    words = {"long_name": row.long_name, "symbol": row.symbol}
    return words if row.dimension == "text" else {"units": unit_of(name, units), **words}


def variables(
    columns: Mapping[str, Any], dims: tuple[str, ...], units: Mapping[str, str], prefix: str = "", words: str = ""
) -> "dict[str, xr.Variable]":
    """Numbers by the names of their quantities as variables over these dimensions, labelled.

    prefix: of their names in the dataset. words: added to their long names.
    """
    import xarray as xr

    variables = {}
    for name, values in columns.items():
        label = labels(name, units)
        label["long_name"] += words
        variables[f"{prefix}{name}"] = xr.Variable(dims, np.asarray(values), label)
    return variables


def numbers_of_case(case: "Case") -> dict[str, Any]:
    """The fields of a case's rod and cylinder that are given, rho, and of rods whose loads vary the azimuth alpha0."""
    owner = {"rho": case, **dict.fromkeys(PARTS["cylinder"], case.cylinder)}
    values = {name: getattr(owner.get(name, case.rod), name) for name in OF_THE_CASE}
    values |= {"alpha0": case.given.alpha} if case.varies else {}
    return {name: value for name, value in values.items() if value is not None}


def attributes_of_case(case: "Case", units: Mapping[str, str]) -> dict[str, str]:
    """The words of a case, and the units of its numbers."""
    words = {name: getattr(case.cylinder if name in PARTS["cylinder"] else case.rod, name) for name in CHOICES}
    words["stiffness"] = case.rod.section
    units = {f"{kind}_unit": units[kind] for kind in ("length", "force")}
    return {name: word for name, word in words.items() if is_said(name, word)} | units


def bending_stiffness(word: str, number: Any) -> Any:
    """A [force length^2]. word: the attribute stiffness. number: what gives a field by its name, as a dataset does."""
    if word == GIVEN:
        return number["EI"]
    return STIFFNESS[word] * number["E"] * fourth_powers(number["a"], number.get("inner_radius"))


def torsional_stiffness(word: str, number: Any) -> Any:
    """C [force length^2]; parameters as of `bending_stiffness`."""
    return number["GJ"] if word == GIVEN else bending_stiffness(word, number) / (1 + number["nu"])


def observables_of(ds: "xr.Dataset") -> list[str]:
    """The observables and expressions that a dataset stores, in their order."""
    stored = [name for name, row in OBSERVABLES.items() if name in ds.data_vars and not row.holds]
    return [*stored, *(str(name) for name in ds.data_vars if "expression" in ds[name].attrs)]


def is_count(array: "xr.DataArray") -> bool:
    """Whether an observable or expression is a whole number. Raises `InputError` for an invalid expression."""
    text = array.attrs.get("expression")
    return observables.is_count(str(array.name)) if text is None else parse(str(text)).whole
