"""What a dataset holds of its cases: axes, units, numbers, and which case a user means. `StoredStudy` adds the rest."""

import contextlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np
import xarray as xr

from solver.observe.observables import OBSERVABLES
from solver.orbits import frames
from solver.problem.declared_fields import FIELDS, VARY_LOADS
from solver.problem.errors import InputError, check_known, choices, near, no_such
from solver.problem.quantities import current
from studies.grammar.axes import SAMPLE
from studies.language.printed import as_reading, table_of
from studies.laws.line_verdicts import NOISE

from ..words import caution_words, labels, outcome_counts
from . import file_kinds, quantity_variables, schema
from .chosen_cases import Value, index, known_cases, spread
from .quantity_variables import COMPONENTS, is_count

NOT_OBSERVED = ("rho", "condition", "dbeta0", "level")  # numbers of each case, not observables
FOUND = ("FZ", "MZ", "M3", "beta0", "betaL")  # observables where they are found of held ends
_ROUNDING = 1e-9  # of the largest: a load that is 0 by symmetry differs by less
PARTS = ("curve", "fold", "special", "shape")  # of a dataset of branches; each may have `<part>_<BACK>`
BACK = "turned_back"
HELD_INDEX = "held_index"  # stored of held ends alone
MOST_ASKED = 12  # observables of one figure
BENDS, NEARLY_STRAIGHT = "bends", np.radians(10)  # bends of a rod whose beta varies by less than that are not shown
WIDE = 3.0  # times the smallest value: a narrower range has a linear scale
IS_TRUE_OR_FALSE = re.compile(r"[<>]|==|!=|\b(and|or|not)\b")  # an expression


def no_such_observable(name: str, known: Sequence[str]) -> InputError:
    """The error that a file has no such observable; of one that a study could have had it says how."""
    why = f"{name} is not stored: a study stores what its `observables` name" if name in OBSERVABLES else ""
    return InputError(f"{why or f'no observable {name!r}{near(name, known)}'}; the file has {choices(known) or 'none'}")


def is_wide(low: float, high: float) -> bool:
    """Whether the larger of two positive values is so many times the smaller that ratios tell more than differences."""
    return bool(low > 0 and high > WIDE * low)


@dataclass(frozen=True, eq=False)
class StoredCases:
    """The cases of a dataset; each property is asked once.

    kept: rods off the wall that were solved again, for all selections of one dataset (`solved_again.solve_once`).
    """

    ds: xr.Dataset
    kept: dict[Any, Any] = field(default_factory=dict, repr=False)

    def __getitem__(self, name: str) -> xr.DataArray:
        """A stored variable. Raises `KeyError`."""
        return self.ds[name]

    def __contains__(self, name: object) -> bool:
        return name in self.ds

    @property
    def attrs(self) -> dict[str, Any]:
        """The attributes of the dataset."""
        return self.ds.attrs

    def data(self, name: str) -> Any:
        """An attribute in JSON as plain data, parsed once."""
        if name not in self._parsed:
            self._parsed[name] = json.loads(self.attrs[name])
        return self._parsed[name]

    @cached_property
    def _parsed(self) -> dict[str, Any]:
        return {}

    @property
    def sizes(self) -> Mapping[str, int]:
        """How many values each dimension has."""
        return {str(name): size for name, size in self.ds.sizes.items()}

    @cached_property
    def expressions(self) -> dict[str, str]:
        """The formulas of its stored expressions, by their names."""
        attrs = {str(name): array.attrs for name, array in self.ds.variables.items()}
        return {name: str(known["expression"]) for name, known in attrs.items() if "expression" in known}

    @property
    def variables(self) -> list[str]:
        """The names of what it stores beside its coordinates."""
        return list(map(str, self.ds.data_vars))

    def with_title(self, title: str) -> Self:
        """These cases under another title."""
        return type(self)(self.ds.assign_attrs(title=title))

    # what it holds

    @cached_property
    def kind(self) -> file_kinds.FileKind:
        """The kind of file that it is."""
        return file_kinds.kind_of(self.ds)

    @cached_property
    def axes(self) -> list[str]:
        """The axes of the cases, in order, that of the samples among them; without cases the dimensions."""
        return schema.axes_of(self.ds) if "outcome" in self.ds else list(map(str, self.ds.dims))

    @cached_property
    def varied(self) -> list[str]:
        """The axes with several values, that of the samples among them."""
        return [axis for axis in self.axes if self.sizes[axis] > 1]

    @cached_property
    def cases(self) -> int:
        """How many cases it has. Raises `InputError` for a file of another kind than a study."""
        if "outcome" not in self.ds:
            raise InputError(f"the dataset is {self.kind.what}, which has no cases: list(ds) names what it holds")
        return int(self.ds["outcome"].size)

    @cached_property
    def units(self) -> dict[str, str]:
        """The units "length" and "force" of its numbers."""
        units = {kind: self.ds.attrs.get(f"{kind}_unit") for kind in ("length", "force")}
        return {kind: str(unit) for kind, unit in units.items() if unit is not None}

    @cached_property
    def sampled(self) -> list[str]:
        """The coordinates along the samples: the sampled fields, as the dataset names them."""
        return [quantity_variables.dimension(name) for name in schema.fields_of_samples(self.ds)]

    @property
    def leaves(self) -> bool:
        """Whether its rods may leave the cylinder."""
        return schema.leaves(self.ds)

    @cached_property
    def loads_vary(self) -> bool:
        """Whether loads vary along a rod: one has weight or friction."""
        return schema.loads_vary(self.ds)

    @cached_property
    def versions(self) -> dict[str, str]:
        """The versions with which it was made, by package. Raises `InputError`."""
        return schema.versions_of(self.ds)

    @cached_property
    def reading(self) -> str:
        """The reading of Table 1 in words, its name where it is not known here, or nothing."""
        text = str(self.ds.attrs.get("reading", ""))
        with contextlib.suppress(InputError):
            text = as_reading(text).words if text else ""
        return f"Table 1: {text}" if text else ""

    @cached_property
    def caution(self) -> str:
        """One sentence on the cautions of its cases; empty where there are none."""
        return caution_words.said(self.ds["caution"].values) if "caution" in self.ds else ""

    @cached_property
    def restable(self) -> str:
        """How many of the shapes of its solved rods a real rod could keep, in words; empty where it could keep all."""
        if "caution" not in self.ds:
            return ""
        texts = self.ds["caution"].values
        solved = self.ds["solved"].values if "solved" in self.ds else np.ones(texts.shape)
        stable = self.ds["index"].values == 0 if self.kind is file_kinds.EQUILIBRIA else True
        return caution_words.restable(texts, solved, stable, self._range_where_kept(texts, solved))

    def _range_where_kept(self, texts: Any, solved: Any) -> str:
        """The values of the one axis at which a real rod could keep the shape, ``L ≤ 34 m``, where they are one range
        and no other case is within it; else nothing."""
        is_one = self.kind is file_kinds.STUDY and len(self.varied) == 1
        if not is_one or self.varied[0] not in self.ds.coords or SAMPLE in self.varied:
            return ""
        axis, symbol = self.ds[self.varied[0]], labels.axis_symbol(self.varied[0])
        order = np.argsort(axis.values)
        sound, limited = caution_words.possible_shapes(texts, solved)
        kept = np.flatnonzero((sound if sound.any() else limited)[order])
        if not kept.size or kept[-1] - kept[0] >= kept.size:
            return ""
        low, high = (labels.value(float(axis.values[order[k]]), axis) for k in (kept[0], kept[-1]))
        if kept.size == 1:
            return f"{symbol} = {low}"
        below, above = f"{low} ≤ " * bool(kept[0] > 0), f" ≤ {high}" * bool(kept[-1] < order.size - 1)
        return f"{below}{symbol}{above}" if above else f"{symbol} ≥ {low}" * bool(below)

    @cached_property
    def left_out(self) -> str:
        """What the model leaves out of rods inside a cylinder, in one sentence; empty outside."""
        if str(self.ds.attrs["side"]) != "inside":
            return ""
        given: dict[str, Any] = {name: self.ds[name].values for name in VARY_LOADS if name in self.ds}
        given |= {name: self.attrs.get(name) for name in ("sliding", "contact")}
        return caution_words.model_leaves_out(given | {"closed": self.kind is file_kinds.LOOPS})

    def check_any_solved(self) -> None:
        """Raise `InputError`, which says why, where no case is solved and there is nothing to draw."""
        outcome_counts.check_any_solved(self.ds["solved"].values, self.ds["outcome"].values)

    # which cases

    def axis(self, name: str) -> str:
        """The axis of that name, or of that field of the study (`beta` is beta0). Raises `InputError` with the axes."""
        axes = [dim for dim in self.axes if dim in self.ds.coords and dim not in ("u", *COMPONENTS)]
        for known in (name, quantity_variables.dimension(name) if name in FIELDS else name):
            if known in axes:
                return known
        if SAMPLE in axes and name in (fields := schema.fields_of_samples(self.ds)):
            raise InputError(
                f"{name} is no axis: the samples are of {choices(fields)}; give the number of one, sample=0"
            )
        if name in self.ds.coords and not self.ds[name].ndim:
            raise InputError(f"{name} is selected already: it is {self.ds[name].item():.10g}")
        if not axes:
            raise InputError(f"no axis {name!r}: the dataset has none")
        raise no_such("axis", name, axes)

    def axis_left(self, named: Iterable[str], what: str, advice: str) -> str:
        """The one axis that is not among those named: if several are left, the one with several values.

        Raises `InputError` for none and for several: what goes along one axis, and how another one is named.
        """
        free = [axis for axis in self.axes if axis not in {*map(self.axis, named)}]
        free = [axis for axis in free if self.sizes[axis] > 1] or free
        if len(free) != 1:
            said = f"the axes {choices(free)} remain: {advice}" if free else "no axis remains"
            raise InputError(f"{what} along one axis, and {said}")
        return free[0]

    def is_logarithmic(self, axis: str) -> bool:
        """Whether the scale of an axis is logarithmic: its values have a wide range, and their logarithms are spread
        more evenly.

        An axis that was refined says itself how it is spread: its values crowd where something changes.
        """
        low, middle, high = (float(value) for value in np.quantile(self.ds[axis].values, (0.0, 0.5, 1.0)))
        if not is_wide(low, high):
            return False
        if "spacing" in self.ds[axis].attrs:
            return bool(self.ds[axis].attrs["spacing"] == "geometric")
        return abs(middle - np.sqrt(low * high)) < abs(middle - (low + high) / 2)

    def place(self, at: Mapping[str, Value] | None = None) -> dict[str, int]:
        """The indices of the case at these values; an axis that is not named stays where the laws or Table 1 put it.

        Raises `InputError` for a name that is no axis or a value that is not stored.
        """
        chosen = {self.axis(name): value for name, value in (at or {}).items()}
        return {name: index(self.ds[name], chosen[name]) if name in chosen else self._base(name) for name in self.axes}

    def _base(self, name: str) -> int:
        """The index nearest to where the laws or Table 1 put an axis; else its middle."""
        values = self.ds[name].values.astype(float)
        for row in self.data("laws") if "laws" in self.attrs else ():
            if name in row.get("at", {}):
                return int(np.abs(values - row["at"][name]).argmin())
        printed = table_of(self.attrs.get("reading"))
        at_start = {quantity_variables.dimension(field): value for field, value in printed.items() if field in FIELDS}
        base = at_start.get(name)
        return values.size // 2 if base is None else int(np.abs(values - base).argmin())

    def places(self, axis: str, at: Mapping[str, Value] | None = None, most: int | None = None) -> list[dict[str, int]]:
        """The indices of each case along an axis in its rising order, the other axes as in `place`.

        most: how many at most, evenly chosen; default: all.
        """
        axis, place = self.axis(axis), self.place(at)
        every = [{**place, axis: int(i)} for i in np.argsort(self.ds[axis].values, kind="stable")]
        return every if most is None else spread(every, most)

    def value(self, axis: str, value: Value) -> float:
        """The stored value of an axis that is meant. Raises `InputError` with the stored values."""
        return float(self.ds[axis].values[index(self.ds[axis], value)])

    def select(self, places: Mapping[str, Any]) -> Self:
        """The cases at these indices; an axis with one index is gone."""
        return type(self)(self.ds.isel(places), self.kept)

    def each(self) -> Iterator[Self]:
        """Its cases one by one, in their order."""
        places = np.ndindex(*self.ds["outcome"].shape)
        return (self.select(dict(zip(self.axes, place, strict=True))) for place in places)

    def part(self, **values: str) -> Self:
        """What stands at these names on dimensions of names, as of methods or observables; such a dimension is gone."""
        return type(self)(self.ds.sel(values))

    def only(self, names: Iterable[str]) -> Self:
        """These cases with some of their variables alone, so that nothing else is read."""
        return type(self)(self.ds[list(names)], self.kept)

    def with_arrays(self, along: Mapping[str, Any]) -> Self:
        """This case with other arrays along the rod, (n,) each, in place of stored ones."""
        return type(self)(self.ds.assign({name: ("u", values) for name, values in along.items()}))

    def plane(self, x: str, y: str, where: Mapping[str, int]) -> Self:
        """The cases over two axes, (y, x) with rising values of both; where: the indices along the others."""
        return type(self)(self.ds.isel(where).sortby([x, y]).transpose(y, x, ...))

    def without(self, key: str) -> Self:
        """A copy without the numbers of some rods: they are NaN, so that diagrams and laws do not show them.

        Parameters
        ----------
        key : str
            What these rods do, a word of their caution: "turned back", "overlaps", ... Of branches "turned back" alone.

        Raises
        ------
        InputError
            For another word, and for a file that does not tell of its rods.
        """
        check_known("caution", key, caution_words.WORDS)
        ds = self.ds
        if "caution" in ds and "outcome" in ds and ds["caution"].dims == ds["outcome"].dims:
            where = ds["caution"].copy(data=caution_words.has_key(ds["caution"], key))
            return type(self)(_without_numbers(ds, where, ""), self.kept)
        parts = [part for part in PARTS if f"{part}_{BACK}" in ds]
        if not parts or key != caution_words.TURNED:
            raise InputError(f"this file does not tell which of its rods are {key!r}")
        for part in parts:
            ds = _without_numbers(ds, ds[f"{part}_{BACK}"], f"{part}_")
        return type(self)(ds, self.kept)

    # its numbers

    @cached_property
    def observables(self) -> list[str]:
        """The observables that are stored for each case, in the order of the file; of a sweep, its branches too."""
        names = [name for name in self.variables if not (name.endswith("error") or name in NOT_OBSERVED)]
        return [name for name in names if self._is_number_of_each_case(name) and self._varies(name)]

    @cached_property
    def all_observables(self) -> list[str]:
        """The observables and expressions in their order, then what else of `observables` the file has of its cases:
        loads and end moments that the study names, and what is found of held ends."""
        first = [name for name in quantity_variables.observables_of(self.ds) if self._is_number_of_each_case(name)]
        return list(dict.fromkeys([*first, *self.observables]))

    def _varies(self, name: str) -> bool:
        """Whether a number tells something: not the only branch, nor a load or an end angle that was given."""
        if name == "branch":
            return bool(np.unique(self.of_solved(name).values[self.ds["solved"].values]).size > 1)
        if name not in FOUND:
            return True
        if HELD_INDEX not in self.ds.data_vars:
            return False
        largest = max(float(abs(self.ds[other]).max()) for other in FOUND if other in self.ds.data_vars)
        return float(self.ds[name].max() - self.ds[name].min()) > _ROUNDING * largest

    def _is_number_of_each_case(self, name: str) -> bool:
        """Also the estimated errors, the condition number and the loads are numbers of each case."""
        ds = self.ds
        return name in ds.data_vars and ds[name].dtype.kind in "iuf" and set(ds[name].dims) == set(ds["outcome"].dims)

    @cached_property
    def counts(self) -> frozenset[str]:
        """The names of the numbers that are whole: counts, comparisons, and the number of a branch."""
        whole = [name for name in self.variables if self.ds[name].dtype.kind in "iu" or is_count(self.ds[name])]
        return frozenset({*whole, HELD_INDEX})

    @cached_property
    def names_that_vary(self) -> list[str]:
        """The observables that are not the same in all cases."""
        return [name for name in self.observables if not self.is_level(name)]

    def names_of_figure(self, show: Sequence[str]) -> list[str]:
        """The observables that are asked for, for one figure. Raises `InputError` as `names_of` does, for too many."""
        names = self.names_of(show)
        if len(names) > MOST_ASKED:
            raise InputError(f"a figure shows at most {MOST_ASKED} observables, got {len(names)}: {choices(names)}")
        return names

    def names_of(self, names: Sequence[str]) -> list[str]:
        """The names, each once. Raises `InputError` for one that is no number of each case, with the observables."""
        names = [current(name) for name in names]
        for name in names:
            if not self._is_number_of_each_case(name):
                raise no_such_observable(name, self.observables)
        return list(dict.fromkeys(names))

    def of_solved(self, name: str) -> xr.DataArray:
        """A number of each case, NaN where it is not solved: the number of a branch is stored as -1 there."""
        return self.ds[name].where(self.ds["solved"]) if name == "branch" else self.ds[name]

    @cached_property
    def swings(self) -> xr.DataArray:
        """By how much beta varies along the rod of each case [rad]; NaN where no file tells."""
        if "amplitude" in self.ds:
            return self.ds["amplitude"].astype(float)
        if "beta" not in self.ds:
            return xr.full_like(self.ds["outcome"], np.nan, dtype=float)
        beta = self.ds["beta"].load()
        return beta.max("u", skipna=False) - beta.min("u", skipna=False)

    def unbent(self, name: str) -> xr.DataArray:
        """Whether a number of each case is that of the bends of a rod that is nearly straight; no picture shows it."""
        return (self.swings < NEARLY_STRAIGHT) & (name == BENDS)

    def errors_of(self, name: str) -> xr.DataArray:
        """The estimated errors of a number of each case; 0 where none is known."""
        error = f"{name}_error"
        return (self.ds[error] if error in self.ds else xr.zeros_like(self.ds[name], dtype=float)).fillna(0.0)

    def is_level(self, name: str) -> bool:
        """Whether a number is the same in all cases, but for rounding and its estimated errors: one value lies within
        the error of each."""
        low, high = self.level(name)
        return low <= high

    def level(self, name: str) -> tuple[float, float]:
        """The ends of what all cases may have in common of a number, within rounding and their estimated errors; the
        first is the larger where they have nothing in common."""
        values = np.asarray(self.ds[name].values, dtype=float)
        known = np.isfinite(values)
        if not known.any():
            return np.inf, -np.inf
        errors = np.maximum(self.errors_of(name).values, NOISE / 2 * np.abs(values[known]).max())[known]
        return float((values[known] - errors).max()), float((values[known] + errors).min())

    def level_in_words(self, name: str) -> str:
        """A number that is the same in all cases, or in all that have one, without its name: ``3 in all cases``."""
        return f"{labels.level(self.ds[name], *self.level(name))} in {known_cases(self.ds[name])}"

    def level_notes(self, names: Iterable[str]) -> list[str]:
        """A sentence about each of the observables that is the same in all cases, or in all that have a number."""
        texts = []
        for name in names:
            if not self.is_level(name):
                continue
            noun, where = labels.long_name(self.ds[name]), known_cases(self.ds[name])
            holds = bool(round(sum(self.level(name)) / 2))
            if flag := re.fullmatch("1 where (.*), else 0", noun):
                none = "no case" if where.startswith("all") else f"none of {where}"
                said = f"{flag[1]} in {where if holds else none}."
            elif IS_TRUE_OR_FALSE.search(str(self.ds[name].attrs.get("expression", ""))):
                said = f"{noun}: {'true' if holds else 'false'} in {where}."
            else:
                said = f"{noun}: {self.level_in_words(name)}."
            texts.append(labels.capital(said))
        return texts

    def moves(self, axis: str) -> Any:
        """By how many radii of the cylinder rods move at most from one case along an axis to the next, (cases - 1,)."""
        names = "alpha", "z", "radius" if self.leaves else "rho"
        alpha, z, r = (each.transpose(axis, ...) for each in xr.broadcast(*(self.ds[name] for name in names)))
        way = np.linalg.norm(np.diff(frames.position(r.values, alpha.values, z.values), axis=0), axis=-1)
        return way.max(axis=tuple(range(1, way.ndim))) / float(self.ds["rho"].max())

    def equations(self, where: Mapping[str, int], digits: int = 4) -> str:
        """The values at indices along axes: ``R = 0.75 cm, F₃ = 10 N``; nothing where there are none."""
        numbers = [(self.ds[axis], float(self.ds[axis].values[i])) for axis, i in where.items()]
        return ", ".join(labels.equation(array, number, digits) for array, number in numbers)


def _without_numbers(ds: "xr.Dataset", where: "xr.DataArray", prefix: str) -> "xr.Dataset":
    """The dataset with NaN in the numbers of a name with the prefix where an array says so."""
    alike = {str(name): array for name, array in ds.data_vars.items() if array.dims == where.dims}
    named = {name: array for name, array in alike.items() if name.startswith(prefix) and "branch" not in name}
    numbers = {name: array.astype(float) for name, array in named.items() if array.dtype.kind in "iuf"}
    return ds.assign({name: each.where(~where, np.nan).assign_attrs(ds[name].attrs) for name, each in numbers.items()})
