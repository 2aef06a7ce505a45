"""Accuracy against cost: every method over a ladder of its knob on named cases, as a dataset.

The references of the cases are Taylor series with forty digits (benchmarks/make_trade_references.py), which no method
uses. Tests compare those of the elliptic and the catenary rod with the closed forms.
"""

import json
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib.resources import files
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from solver import Case, Cylinder, Ends, InputError, Rod, Start
from solver.methods import METHODS
from solver.methods.method import Ladder
from solver.problem.errors import choices, no_such

from ..stored import provenance
from .benchmark import STATIONS, BenchmarkReference, BenchmarkRow, available_ladders, cheapest, measure
from .benchmark import ladders as all_ladders

GAPS = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
TWISTS, LOADS = ("force-first", "twist-first", "shear"), ("tension", "compression")
FILE = "trade_references.json"
LEVELS = (1e-3, 1e-6, 1e-9, 1e-12)
NOT_OF_KIND = "not tried: it solves another kind of problem"
LABELS = {
    "seconds": ("s", "time of the whole call, least of the repeats, warm-up not counted"),
    "evaluations": ("1", "evaluations of the equation, those that measure the error among them"),
    "error_beta": ("rad", "largest error of the angle"),
    "error_position": ("1", "largest error of position over the larger of rho and L"),
    "error_contact": ("1", "largest error of contact over its largest size"),
    "error": ("1", "the larger of the errors of angle and position"),
    "estimate": ("1", "the error that the method itself states"),
    "condition": ("1", "the condition number that the method itself states"),
    "drift_h": ("1", "largest change of the first integral h rho^2 along the rod"),
    "drift_FZ": ("1", "largest difference of axial force from its load, over A/rho^2"),
    "drift_MZ": ("1", "largest difference of axial moment from its load, over A/rho"),
}


@dataclass(frozen=True, eq=False)
class Named:
    """A case, its description, and for an ends problem beta'(0) [rad/length] of the equilibrium to compare."""

    case: Case
    about: str
    slope: float | None = None


def in_units_of_rho(lam: float, mu: float, phi: float, span: float, beta0: float, dbeta0: float) -> Case:
    """A start problem from its dimensionless numbers; A = rho = 1 up to rounding."""
    rod, cylinder = _unit(span)
    s, c = np.sin(beta0), np.cos(beta0)
    A, FY = rod.bending_stiffness, lam - mu * c - s**3
    twist = mu * (1 + rod.nu) - s * c
    return Case(rod, cylinder, Start(beta0, dbeta0, F2=A * (phi * s - FY * c), F3=A * (phi * c + FY * s), dgamma=twist))


def ends_in_units_of_rho(lam: float, mu: float, phi: float, span: float, beta0: float, betaL: float) -> Case:
    """An ends problem from its dimensionless numbers; A = rho = 1 up to rounding."""
    rod, cylinder = _unit(span)
    A = rod.bending_stiffness
    return Case(rod, cylinder, Ends(beta0, betaL, FZ=A * phi, MZ=A * lam, M3=A * mu))


def _unit(span: float) -> tuple[Rod, Cylinder]:
    a = 0.25
    return Rod(E=4 / (np.pi * a**4), nu=0.25, a=a, L=span), Cylinder(1 - a)


def table_1(twist: str, load: str, **printed: float) -> Case:
    """The rod of Table 1 of the paper (cm, N), whose twist rate and normal force contradict each other.

    twist: one of `TWISTS`: F1 without the twist rate, the rate without F1, or F1 as shear F2. load: one of `LOADS`, the
    sign of F3. printed: values in place of those of the table.
    """
    p = {"E": 1.07e4, "nu": 0.25, "a": 0.25, "L": 20.0, "R": 0.75} | printed
    shear = {"dgamma": 0.5, "F2": 5.0 if twist == "shear" else 0.0}
    given: dict[str, Any] = {"F1": 5.0} if twist == "force-first" else shear
    start = Start(float(np.pi / 6), 0.5, gamma=-0.1, F3=10.0 if load == "tension" else -10.0, **given)
    return Case(Rod(p["E"], p["nu"], p["a"], p["L"], "paper"), Cylinder(p["R"]), start)


def _cases() -> dict[str, Named]:
    pressed, pulled = partial(table_1, "twist-first", "compression"), partial(table_1, "force-first", "tension")
    b, quarter = float(np.pi / 6), float(np.pi / 4)
    near_saddle = ends_in_units_of_rho(-0.3655, 0.7464, -0.7506, 20.0, b, b)
    FZ, MZ, M3 = pressed().loads
    held = Case(pressed().rod, pressed().cylinder, Ends(b, quarter, FZ, MZ, M3))
    rows: list[tuple[Any, ...]] = [
        *(
            (f"{twist}/{load}", table_1(twist, load), "Table 1, the paper's stiffness")
            for twist, load in product(TWISTS, LOADS)
        ),
        ("elliptic", in_units_of_rho(0, 0, 0, 20.0, b, 0.0), "no load, beta'(0) = 0: exact"),
        ("catenary", in_units_of_rho(0, 0, 0, 20.0, b, float(np.sin(b) ** 2)), "no load, beta is monotonic: exact"),
        *(
            (f"gap {gap:.0e}", in_units_of_rho(0, 0, 1.0, 60.0, gap, 0.0), "beta'(0) = 0, that near to a saddle")
            for gap in GAPS
        ),
        ("long", pulled(L=400.0), "force-first/tension, L = 400 cm"),
        ("stiff", pressed(E=1.07e7), "twist-first/compression, E a thousand times Table 1's"),
        ("soft", pressed(E=107.0), "twist-first/compression, E a hundredth of Table 1's"),
        (
            "ends elliptic",
            ends_in_units_of_rho(0, 0, 0, 20.0, b, 0.524317117841891221),
            "the elliptic rod by its two ends",
            0.0,
        ),
        ("ends table 1", held, "twist-first/compression, 45 degrees at the end", 0.5),
        ("ends stable 1", near_saddle, "stays near a saddle and is stable: beta'(0) = -1.538", -1.53804),
        ("ends stable 2", near_saddle, "stays near a saddle and is stable: beta'(0) = 2.002", 2.00163),
    ]
    return {name: Named(*row) for name, *row in rows}


CASES: dict[str, Named] = _cases()


def choose(names: list[str]) -> dict[str, Named]:
    """The cases with these names or first words (gap, ends); default: all. Raises `InputError` for another name."""
    if not names:
        return CASES
    picked: dict[str, Named] = {}
    for name in names:
        cases = {k: v for k, v in CASES.items() if k == name or k.partition(" ")[0] == name}
        if not cases:
            raise no_such("case", name, CASES)
        picked |= cases
    return picked


@cache
def _references() -> dict[str, Any]:
    return dict(json.loads((files(__package__) / FILE).read_text(encoding="utf-8")))


def reference(name: str) -> BenchmarkReference:
    """The reference of a named case. Raises `InputError` if it has none."""
    rows = _references()
    if name not in rows["cases"]:
        raise InputError(f"no reference for {name!r}: compute it with benchmarks/make_trade_references.py")
    row = rows["cases"][name]
    columns = {column: np.array(row[column]) for column in ("beta", "alpha", "z", "contact")}
    return BenchmarkReference(u=np.array(rows["u"]), condition=row["condition"], **columns)


def rows_of(
    cases: Mapping[str, Named], ladders: Mapping[str, Ladder], step: Callable[[str], None]
) -> Generator[list[BenchmarkRow]]:
    """The measurements of each case in turn, so that an interrupted comparison keeps the cases before.

    Parameters
    ----------
    cases, ladders
        By name; a ladder of the other kind of problem gives no row.
    step
        Called with the name of each case before it is measured.
    """
    for name, entry in cases.items():
        step(name)
        yield measure({name: (entry.case, reference(name), entry.slope)}, ladders)


def check_kinds(cases: Mapping[str, Named], ladders: Mapping[str, Ladder]) -> None:
    """Raise `InputError` if no ladder solves the kind of problem of any case."""
    kinds = {entry.case.kind for entry in cases.values()}
    if not any(kinds & set(METHODS[ladder.method].problems) for ladder in ladders.values()):
        raise InputError(f"no method solves any of the cases: methods {choices(ladders)}; cases {choices(cases)}")


def ladders_of(names: Sequence[str]) -> dict[str, Ladder]:
    """The ladders of these names, or of the methods of these names; default: all that can run here.

    Raises `InputError` for an unknown name, and for a method that is not installed.
    """
    able = available_ladders()
    if not names:
        return able
    picked: dict[str, Ladder] = {}
    for name in names:
        matches = {label: ladder for label, ladder in able.items() if name in (label, ladder.method)}
        if not matches and name in METHODS:
            METHODS[name].with_knobs({})  # says that its package is not installed
        if not matches:
            raise no_such("method", name, all_ladders())
        picked |= matches
    return picked


def as_dataset(rows: Sequence[BenchmarkRow], ladders: Mapping[str, Ladder]) -> xr.Dataset:
    """The measurements, at least one, over (case, ladder, rung); NaN: not tried.

    `knob` (ladder) names the knob of each ladder and `value` (ladder, rung) holds its values.
    """
    cases = list(dict.fromkeys(row.case for row in rows))
    methods = [name for name in ladders if any(row.ladder == name for row in rows)]
    full, shape = ("case", "ladder", "rung"), (len(cases), len(methods), max(len(ladders[m].values) for m in methods))
    numbers = {name: np.full(shape, np.nan) for name in LABELS}
    outcome, answered = np.full(shape, NOT_OF_KIND, dtype=object), np.full(shape, "", dtype=object)
    value = np.full(shape[1:], np.nan)
    for j, name in enumerate(methods):
        count = len(ladders[name].values)
        value[j, :count] = ladders[name].values
        outcome[:, j, count:] = "not tried: the ladder ends before"
    for row in rows:
        at = cases.index(row.case), methods.index(row.ladder), ladders[row.ladder].values.index(row.value)
        outcome[at], answered[at] = row.outcome, row.answered
        for name, values in numbers.items():
            values[at] = getattr(row, name)
    best, seconds = np.full((len(cases), len(LEVELS)), "", dtype=object), np.full((len(cases), len(LEVELS)), np.nan)
    for k, level in enumerate(LEVELS):
        for name, cheap in cheapest(rows, level).items():
            if cheap is not None:
                best[cases.index(name), k], seconds[cases.index(name), k] = cheap.ladder, cheap.seconds
    of_case, of_level = ["case"], ("case", "level")
    words = "growth of a change of the start, of the reference"
    conditions = [reference(name).condition for name in cases]
    data: dict[str, Any] = {
        **{name: (full, numbers[name], {"units": unit, "long_name": text}) for name, (unit, text) in LABELS.items()},
        "outcome": (full, outcome.astype(str), {"long_name": "solved, or why not"}),
        "answered": (full, answered.astype(str), {"long_name": "the method whose answer it is"}),
        "value": (full[1:], value, {"units": "1", "long_name": "value of the knob"}),
        "knob": (["ladder"], [ladders[name].knob for name in methods], {"long_name": "knob turned"}),
        "kind": (of_case, [CASES[name].case.kind for name in cases], {"long_name": "what is given"}),
        "about": (of_case, [CASES[name].about for name in cases], {"long_name": "the case in words"}),
        "reference_condition": (of_case, conditions, {"units": "1", "long_name": words}),
        "cheapest": (of_level, best.astype(str), {"long_name": "the method that reaches the level soonest"}),
        "cheapest_seconds": (of_level, seconds, {"units": "s", "long_name": "time that it takes"}),
    }
    about = {"title": "Accuracy against cost", "study_name": "trade", "reading": "", "laws": "[]", "stations": STATIONS}
    coordinates = {"case": cases, "ladder": methods, "level": list(LEVELS)}
    return xr.Dataset(data, coordinates, about | provenance.provenance(measured=True))


def advice(ds: xr.Dataset) -> list[dict[str, Any]]:
    """For each kind of problem and each level the method that reaches it in the most cases, the fastest of these.

    Rows of kind, level, method (None where none reaches it), reached (cases), cases, and seconds (the median over the
    cases that it reaches). Of two methods that reach as many cases, the one that is faster in the median ratio on the
    cases of both is taken.
    """
    rows = []
    for kind in dict.fromkeys(ds["kind"].values.tolist()):
        of_kind = ds.isel(case=np.flatnonzero(ds["kind"].values == kind))
        good = of_kind["seconds"].where(np.char.startswith(of_kind["outcome"].values.astype(str), "solved"))
        for level in ds["level"].values:
            seconds = good.where(of_kind["error"] <= level).min("rung").transpose("case", "ladder").values
            reached = np.isfinite(seconds).sum(axis=0)
            row = {"kind": str(kind), "level": float(level), "method": None, "reached": 0}
            row |= {"cases": seconds.shape[0], "seconds": None}
            if reached.max(initial=0):
                best = np.flatnonzero(reached == reached.max())
                fastest = np.fmin.reduce(seconds[:, best], axis=1, keepdims=True)
                column = best[np.argmin(np.nanmedian(seconds[:, best] / fastest, axis=0))]
                row |= {
                    "method": str(ds["ladder"].values[column]),
                    "reached": int(reached[column]),
                    "seconds": float(np.nanmedian(seconds[:, column])),
                }
            rows.append(row)
    return rows


def summary_of(ds: xr.Dataset) -> dict[str, Any]:
    """The table of the cheapest methods and the counts of the outcomes of a stored comparison, as plain data."""
    table = [
        {
            "case": str(case),
            "about": str(ds["about"].sel(case=case).item()),
            "cheapest": [
                {
                    "level": float(level),
                    "method": str(ds["cheapest"].sel(case=case, level=level).item()) or None,
                    "seconds": float(ds["cheapest_seconds"].sel(case=case, level=level).item()),
                }
                for level in ds["level"].values
            ],
        }
        for case in ds["case"].values
    ]
    outcomes = ds["outcome"].values.astype(str)
    return {
        "title": str(ds.attrs["title"]),
        "machine": str(ds.attrs["machine"]),
        "cases": [str(case) for case in ds["case"].values],
        "methods": [str(method) for method in ds["ladder"].values],
        "table": table,
        "advice": advice(ds),
        **{word: int(np.char.startswith(outcomes, word).sum()) for word in ("solved", "failed", "not run")},
    }
