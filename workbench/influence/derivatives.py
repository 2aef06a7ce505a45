"""Local influence: the exact derivatives of the observables of one case with respect to its fields, made comparable.

The effect of a field is the change of an observable, in percent of its value, for 1 % of the field: the elasticity
(p/O) dO/dp. Of an angle, whose zero is a matter of choice, it is the change for 1 deg; of a field that is 0, the change
for 1 % of the largest field of its unit. The change of an observable that is 0, or an angle, has its own unit.
"""

from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import InputError, Rod, Solution, observe
from solver.observe.observables import OBSERVABLES, is_count, observables_of
from solver.problem.case_fields import check_fields, fields_of, value_of
from solver.problem.errors import no_such
from solver.problem.quantities import current, quantity, unit_of
from studies.grammar.axes import DEFAULT_UNITS

REAL = tuple(name for name, row in OBSERVABLES.items() if not (row.free or is_count(name)))
PERCENT = "%"


def local(
    solution: Solution,
    fields: Iterable[str] | None = None,
    observables: Iterable[str] | None = None,
    units: Mapping[str, str] | None = None,
    gives_FZ0: bool = False,
) -> xr.Dataset:
    """How the observables of one case answer its fields.

    Parameters
    ----------
    solution : Solution
        The solution of one case.
    fields : iterable of str, optional
        Fields of the case, as of `Solution.sensitivity`; `beta` is `beta0`. Default: all.
    observables : iterable of str, optional
        Observables that are no whole numbers. Default: all of them.
    units : mapping, optional
        "length" and "force". Default: cm and N.
    gives_FZ0 : bool
        Whether the force at s = 0 is given in place of FZ, and so stays as other fields change.

    Returns
    -------
    Dataset
        Dimensions observable (O) and field (F).

        derivative: (O, F), in derivative_unit (O, F), 0 where it is below its error. effect: (O, F), the change of the
        observable in effect_unit (O) for the amount (F) of the field; the elasticity where the two are "%" and "1 %".
        1 % more of a negative number is 1 % more of its size. value, error, unit: (O,), of the observables.
        at, field_unit: (F,), of the fields.
        remark: (O,), why a derivative does not exist and is NaN, or an effect: for the amount, up or down, the straight
        line would leave the values that the observable can have; else "".

    Raises
    ------
    InputError
        For several cases, a case that is not solved, an unknown field or observable, or a whole number, whose
        derivative is 0.
    """
    units = DEFAULT_UNITS if units is None else units
    if solution.case.shape:
        raise InputError(f"the influence is that of one case, got {solution.case.size} cases; select one")
    if not solution.solved:
        raise InputError(f"the case has no derivatives, as it is not solved: {solution.outcome}")
    known = {name: value_of(solution.case, name) for name in fields_of(solution.case)}
    if gives_FZ0:
        known = {"FZ0" if name == "FZ" else name: value for name, value in known.items()}
        known["FZ0"] = float(observe(solution, ["FZ0"])["FZ0"])
    names = list(check_fields(solution.case, known if fields is None else fields, known))
    outputs = _observables(solution.case.rod, observables)
    if gives_FZ0:
        by = dict.fromkeys(["FZ" if name == "FZ0" else name for name in [*names, "FZ0"]])
        sensitivity = solution.sensitivity(by, dict.fromkeys([*outputs, "FZ0"])).with_given("FZ0", "FZ")
    else:
        sensitivity = solution.sensitivity(names, outputs)
    if not sensitivity.solved:
        raise InputError(f"the case has no derivatives: {sensitivity.outcome}")
    seen = observe(solution, outputs, errors=True)
    value, error = (np.array([float(seen.get(f"{name}{end}", 0.0)) for name in outputs]) for end in ("", "_error"))
    ds = xr.Dataset(coords={"observable": outputs, "field": names}, attrs={"relative_error": float(sensitivity.error)})
    slopes = [sensitivity.observables[name][: len(names)] for name in outputs]
    ds["derivative"] = ("observable", "field"), np.stack(slopes)
    ds["value"], ds["error"] = ("observable", value), ("observable", error)
    ds["at"] = "field", [known[name] for name in names]
    of_outputs, of_fields = ([unit_of(name, units) for name in listed] for listed in (outputs, names))
    ds["unit"], ds["field_unit"] = ("observable", of_outputs), ("field", of_fields)
    per = [[of if by == "1" else f"{of} per {by}" for by in of_fields] for of in of_outputs]
    ds["derivative_unit"] = ("observable", "field"), per
    ds["remark"] = "observable", [str(sensitivity.remarks[name]) for name in outputs]
    return _with_effects(ds, solution, known, units)


def _with_effects(
    ds: xr.Dataset, solution: Solution, known: Mapping[str, float], units: Mapping[str, str]
) -> xr.Dataset:
    """The table with effect, effect_unit and amount; an effect below the error of the largest one is 0.

    known: the fields of the case and their values.
    """
    steps, amounts = zip(*(_amount(known, name, units) for name in ds["field"].values.tolist()), strict=True)
    parts, shown = [], []
    rows = (ds[key].values.tolist() for key in ("observable", "value", "error", "unit"))
    for name, value, error, unit in zip(*rows, strict=True):
        relative, angle = _has_share(name, value, error), unit == "rad"
        parts.append(value / 100 if relative else np.deg2rad(1.0) if angle else 1.0)
        shown.append(PERCENT if relative else "deg" if angle else unit)
    change = ds["derivative"].values * np.array(steps)
    effect = change / np.array(parts)[:, None]
    size = np.abs(np.nan_to_num(effect))
    is_rounding = size < ds.attrs["relative_error"] * size.max(axis=1, keepdims=True)
    effect[is_rounding] = 0.0
    rooms = np.array([_room(solution, *row) for row in zip(ds["observable"].values, ds["value"].values, strict=True)])
    leaves = (np.abs(change) > rooms[:, None]) & ~is_rounding
    effect[leaves] = np.nan
    remarks = [
        "; ".join(filter(None, (remark, _no_forecast(ds["field"].values[row]))))
        for remark, row in zip(ds["remark"].values.tolist(), leaves, strict=True)
    ]
    return ds.assign(
        derivative=ds["derivative"].where(~is_rounding, 0.0),
        effect=(("observable", "field"), effect),
        effect_unit=("observable", shown),
        amount=("field", list(amounts)),
        remark=("observable", remarks),
    )


def _room(solution: Solution, name: str, value: float) -> float:
    """How far an observable can change in both senses within the values that it can have; inf at an end of them."""
    row = OBSERVABLES[name]
    most = float(solution.case.rod.L) if row.most == "L" else float(row.most)
    room = min(value - row.least, most - value)
    return room if room > 0 else np.inf


def _no_forecast(fields: NDArray[np.str_]) -> str:
    """The sentence on the fields whose effect is none; empty if there is none."""
    if not fields.size:
        return ""
    return f"no forecast for {', '.join(fields)}: the line of the derivative leaves the values that it can have"


def sentences(table: xr.Dataset) -> list[str]:
    """What the table says beside its numbers, one sentence each."""
    fields = dict(zip(table["field"].values.tolist(), table["amount"].values.tolist(), strict=True))
    shown = dict(zip(table["observable"].values.tolist(), table["effect_unit"].values.tolist(), strict=True))
    said = ["Each number is the change of an observable for 1 % of a field, in % of its value: the elasticity."]
    less = [name for name, amount in fields.items() if amount == "1 %" and table["at"].sel(field=name) < 0]
    less += [str(name) for name in table["observable"].values if table["value"].sel(observable=name) < 0]
    if less:
        said.append(f"1 % more of a negative value is 1 % more of its size: {', '.join(less)}.")
    angles = [name for name, amount in fields.items() if amount == "1 deg"]
    if angles:
        are = "is" if len(angles) == 1 else "are"
        said.append(f"The zero of an angle is a choice: {', '.join(angles)} {are} changed by 1 deg.")
    zero = {name: amount for name, amount in fields.items() if amount not in ("1 %", "1 deg")}
    if zero:
        changes = ", ".join(f"{name} by {amount}" for name, amount in zero.items())
        said.append(f"A field that is 0 is changed by 1 % of the largest field of its unit: {changes}.")
    if absolute := ", ".join(f"{name} [{unit}]" for name, unit in shown.items() if unit != PERCENT):
        said.append(f"An observable that is 0, or an angle, changes by an amount and not by a share: {absolute}.")
    if none := without_effect(table):
        said.append(f"No observable here depends on {', '.join(none)}.")
    for name, remark in zip(table["observable"].values, table["remark"].values, strict=True):
        if remark:
            said.append(f"{name}: {remark}.")
    return said


def without_effect(table: xr.Dataset) -> list[str]:
    """The fields on which no observable of the table depends."""
    slopes = np.nan_to_num(table["derivative"].transpose("field", ...).values, nan=1.0)
    return [str(name) for name, row in zip(table["field"].values, slopes, strict=True) if not row.any()]


def counts_left_out(names: Iterable[str]) -> str:
    """The sentence on the whole numbers among the names; empty if there is none."""
    counts = [name for name in names if is_count(name)]
    if not counts:
        return ""
    what = "a whole number, whose derivative is 0" if len(counts) == 1 else "whole numbers, whose derivatives are 0"
    return f"Left out: {', '.join(counts)}, {what}."


def _observables(rod: Rod, names: Iterable[str] | None) -> list[str]:
    if names is None:
        return [name for name in observables_of(rod) if name in REAL]
    observables = list(dict.fromkeys(map(current, names)))
    for name in observables:
        if name not in OBSERVABLES:
            raise no_such("observable", name, REAL)
        if is_count(name):
            raise InputError(f"{name} is a whole number, whose derivative is 0; choose from {', '.join(REAL)}")
    return observables


def _amount(known: Mapping[str, float], name: str, units: Mapping[str, str]) -> tuple[float, str]:
    """The change of a field by which its effects are told, in its unit and in words."""
    kind, value = quantity(name).dimension, known[name]
    if kind == "rad":
        return float(np.deg2rad(1.0)), "1 deg"
    if value:
        return 0.01 * value, "1 %"
    alike = [abs(number) for other, number in known.items() if quantity(other).dimension == kind]
    step, unit = 0.01 * (max(alike) or 1.0), unit_of(name, units)
    return step, f"{step:.3g} {unit}" if unit != "1" else f"{step:.3g}"


def _has_share(name: str, value: float, error: float) -> bool:
    """Whether a percent of an observable means something: not of an angle, nor of a value within its error of 0."""
    return quantity(name).dimension != "rad" and bool(np.isfinite(value)) and abs(value) > (error if error >= 0 else 0)
