"""The rods of a figure: one, or those along an axis, at as many stations as its curves and colours need."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.orbits.potential import Loads
from solver.problem.errors import InputError, choices
from studies.grammar.axes import SAMPLE

from ..geometry.centreline import Centreline, advice_to_store, cut
from ..geometry.tube_tolerance import ROUNDING, DrawnCurve
from ..stored.derived_arrays import azimuths_of
from ..stored.stored_study import StoredStudy
from ..words import labels

STATIONS = 1000  # along each rod at least, two for each pixel of a panel
POINTS = 60_000  # of all rods together, which those are tried first have at most
FEW = 3  # values that are not shown are named
READ, SPREAD = 12, 9  # rods of which each is read in a figure; of more, so many are drawn
ROUNDS = 6  # each finds more stations where the round before saw that a curve or a colour needs them
SHADES = 256  # a curve, and so a colour, may be off by one part in so many of its range
LEAST = 1e-300  # above zero


@dataclass(frozen=True, eq=False)
class DrawnRod:
    """One rod.

    name, value: ``E = 5000 N/cm²`` and ``5000``. arrays: s and what was asked for, (n,) each; None where the case is
    not solved. rho, a [length]. caution: as stored. case: the numbers of its case.
    """

    name: str
    value: str
    arrays: Mapping[str, Any] | None
    rho: float
    a: float
    caution: str
    case: StoredStudy

    @property
    def why(self) -> str:
        """Why nothing of the rod is drawn, where it has no arrays."""
        return "solved, without numbers" if bool(self.case["solved"]) else "unsolved"

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        assert self.arrays is not None
        return np.asarray(self.arrays[name], dtype=float)

    @cached_property
    def loads(self) -> Loads:
        """Its loads without dimensions, (1,) each. Raises `InputError` where they are not stored."""
        loads = self.case.arrays.loads
        return Loads(*(np.atleast_1d(load.values) for load in (loads.lam, loads.mu, loads.phi)))

    @property
    def radius(self) -> Any:
        """The distance from the axis [length]: (n,) of a rod that may leave the cylinder, else rho."""
        return self["radius"] if self.arrays is not None and "radius" in self.arrays else self.rho

    def between(self, first: float, last: float, most: int = 400) -> "DrawnRod":
        """The part of a rod between two shares of its length, at so many stations at most."""
        s = self["s"]
        inside = np.flatnonzero((s >= first * s[-1]) & (s <= last * s[-1]))
        kept = inside[np.linspace(0, inside.size - 1, min(most, inside.size)).round().astype(int)]
        assert self.arrays is not None
        return replace(self, arrays={name: np.asarray(array)[kept] for name, array in self.arrays.items()})

    def plane_points(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """To the right and down on the unrolled cylinder: z and rho (alpha - alpha(0)), (n,) each."""
        alpha = self["alpha"]
        return self["z"], self.rho * (alpha - alpha[0])


@dataclass(frozen=True, eq=False)
class DrawnRods:
    """The rods of a figure.

    axis: along which they stand; None for one rod. held: the index of every other axis. notes: what the figure says.
    """

    source: StoredStudy
    axis: str | None
    held: dict[str, int]
    rods: list[DrawnRod]
    notes: list[str]

    @property
    def in_study_order(self) -> list[DrawnRod]:
        """The rods in rising order of their axis, in falling order where the values of the study fall."""
        falls = self.axis is not None and bool((np.diff(self.source[self.axis].values) < 0).all())
        return self.rods[::-1] if falls else self.rods

    @property
    def solved(self) -> list[DrawnRod]:
        """The rods that are solved."""
        return [rod for rod in self.rods if rod.arrays is not None]

    def at(self) -> str:
        """The values at which the other axes are held: ``R = 0.75 cm, F₃ = 10 N``; else nothing."""
        return self.source.equations(self.held)

    def said(self) -> list[str]:
        """A sentence on the values at which the other axes are held, where there are any."""
        of = "The rod" if self.axis is None else f"Rods along {labels.axis_symbol(self.axis)}"
        return [f"{of}: {self.at()}."] if self.at() else []

    def axis_label(self) -> str:
        """The axis with its unit, and the values at which the others are held."""
        return self.at() if self.axis is None else labels.axis_label(self.source[self.axis], held=self.at())


def choose(
    stored: StoredStudy,
    names: Sequence[str],
    axis: str | None = None,
    at: Mapping[str, float] | None = None,
    most: int | None = None,
) -> DrawnRods:
    """The rods along an axis, at most so many, of places spread along it.

    Parameters
    ----------
    stored : StoredStudy
        A stored study; of a refined one its coarse grid.
    names : sequence of str
        Arrays along the rod.
    axis : str, optional
        Default: the first axis of several values that `at` leaves; one rod where it leaves none.
    at : mapping, optional
        The values of other axes; an axis that is not named stays where the laws or Table 1 put it.
    most : int, optional
        Number of rods; default: all up to `READ` of them, of more `SPREAD`.

    Raises
    ------
    InputError
        For an unknown axis or value, an axis whose value is given, and where an array is not stored and the cases
        cannot be solved again.
    """
    stored = stored.coarse()
    at = {stored.axis(name): value for name, value in (at or {}).items()}
    if axis is not None:
        axis = stored.axis(axis)
        if axis in at:
            raise InputError(
                f"a rod is drawn for each value of {axis}, so it takes no value, got {axis} = {at[axis]:.10g}"
            )
    else:
        axis = next((name for name in stored.varied if name not in at), None)
    if axis and most is None:
        most = READ if stored.sizes[axis] <= READ else SPREAD
    cases = stored.places(axis, at, most) if axis else [stored.place(at)]
    held = {name: i for name, i in cases[0].items() if name != axis}
    chosen = stored.select(held | ({axis: [case[axis] for case in cases]} if axis else {}))
    arrays_of, notes = _arrays(chosen, names)
    if axis and len(cases) < stored.sizes[axis]:
        values = "samples" if axis == SAMPLE else f"values of {labels.axis_symbol(axis)}"
        hidden = np.setdiff1d(range(stored.sizes[axis]), [case[axis] for case in cases])
        left = [labels.value(float(stored[axis][i]), stored[axis]) for i in hidden[:FEW]]
        but = f", not {', '.join(left)}" if hidden.size <= FEW else ""
        notes = [f"{len(cases)} of the {stored.sizes[axis]} {values} are shown{but}.", *notes]
    rods = [_rod(chosen.select({axis: i}) if axis else chosen, axis, arrays) for i, arrays in enumerate(arrays_of)]
    if not any(rod.arrays is not None for rod in rods):
        others = "; choose others with --at" if chosen.cases < stored.cases else ""
        raise InputError(f"nothing to draw: none of the chosen cases is solved{others}")
    return DrawnRods(stored, axis, held, rods, notes)


def of_all_cases(stored: StoredStudy, names: Sequence[str]) -> list[DrawnRod]:
    """The rods of all cases of a dataset, in their order; without arrays where one is not solved.

    names: arrays along the rod. Raises `InputError` as `choose` does.
    """
    return [_rod(case, None, arrays) for case, arrays in zip(stored.each(), _arrays(stored, names)[0], strict=True)]


def numbers(stored: StoredStudy, *names: str) -> list[NDArray[np.float64]]:
    """Observables of each case, of the shape of the cases: as stored, else of the cases solved again."""
    from solver import observe

    missing = [name for name in names if name not in stored]
    fresh = observe(stored.at(), missing) if missing else {}
    shape = stored["outcome"].shape
    return [np.broadcast_to(fresh[name] if name in fresh else stored[name].values, shape) for name in names]


def _rod(one: StoredStudy, axis: str | None, arrays: Mapping[str, Any] | None) -> DrawnRod:
    rho, a = float(one["rho"]), float(one["a"])
    caution = str(one["caution"].values) if "caution" in one else ""
    text = labels.value(float(one[axis]), one[axis]) if axis else ""
    name = f"{labels.axis_symbol(axis)} = {text}" if axis else "rod"
    short = text if text.endswith("°") else text.partition(" ")[0]
    return DrawnRod(name, short, arrays, rho, a, caution, one)


def _arrays(some: StoredStudy, names: Sequence[str]) -> tuple[list[dict[str, Any] | None], list[str]]:
    """For each case s and the arrays of these names, None where it is not solved; and what is to be said.

    The cases are solved again at as many stations as the arrays need. Places along rods that may leave the cylinder
    have their radius too; an azimuth on the axis, where there is none, is that of the next place. Raises `InputError`,
    also where the stations are too few.
    """
    names = list(dict.fromkeys([*names, *["radius"] * (some.leaves and "alpha" in names)]))
    count = int(some["outcome"].size)
    stations = int(np.clip(POINTS // count, 200, STATIONS if count > 1 else 4 * STATIONS)) + 1
    finer, reason, drawn, n = some, "", dict[int, list[DrawnCurve]](), 0
    also = ("beta", "alpha", "z", "dbeta", *["contact"] * (some.loads_vary or some.leaves), *["radius"] * some.leaves)
    for _ in range(ROUNDS):
        try:
            finer = some.solve(stations, dict.fromkeys((*names, *also)))
        except InputError as error:
            reason = str(error).rstrip(".")
        try:
            drawn, n = _curves_of(finer, names), finer.sizes.get("u", 0)
        except InputError as error:
            raise InputError(f"{error}, and its cases cannot be solved again: {reason}") from None
        stations = max((curve.stations() for rod in drawn.values() for curve in rod), default=n)
        if reason or stations <= n:
            break
    if stations > n:
        why = f" ({reason})" if reason else ""
        raise InputError(f"{n} stations are too few to draw {choices(names)}{why}: {advice_to_store(stations)}")
    notes = [f"Drawn at the {n} stored stations: {reason}."] if reason else []
    tables = [_cut(drawn[k]) if k in drawn else None for k in range(count)]
    if "alpha" in names:
        tables = [
            row and {**row, "alpha": azimuths_of(case, row)} for case, row in zip(some.each(), tables, strict=True)
        ]
    return tables, notes


def _curves_of(stored: StoredStudy, names: Sequence[str]) -> dict[int, list[DrawnCurve]]:
    """The arrays of the solved rods that have them, by the number of the rod. Raises `InputError`."""
    solved = np.asarray(stored["solved"].values, dtype=bool).ravel()
    known = {k: row for k, row in enumerate(_as_stored(stored, names)) if row is not None and solved[k]}
    allowed = {name: _error_limit(name, [row[name] for row in known.values()], stored) for name in names if known}
    lines = dict[int, Centreline]()
    with suppress(InputError):  # what is stored may give no curve
        lines = {k: case.centreline for k, case in enumerate(stored.each()) if k in known}
    return {
        k: [DrawnCurve(name, row["s"], row[name], allowed[name], lines.get(k)) for name in names]
        for k, row in known.items()
    }


def _cut(rod: Sequence[DrawnCurve]) -> dict[str, Any]:
    """s and the arrays of a rod, where straight lines between them follow its curves."""
    parts = max(curve.parts for curve in rod)
    return {"s": cut(rod[0].s, parts), **{curve.name: curve.between(parts) for curve in rod}}


def _error_limit(name: str, arrays: Sequence[Any], stored: StoredStudy) -> float:
    """By how much a curve may be off: a part of the range of all rods, of angles and z of a turn of the cylinder."""
    low, high = min(float(array.min()) for array in arrays), max(float(array.max()) for array in arrays)
    turn = {"alpha": 2 * np.pi, "gamma": 2 * np.pi, "z": 2 * np.pi * float(stored["rho"].max())}.get(name, np.inf)
    return max(min(high - low, turn) / SHADES, ROUNDING * max(abs(low), abs(high)), LEAST)


def _as_stored(some: StoredStudy, names: Sequence[str]) -> list[dict[str, Any] | None]:
    """The arrays as stored or computed from stored ones, of each case with numbers. Raises `InputError`."""
    if "u" not in some.sizes:
        raise InputError("the dataset does not store arrays along the rod")
    tables = {}
    for name in ("s", *names):
        array = some["s"] if name == "s" else some.array(name)
        if array is None:
            raise InputError(f"the dataset does not store {name}")
        whole = array.broadcast_like(some["outcome"]).transpose(*some.axes, "u")
        tables[name] = whole.values.reshape(-1, some.sizes["u"])
    rows = [{name: table[i] for name, table in tables.items()} for i in range(len(tables["s"]))]
    return [row if all(np.isfinite(array).all() for array in row.values()) else None for row in rows]
