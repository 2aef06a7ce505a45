"""The preset of the live page that a file or options give, in its own units."""

from pathlib import Path
from typing import Any

from solver import Case
from studies.grammar.axes import quantity_of
from studies.language.case_input import CaseInput, field_values, read_case
from studies.language.readings import TABLE_1

from ...store.one_case import open_case
from .page_shape import check_shown
from .presets import Preset

NAME = "own"
HIDDEN = ("alpha", "gamma")  # they turn the whole rod; a value of 0 is left out
WITH_WEIGHT = {"inclination": 0.0, "friction": 0.0, "sliding": "forward"}  # have a slider where there is weight


def preset(file: Path | None, options: dict[str, Any], units: dict[str, str]) -> Preset | None:
    """The preset of a study, a stored file or options; None where none is given.

    file: any study by its file or name, or any stored file that holds rods; of several cases one is taken, and `source`
    says which. options: fields of the case, name -> value, which change it or, without a file, say all of it. units: of
    length and force, for a rod of options alone. Raises `InputError`.
    """
    if file is None and not options and not units:
        return None
    if file is None or units:  # which a file excludes
        rod = read_case(file, options, units)
    else:
        rod = open_case(file, options)
    check_shown(rod.case)
    named = "A rod of the command line's options" if file is None else file.name
    title = named if rod.study is None else rod.study.title
    assumed = ", ".join(f"{name} = {value}" for name, value in rod.assumed.items())
    source = f"From {rod.source}.{f' Assumed: {assumed}.' if assumed else ''} {_units(rod)}."
    return Preset(NAME, title, source, _state(rod, title, not options), _spans(rod.case))


def _units(rod: CaseInput) -> str:
    return f"{rod.units['length']} and {rod.units['force']}"


def _state(rod: CaseInput, title: str, as_printed: bool) -> dict[str, Any]:
    """The state of `page_model.study_of`; as_printed: values of Table 1 stay as a reading has them."""
    state: dict[str, Any] = {"title": title, "units": rod.units}
    study = rod.study
    if study is not None and study.reading is not None and as_printed:
        printed = {**TABLE_1, "side": "outside", **study.base.given, **rod.place}
        return state | {"reading": study.reading, "base": printed}
    if rod.which is not None:
        state["equilibrium"] = rod.which.model_dump(exclude_none=True)
    return state | {"base": _fields(rod.case)}


def _fields(case: Case) -> dict[str, Any]:
    """The fields of a case by name, without those that are None or turn the whole rod by 0."""
    fields = {name: value for name, value in field_values(case).items() if not (name in HIDDEN and value == 0)}
    return (WITH_WEIGHT if case.rod.weight is not None else {}) | fields


def _spans(case: Case) -> dict[str, float | tuple[float, float]]:
    """The greatest size on the slider of a quantity that is 0, from rho, L and the bending stiffness A.

    A force to A/(rho L), a moment to A/sqrt(rho L), a rate to 1/sqrt(rho L): the same rod in other units has the same.
    """
    rho, L, A = (float(value) for value in (case.rho, case.rod.L, case.rod.bending_stiffness))
    length = (rho * L) ** 0.5
    size = {(0, 1): A / length**2, (1, 1): A / length, "rad/length": 1 / length}
    zero = {name: quantity_of(name).dimension for name, value in _fields(case).items() if value == 0}
    return {name: size[dimension] for name, dimension in zero.items() if dimension in size}
