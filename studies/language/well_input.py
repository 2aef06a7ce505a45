"""The words of drillers for the loads of a pipe in a hole, as the fields of a case."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from solver import Case, InputError, observe, solve
from solver.problem.errors import choices

WELL = ("hole", "wob", "FZ0")  # in place of the inclination and of FZ
OTHERS = {"hole": ("inclination",), "wob": ("FZ", "FZ0", "height"), "FZ0": ("FZ", "wob", "height")}
MOST_STEPS, CLOSE = 12, 1e-8  # of a search for the force at s = L; relative to the loads


def of_a_well(
    values: Mapping[str, Any], known: Mapping[str, Any], make: Callable[[dict[str, Any]], Case]
) -> dict[str, Any]:
    """The values with those of `WELL` replaced by the inclination and FZ.

    s runs down a hole, so that its inclination is 180 degrees less that of the hole, and s = L is the bit. The weight
    on bit is the push at the lower end. Without friction the forces at both ends differ by the weight along the axis;
    with friction the force at s = L is searched by solving the case.

    Parameters
    ----------
    values
        Fields by name, numbers.
    known
        Other fields of the case, which the values replace.
    make
        Makes the case of fields without those of `WELL`.

    Raises
    ------
    InputError
        For a field of `WELL` beside one that it determines, without the length, or of a force that is not reached.
    """
    said = [name for name in WELL if name in values]
    for name in said:
        if beside := [other for other in OTHERS[name] if other in values]:
            raise InputError(f"{name} and {beside[0]} exclude each other: give one of them")
    rest = {name: value for name, value in values.items() if name not in WELL}
    if "hole" in values:
        rest["inclination"] = math.pi - values["hole"]
    if not {"wob", "FZ0"} & {*values}:
        return rest
    case = {**known, **rest}
    if case.get("L") is None:
        raise InputError(f"{choices(said)} needs the length of the rod: give L")
    cosine = math.cos(case.get("inclination") or 0.0)
    along = float(case.get("weight") or 0.0) * float(case["L"]) * cosine
    if "wob" in values and cosine <= 1e-12:  # s = L is the lower end, or no end is
        return rest | {"FZ": -values["wob"]}
    at_start = values["FZ0"] if "FZ0" in values else -values["wob"]
    if not case.get("friction"):
        return rest | {"FZ": at_start + along}
    return rest | {"FZ": _far_force(at_start, at_start + along, lambda force: make(rest | {"FZ": force}))}


def _far_force(at_start: float, first: float, case_of: Callable[[float], Case]) -> float:
    """The force at s = L with which that at s = 0 has a value, by the secant method. Raises `InputError`."""
    none = f"no force at s = L was found with which FZ0 = {at_start:.4g}"

    def excess(force: float) -> float:
        sol = solve(case_of(force), stations=2)
        if not sol.solved:
            raise InputError(f"{none}: with FZ = {force:.4g} {sol.outcome}")
        return float(observe(sol, ["FZ0"])["FZ0"]) - at_start

    force, off = first, excess(first)
    size, slope = abs(at_start) + abs(first) + abs(off), 1.0
    for _ in range(MOST_STEPS):
        if abs(off) <= CLOSE * size:
            return force
        further = force - off / slope
        last, off = off, excess(further)
        slope = (off - last) / (further - force) or 1.0
        force = further
    raise InputError(f"{none}: the last one was FZ = {force:.4g}")
