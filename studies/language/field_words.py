"""Words of drillers and of cable makers for the loads of a rod, as the fields of a case."""

import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from solver import Case, Ends, InputError, observe, solve
from solver.problem.declared_fields import PAIRS, PARTS, WELL, WOUND, rivals

from ..grammar.axes import case_from

START_ONLY = {*PARTS["start"]} - {*PARTS["ends"]}
LEVEL = 1e-12  # a cosine of the inclination that is none
MOST_STEPS, CLOSE = 12, 1e-8  # of a search for the force at s = L; its last step, relative to the loads


def of_a_well(
    values: Mapping[str, Any], known: Mapping[str, Any], make: Callable[[dict[str, Any]], Case] | None
) -> dict[str, Any]:
    """The values with those of `WELL` replaced by the inclination and FZ.

    s runs down a hole, so that its inclination is 180 degrees less that of the hole, and s = L is the bit. The weight
    on bit is the push at the lower end. Without friction the forces at both ends differ by the weight along the axis;
    with friction the force at s = L is searched by solving the case.

    Parameters
    ----------
    values
        Fields by name, numbers or arrays that broadcast.
    known
        Other fields of the case, which the values replace.
    make
        Makes the case of fields without those of `WELL`; None where no case is solved.

    Raises
    ------
    InputError
        For a field of `WELL` beside one that it determines, without the length, or of a force that is not
        reached or that needs a case to be solved.
    """
    said = [name for name in WELL if name in values]
    for name in said:
        if beside := [other for other in rivals(name) if other in values]:
            raise InputError(f"{name} and {beside[0]} exclude each other: give one of them")
    rest = {name: value for name, value in values.items() if name not in WELL}
    if "hole" in values:
        hole = np.asarray(values["hole"])
        allowed = WELL["hole"].range
        if allowed and (wrong := [float(angle) for angle in hole.flat if allowed.excludes(angle)]):
            raise InputError(f"hole must be {allowed.rule}, got {wrong[0]:.4g} rad")
        if {**known, **rest}.get("weight") is None:
            raise InputError("hole matters only for a rod with weight, in fluid: give weight")
        rest["inclination"] = math.pi - values["hole"]
    if not {"wob", "FZ0"} & {*values}:
        return rest
    case, force_given = {**known, **rest}, "wob" if "wob" in values else "FZ0"
    if case.get("L") is None:
        raise InputError(f"{force_given} needs the length of the rod: give L")
    weight, length, theta, rubbed = (
        np.asarray(0.0 if case.get(name) is None else case[name]) for name in ("weight", "L", "inclination", "friction")
    )
    cosine = np.cos(theta)
    if "wob" in values and (cosine <= LEVEL).all():  # s = L is the lower end, or no end is
        return rest | {"FZ": -np.asarray(values["wob"])[()]}
    at_start = np.asarray(values["FZ0"]) if "FZ0" in values else -np.asarray(values["wob"])
    force = at_start + weight * length * cosine
    if "wob" in values:
        force = np.where(cosine <= LEVEL, at_start, force)
    if not rubbed.any():
        return rest | {"FZ": force[()]}
    if make is None or force.ndim:
        raise InputError(
            f"{force_given} is the force at s = 0 here, and with friction that at s = L is found by solving each rod, "
            "which a study does not do: give it FZ, or wob down a hole; workbench solve takes FZ0 of one rod"
        )
    return rest | {"FZ": _far_force(float(at_start), float(force), lambda force: make(rest | {"FZ": force}))}


def _far_force(at_start: float, first: float, case_of: Callable[[float], Case]) -> float:
    """The force at s = L with which that at s = 0 has a value, by the secant method. Raises `InputError`."""
    from scipy.optimize import root_scalar  # only rods with friction load SciPy's search

    none = f"no force at s = L was found with which FZ0 = {at_start:.4g}"

    @cache
    def excess(force: float) -> float:
        sol = solve(case_of(force), stations=2)
        if not sol.solved:
            raise InputError(f"{none}: with FZ = {force:.4g} {sol.outcome}")
        return float(observe(sol, ["FZ0"])["FZ0"]) - at_start

    off = excess(first)
    close = CLOSE * (abs(at_start) + abs(first) + abs(off))
    if abs(off) <= close:
        return first
    search = root_scalar(excess, method="secant", x0=first, x1=first - off, xtol=close, maxiter=MOST_STEPS)
    if not search.converged:
        raise InputError(f"{none}: the last one was FZ = {search.root:.4g}")
    return float(search.root)


def unwound(values: Mapping[str, Any]) -> dict[str, Any]:
    """The values with `WOUND` replaced by the angles and loads of that helix; others as they are.

    values: numbers, or arrays that broadcast. Raises `InputError` for a field of `WOUND` beside one that it determines,
    or without the tension or the lay.
    """
    wound = {name: values[name] for name in WOUND if name in values}
    rest = {name: value for name, value in values.items() if name not in WOUND}
    if not wound:
        return rest
    if missing := [name for name in ("tension", "lay") if name not in wound]:
        raise InputError(f"a rod that is wound needs tension and lay, got no {missing[0]}")
    surplus = [name for name in rest if name in START_ONLY or name in (end for pair in PAIRS for end in pair)]
    if surplus:
        raise InputError(f"tension and lay determine the angles and loads of both ends: omit {surplus[0]}")
    case = case_from(Ends, {**rest, "beta0": 0.0, "betaL": 0.0})
    ends = Ends.helix(case.rod, case.cylinder, **wound)
    return rest | {name: getattr(ends, name) for name in ("beta0", "betaL", "FZ", "MZ", "M3")}
