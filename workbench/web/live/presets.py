"""The rods that the live page begins with: those that it offers, and that of a file or of options, in its own units."""

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from solver import Case, Ends, observe, solve
from solver.problem.dimensionless import fields_held
from solver.problem.errors import DEFAULT_TOLERANCE, InputError, choices
from studies import tenants
from studies.grammar.axes import quantity_of
from studies.language.case_input import CaseInput, field_values, read_case
from studies.language.printed import table_of

from ...stored.case_of_file import open_case
from ...stored.case_solving import solve_one, which_is
from ...words import labels
from ...words.assumptions import assumption, units_sentence
from .. import pages
from . import page_model

OWN = "own"
DEAD_LOADS = ("FZ", "MZ", "M3")
HANDLES = ("FZ", "F3", "E", "EI", "L")  # fields, one of which has the first slider where a study varies none
HIDDEN = ("alpha", "gamma")  # they turn the whole rod; a value of 0 is left out
WITH_WEIGHT = {"inclination": 0.0}  # has a slider where there is weight
# observable -> what is said where it grows, and where it shrinks
FOLLOWS = {
    "turns_around": ("the rod winds further around the cylinder", "the rod winds less far around the cylinder"),
    "height": ("the rod reaches further along the cylinder", "the rod reaches less far along the cylinder"),
    "kappa_max": ("the tightest bend gets tighter", "the tightest bend gets wider"),
    "push_mean": ("the cylinder pushes harder", "the cylinder pushes less hard"),
}
SLIGHT = 1e-3  # of its size, by which an observable changes where the field is doubled: less is not told
ON_WALL = {"friction": 0.0, "sliding": "forward"}  # have one where the cylinder also holds the rod on


@dataclass(frozen=True)
class Preset:
    """A rod to begin with.

    state: a study as plain data, see `page_model.study_of`. spans: of sliders the two ends, or of quantities with
    either sign the greatest size. source: where the values come from, and which are assumed. handle: the field whose
    slider stands first, and sentence: what is said of it.
    """

    name: str
    title: str
    source: str
    state: dict[str, Any]
    spans: dict[str, Any]
    handle: str
    sentence: str


_ROWS = tomllib.loads(pages.read(__package__, "presets.toml"))["preset"]
PRESETS = tuple(Preset(**row) for row in _ROWS if "reading" not in row["state"] or tenants.is_there("studies.paper"))


def own_preset(file: Path | None, options: dict[str, Any], units: dict[str, str]) -> Preset | None:
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
    let_go = {"let_go": True} if rod.study is not None and rod.study.let_go else {}
    varied = {} if rod.study is None else rod.study.variation.dimensions.fields
    rod = _under_dead_loads(rod)
    named = "A rod of the command line's options" if file is None else file.name
    title = named if rod.study is None else rod.study.title
    source = "Your rod" if rod.source == "the options" else f"From {rod.source}"
    words = " ".join(filter(None, (f"{source}.", units_sentence(rod.units), assumption(rod.assumed, HIDDEN))))
    state = _state(rod, title, not options) | let_go
    handle = next(name for name in (*varied, *HANDLES) if name in state["base"])
    ends = {name: (float(min(each)), float(max(each))) for name, each in varied.items() if min(each) < max(each)}
    spans = _spans(rod.case) | ends
    symbol, follows = labels.axis_symbol(handle), _what_follows(state, handle, spans)
    who = f"The study varies {symbol}: raise it a little" if handle in varied else f"Raise {symbol} a little"
    return Preset(OWN, title, words, state, spans, handle, f"{who}, and {follows}.")


def _what_follows(state: dict[str, Any], handle: str, spans: dict[str, Any]) -> str:
    """What the rod of a state does as a field rises a little: of `FOLLOWS` what changes most, relative to its size."""
    try:
        rod = page_model.shape(page_model.study_of(state))
        derived = rod.sol.sensitivity([quantity_of(handle).name], FOLLOWS)
    except InputError:  # of a rod that may leave the cylinder; the page says itself why one is not solved
        return "the rod follows"
    raised = abs(state["base"][handle]) or spans[handle]
    rates = {}
    for name, value in observe(rod.sol, [*FOLLOWS]).items():
        rate = float(derived.observables[name][0]) * raised
        if abs(rate) > SLIGHT * abs(float(value)) > 0:
            rates[name] = rate / float(value)
    if not rates:
        return "the rod hardly changes"
    most = max(rates, key=lambda name: round(abs(rates[name]), 6))
    return FOLLOWS[most][rates[most] < 0]


def _under_dead_loads(rod: CaseInput) -> CaseInput:
    """The rod under the loads and end angles that hold it where its ends are held otherwise. Raises `InputError`."""
    held = () if rod.case.varies or rod.case.leaves else fields_held(rod.case)
    if not held:
        return rod
    sol = solve_one(rod.case, rod.which, DEFAULT_TOLERANCE, "auto", page_model.BETWEEN)
    page_model.check(sol)
    ends = Ends(float(sol.beta[0]), float(sol.beta[-1]), **{name: float(getattr(sol, name)) for name in DEAD_LOADS})
    case = replace(rod.case, given=ends)
    dead = solve(case, stations=page_model.BETWEEN, seed=float(sol.dbeta[0]))
    source = f"{rod.source}, under the loads that hold its {choices(held)}"
    return replace(rod, case=case, source=source, which=which_is(dead), study=None)


def _state(rod: CaseInput, title: str, as_printed: bool) -> dict[str, Any]:
    """The state of `page_model.study_of`; as_printed: values of Table 1 stay as a reading has them."""
    state: dict[str, Any] = {"title": title, "units": rod.units}
    study = rod.study
    if study is not None and study.reading is not None and as_printed:
        printed = {**table_of(study.reading), "side": "outside", **study.base.given, **rod.place}
        return state | {"reading": study.reading, "base": printed}
    if rod.which is not None:
        state["equilibrium"] = rod.which.model_dump(exclude_none=True)
    return state | {"base": _fields(rod.case)}


def _fields(case: Case) -> dict[str, Any]:
    """The fields of a case by name, without those that are None or turn the whole rod by 0."""
    fields = {name: value for name, value in field_values(case).items() if not (name in HIDDEN and value == 0)}
    if case.rod.weight is None:
        return fields
    if case.leaves:
        return WITH_WEIGHT | {name: value for name, value in fields.items() if name not in ON_WALL}
    return WITH_WEIGHT | ON_WALL | fields


def _spans(case: Case) -> dict[str, float | tuple[float, float]]:
    """The greatest size on the slider of a quantity that is 0, from rho, L and the bending stiffness A.

    A length to rho, a force to A/(rho L), a moment to A/sqrt(rho L), a rate to 1/sqrt(rho L): the same rod in other
    units has the same.
    """
    rho, L, A = (float(value) for value in (case.rho, case.rod.L, case.rod.bending_stiffness))
    length = (rho * L) ** 0.5
    size = {(1, 0): rho, (0, 1): A / length**2, (1, 1): A / length, "rad/length": 1 / length}
    zero = {name: quantity_of(name).dimension for name, value in _fields(case).items() if value == 0}
    return {name: size[dimension] for name, dimension in zero.items() if dimension in size}
