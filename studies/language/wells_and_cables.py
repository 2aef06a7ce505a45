"""Words of drillers and of cable makers for the loads of a rod, as the fields of a case."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver import Case, Ends, InputError
from solver.fits.start_force import far_force, without_friction
from solver.problem.case_fields import cases_at, values_of, with_field
from solver.problem.declared_fields import PAIRS, PARTS, WELL, WOUND, rivals
from solver.problem.field_values import numbers_in_place

from ..grammar.axes import case_from

START_ONLY = {*PARTS["start"]} - {*PARTS["ends"]}


def of_a_well(values: Mapping[str, Any], known: Mapping[str, Any]) -> dict[str, Any]:
    """The values with those of `WELL` replaced by the inclination and FZ.

    s runs from the hook to the bit at every inclination, that of s being 180 degrees less that of the hole. The weight
    on bit is the push at s = L. The forces at both ends differ by the weight along the axis, here also with friction:
    what friction adds is known with the shape alone (`under_start_force`).

    Parameters
    ----------
    values
        Fields by name, numbers or arrays that broadcast.
    known
        Other fields of the case, which the values replace.

    Raises
    ------
    InputError
        For a field of `WELL` beside one that it determines, FZ0 without the length, and wob of a rod with weight
        without an inclination, which by default would put the bit at its top.
    """
    for name in (name for name in WELL if name in values):
        if beside := [other for other in rivals(name) if other in values]:
            raise InputError(f"{name} and {beside[0]} exclude each other: give one of them")
    rest = {name: value for name, value in values.items() if name not in WELL}
    values = {**values, **numbers_in_place(values)}
    if "hole" in values:
        if {**known, **rest}.get("weight") is None:
            raise InputError("hole matters only for a rod with weight, in fluid: give weight")
        rest["inclination"] = math.pi - values["hole"]
    case = {name: value for name, value in {**known, **rest}.items() if value is not None}
    if "wob" in values:
        if np.any(case.get("weight", 0.0)) and "inclination" not in case:
            raise InputError("wob is the push at the bit, s = L, in a hole: give hole, its inclination (0: vertical)")
        return rest | {"FZ": -np.asarray(values["wob"])[()]}
    if "FZ0" not in values:
        return rest
    if "L" not in case:
        raise InputError("FZ0 needs the length of the rod: give L")
    return rest | {"FZ": without_friction(values["FZ0"], *(case.get(name) for name in ("weight", "L", "inclination")))}


def under_start_force(case: Case, values: Mapping[str, Any], unit: str) -> tuple[Case, NDArray[Any]]:
    """The case with the FZ that gives each rod with friction the force at s = 0 of `WELL`, found by solving it.

    case: with FZ as of `of_a_well`, from which the search begins. values: the fields as they were given, numbers or
    arrays that broadcast to its shape. unit: of forces, in words. Returns also, of its shape, why no FZ was found; ""
    where one was.
    """
    wall, why = case.cylinder, np.full(case.shape, "", dtype=object)
    if "FZ0" not in values or wall.friction is None or not np.any(wall.friction):
        return case, why
    near, rubbed, FZ = np.broadcast_arrays(
        values["FZ0"], wall.friction, np.broadcast_to(values_of(case, "FZ"), case.shape)
    )
    forces = FZ.astype(float)
    for place in zip(*np.nonzero(np.atleast_1d(rubbed != 0)), strict=True):
        at = place if case.shape else ()
        forces[at], why[at] = far_force(cases_at(case, at) if case.shape else case, float(near[at]), unit)
    return with_field(case, "FZ", forces[()]), why


def unwound(values: Mapping[str, Any]) -> dict[str, Any]:
    """The values with `WOUND` replaced by the angles and loads of that helix; others as they are.

    values: numbers, or arrays that broadcast. Raises `InputError` for a field of `WOUND` beside one that it determines,
    or without the tension or the lay.
    """
    rest = {name: value for name, value in values.items() if name not in WOUND}
    if len(rest) == len(values):
        return rest
    surplus = [name for name in rest if name in START_ONLY or name in (end for pair in PAIRS for end in pair)]
    if surplus:
        raise InputError(f"tension and lay determine the angles and loads of both ends: omit {surplus[0]}")
    case = case_from(Ends, {**rest, "beta0": 0.0, "betaL": 0.0})
    ends = Ends.helix(case.rod, case.cylinder, *(values.get(name) for name in WOUND))
    return rest | {name: getattr(ends, name) for name in ("beta0", "betaL", "FZ", "MZ", "M3")}
