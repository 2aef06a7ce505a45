"""What the command fit prints: values, intervals, which data decide, correlations, other minima, remarks."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from studies.grammar.axes import is_angle

from ..fitting import UNDETERMINED
from . import console, tables

if TYPE_CHECKING:
    from solver.inverse.fit_result import Fit
    from studies.language.case_input import CaseInput

UNITLESS = ("1", "")


def say(found: "Fit", asked: "CaseInput") -> None:
    """Print a fit for people; angles in degrees."""
    where = ", ".join(f"{name} = {_text(name, value)}" for name, value in asked.place.items())
    console.say(f"rod: {asked.source}{f', at {where}' if where else ''}")
    console.say_units(asked.units, asked.assumed)
    if asked.assumed:
        console.say(f"assumed: {', '.join(f'{name} = {value}' for name, value in asked.assumed.items())}")
    console.say("")
    if found.solution is not None:
        _values(found, asked)
        console.say(found.rule)
        console.say("")
        _data(found, asked)
        _pairs(found)
        _minima(found, asked)
    for remark in (*found.remarks, *_shape(found, asked)):
        console.say(f"caution: {remark}")
    count = "" if math.isnan(found.probability) else f", chance of larger residuals {found.probability:.3g}"
    console.say(f"{found.outcome} ({found.solves} solutions, {found.derivatives} with derivatives{count})")


def as_data(found: "Fit", asked: "CaseInput") -> dict[str, Any]:
    """A fit as plain data for --json; angles in rad."""
    from studies.language.case_input import field_values

    groups = list(dict.fromkeys(found.groups))
    return {
        "source": asked.source, "at": asked.place, "assumed": asked.assumed, "units": asked.units,
        "outcome": found.outcome,
        "values": found.values, "intervals": {name: list(ends) for name, ends in found.intervals.items()},
        "rule": found.rule, "covariance": found.covariance.tolist(), "correlation": found.correlation.tolist(),
        "condition": found.condition, "directions": found.directions,
        "shares": {group: found.share_of(group) for group in groups},
        "data": [_datum(found, i) for i in range(len(found.groups))],
        "cost": found.cost, "freedom": found.freedom, "probability": found.probability,
        "minima": [{"values": one.values, "cost": one.cost, "as_good": one.as_good, "at_bound": list(one.at_bound)}
                   for one in found.minima],
        "remarks": list(found.remarks), "caution": " ".join(_shape(found, asked)),
        "solves": found.solves, "derivatives": found.derivatives,
        "case": field_values(found.case),
    }  # fmt: skip


def _shape(found: "Fit", asked: "CaseInput") -> list[str]:
    """The sentence of `solve` on what a real rod could not do."""
    from ..words import cautions

    if found.solution is None:
        return []
    sentence = cautions.said(cautions.of_cases(found.solution, unit=asked.units["length"]))
    return [sentence] if sentence else []


def _datum(found: "Fit", i: int) -> dict[str, Any]:
    return {
        "group": found.groups[i], "measured": float(found.measured[i]), "computed": float(found.computed[i]),
        "residual": float(found.residuals[i]), "shares": {name: float(row[i]) for name, row in found.shares.items()},
    }  # fmt: skip


def _values(found: "Fit", asked: "CaseInput") -> None:
    rows = []
    for name, value in found.values.items():
        low, high = (_number(name, end) for end in found.intervals[name])
        known = "unknown" if math.isnan(low) else UNDETERMINED if math.isinf(high) else f"{low:.6g} to {high:.6g}"
        rows.append([name, _number(name, value), known, _unit(name, asked), _long(name)])
    tables.print_table(["fitted", "value", "95 % interval", "unit", ""], rows)


def _data(found: "Fit", asked: "CaseInput") -> None:
    """A row for each target and each third of the points: how well it is met, and its share in each field."""
    targets = _targets(found)
    rows: list[list[Any]] = []
    for label, group, mine in _groups(found, asked):
        told = [f"{100 * row[mine].sum():.3g} %" if np.isfinite(row).all() else "" for row in found.shares.values()]
        off = f"{math.sqrt(float(np.mean(found.residuals[mine] ** 2))):.3g}"
        if group in targets:
            values = [_number(group, float(v[mine][0])) for v in (found.measured, found.computed)]
            rows.append([label, *values, _unit(group, asked), off, *told])
        else:
            rows.append([label, *([""] * 3 if targets else []), off, *told])
    pair = ["wanted", "fitted", "unit"] if targets else []
    heads = ["datum", *pair, "residual", *(f"share in {name}" for name in found.values)]
    tables.print_table(heads, rows)
    size = "standard deviations" if found.rule.endswith("normal distribution") else "units of the target, or of rho"
    console.say(f"residual: root mean square in {size}; share: of the field's variance, all fields fitted together")
    console.say("")


def _groups(found: "Fit", asked: "CaseInput") -> "list[tuple[str, str, Any]]":
    """A label, the group and which data belong to it: each target, and of each column of the points each third of L."""
    groups, targets, rows = np.array(found.groups), _targets(found), []
    for group in dict.fromkeys(found.groups):
        mine = groups == group
        if group in targets or found.feet is None:
            rows.append((group, group, mine))
            continue
        s, L = found.feet[0], float(found.case.rod.L)
        third = np.minimum(3 * s // L, 2)
        for k in range(3):
            some = mine.copy()
            some[mine] = third == k
            if some.any():
                until = f"{(k + 1) * L / 3:.3g} {asked.units['length']}"
                rows.append((f"{group}, {some.sum()} points to s = {until}", group, some))
    return rows


def _targets(found: "Fit") -> set[str]:
    from solver.observe.observables import OBSERVABLES

    return set(found.groups) & set(OBSERVABLES)


def _pairs(found: "Fit") -> None:
    names = list(found.values)
    pairs = [(i, j) for i in range(len(names)) for j in range(i)]
    known = [(i, j) for i, j in pairs if math.isfinite(found.correlation[i, j])]
    if known:
        told = ", ".join(f"{names[j]} and {names[i]} {found.correlation[i, j]:+.3f}" for i, j in known)
        console.say(f"correlation of {told}; condition number {found.condition:.3g}")


def _minima(found: "Fit", asked: "CaseInput") -> None:
    if not found.minima:
        return
    names = list(found.values)
    rows = [
        [
            _sum(found, one.cost),
            *(f"{_number(n, one.values[n]):.6g}{' (bound)' if n in one.at_bound else ''}" for n in names),
            "yes" if one.as_good == found.exact else "no",
        ]
        for one in found.minima
    ]
    heads = [f"{name} ({_unit(name, asked)})" if _unit(name, asked) else name for name in names]
    console.say("")
    judged = f"reaches the {_goal(found)}" if found.exact else "excluded by the data"
    tables.print_table(["sum of squares", *heads, judged], rows, title="other minima")
    console.say(f"sum of squares of the fit: {_sum(found, found.cost)}")


def _goal(found: "Fit") -> str:
    """What an exact fit has to reach."""
    return "data" if found.feet is not None else "target" if len(found.groups) == 1 else "targets"


def _sum(found: "Fit", cost: float) -> str:
    """A sum of squares; 0 where the residuals are rounding."""
    return f"{2 * cost:.4g}" if cost > 1e-20 * len(found.groups) else "0"


def _number(name: str, value: float) -> float:
    """A value as it is printed: an angle in degrees."""
    return math.degrees(value) if is_angle(name) else value


def _text(name: str, value: float) -> str:
    return f"{_number(name, value):.6g}{'deg' if is_angle(name) else ''}"


def _unit(name: str, asked: "CaseInput") -> str:
    from solver.problem.quantities import unit_of
    from studies.grammar.axes import quantity_of

    unit = unit_of(quantity_of(name).name, asked.units)
    return "deg" if unit == "rad" else "" if unit in UNITLESS else unit


def _long(name: str) -> str:
    from studies.grammar.axes import quantity_of

    return quantity_of(name).long_name
