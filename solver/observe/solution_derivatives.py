"""The derivatives of a solution with respect to the fields of its case.

What is given answers directly; the loads that are found follow from the equations of the equilibrium
(`motions.Motion.parts`).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..numerics.arrays import EPS, SHAPELESS, Array
from ..orbits.periodic_orbit import HELIX
from ..orbits.shape_arrays import ShapeArrays
from ..orbits.variations import HelixVariations
from ..problem.case import refuse_leaving
from ..problem.case_fields import check_fields
from ..problem.dimensionless import EndsProblem, FieldRates, end_number_names, field_rates, flat
from ..problem.outcomes import SOLVED, decade
from ..problem.quantities import ByName
from .motions import LOST, Motion, of_equilibria, of_helices, shape_rates, start_sensitivities
from .observable_rates import Moving, check_observables, derivatives_of, measure_of, why_missing
from .varying_rates import STEP, rates_on_nodes


def ends_field_rates(sol: ShapeArrays, fields: Sequence[str]) -> FieldRates:
    """The derivatives of the numbers of an ends problem by fields of its case, but those of loads that are found."""
    rates = field_rates(sol.case, fields)
    assert rates.given is not None
    turn = np.array(end_number_names(sol.case)) == "turn"  # ratio mu span less the swirl: the ratio changes it at once
    by_ratio = (sol.problem.mu * sol.problem.span)[:, None] * rates.of("ratio")
    return replace(rates, given=rates.given - turn[:, None] * by_ratio[:, None])


def amounts(motion: Motion, rates: FieldRates) -> Array:
    """How far a unit of each field moves the cases in the five directions of a motion, (b, 5, F)."""
    if rates.given is None:
        return np.matmul(motion.parts, rates.table[[4, 5, 0, 1, 2]].swapaxes(0, 1))
    return np.matmul(motion.parts, np.concatenate([rates.given, rates.of("span")[:, None]], axis=1))


def _shape_of(sol: ShapeArrays, rates: FieldRates, rows: Any) -> dict[str, Array]:
    """Some cases as `motions.shape_rates` takes them. rates: of these cases."""
    case, known = sol.case, sol.trajectory
    scales = {"ratio": flat(case.rod.stiffness_ratio, case.shape), "rho": flat(case.rho, case.shape)}
    shapes = {"t": sol.t, "beta": known.beta, "rate": known.dbeta, "z": known.z}
    arrays = {name: array[rows] for name, array in {**shapes, **scales}.items()}
    return arrays | {"by": rates.table, "later": rates.of("span")}


def _of_helices(sol: ShapeArrays, motion: Motion, unit: Array, rates: FieldRates) -> Array:
    """The derivatives of beta, dbeta, alpha, z and gamma of helices at the stations, (5, b, F, n). unit: (b, 5, F), of
    `amounts`. rates: of these cases."""
    shape = _shape_of(sol, rates, motion.rows)
    out = motion.varied.change(shape["t"], unit).rows
    loads = np.stack([motion.problem.lam, motion.problem.mu, motion.problem.phi], axis=1)
    shape_rates(out, {**shape, "loads": loads, "span": motion.problem.span})
    return out


def _blank_rates(sol: ShapeArrays, rates: FieldRates) -> Array:
    """NaN in place of all derivatives along the rods, (5, B, F, n)."""
    return np.full((len(_ALONG), sol.problem.size, len(rates.fields), sol.t.shape[1]), np.nan)


def _of_starts(sol: ShapeArrays, rates: FieldRates, read: Moving | None) -> tuple[Array, Array]:
    """Derive the solved start problems that are no helices; all of them, (5, B, F, n), and the kinds of their orbits,
    (B,), `LOST` where a case has no derivatives."""
    solved = np.flatnonzero(sol.trajectory.solved)
    every = solved.size == sol.problem.size
    rows = slice(None) if every else solved
    problem, of_solved = (sol.problem, rates) if every else (sol.problem.take(solved), rates.take(solved))
    shape = _shape_of(sol, of_solved, rows)
    answer = start_sensitivities(problem, shape, None if read is None else read.measurement(rows))
    if read is not None:
        read.take(rows, answer)
    out = answer.along if every else _blank_rates(sol, rates)
    if not every:
        out[:, solved] = answer.along
    kind = np.full(sol.problem.size, LOST)
    kind[solved] = answer.kind
    return out, kind


_ROUNDING = 32 * EPS  # of a derivative, times the condition number. x10: stated errors ten times as large
_CARRIED = 4  # of the error of the shape, on which the derivatives depend through beta, H, alpha and z. x10: the same
_ALONG = ("beta", "dbeta", "alpha", "z", "gamma")


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """The derivatives of a solution with respect to F fields of its case; `Solution.sensitivity` makes it.

    The stations keep their place s/L when a field changes. The unit of each derivative is that of the quantity over
    that of the field (`solver.problem.quantities`).

    Attributes
    ----------
    solution : Shape
        The solution.
    fields : tuple of str
        The names of the F fields.
    beta, alpha, gamma : array, (*cases, F, n)
        Derivatives of the angle, the azimuth and the rotation of the section at the stations.
    dbeta, z : array, (*cases, F, n)
        Derivatives of beta' and of the height.
    solved : bool or array, (*cases)
        Whether a case has derivatives; where not, all of them are NaN.
    outcome : str or array, (*cases)
        "solved", or "failed: " and the reason.
    error : float or array, (*cases)
        Estimated error of the derivatives along the rod, relative to the largest of each: rounding, grown, and the
        error of the solution, which its tolerance allows.
        Digits that cancel are not counted: a derivative that is a small difference of large terms, as those by R often
        are, has lost that many more.
    observables : dict
        Name of an observable -> its derivatives, (*cases, F).
    remarks : dict
        Name of an observable -> (*cases), a sentence where one of its derivatives does not exist and is NaN, else "".
    """

    solution: ShapeArrays = field(repr=False)
    fields: tuple[str, ...]
    beta: Array = field(repr=False)
    dbeta: Array = field(repr=False)
    alpha: Array = field(repr=False)
    z: Array = field(repr=False)
    gamma: Array = field(repr=False)
    solved: Any
    outcome: Any
    error: Any
    observables: dict[str, Any] = field(default_factory=dict)
    remarks: dict[str, Any] = field(default_factory=dict)

    def with_given(self, observable: str, name: str) -> "Sensitivity":
        """The derivatives where an observable is given in place of a field, as FZ0 of FZ, which it then determines.

        observable: one of `observables`. name: one of `fields`, whose place it takes there.
        """
        k, by_field = self.fields.index(name), self.observables[observable]
        is_it = np.arange(len(self.fields)) == k
        with np.errstate(divide="ignore", invalid="ignore"):
            answer = np.where(is_it, 1.0, -by_field) / by_field[..., k : k + 1]  # of the field to each of the others

        def exchange(rates: Array) -> Array:  # (..., F)
            return np.where(is_it, 0.0, rates) + rates[..., k : k + 1] * answer

        arrays = {each: np.moveaxis(getattr(self, each), -1, 0) for each in _ALONG}  # (n, ..., F)
        along: dict[str, Any] = {each: np.moveaxis(exchange(rates), 0, -1) for each, rates in arrays.items()}
        fields = tuple(observable if each == name else each for each in self.fields)
        seen = ByName((each, exchange(rates)) for each, rates in self.observables.items())
        return replace(self, fields=fields, observables=seen, **along)


def sensitivity(sol: ShapeArrays, fields: Iterable[str], observables: Iterable[str] = ()) -> Sensitivity:
    """The derivatives of a solution; see `Solution.sensitivity`."""
    refuse_leaving(sol.case.cylinder, "sensitivity")
    names, observed = check_fields(sol.case, fields), check_observables(observables)
    ends, growth = isinstance(sol.problem, EndsProblem), np.asarray(sol.trajectory.condition)
    with np.errstate(all="ignore"):
        error = _ROUNDING * (growth**2 if ends else growth)
    if sol.trajectory.shapes is not None:
        known = np.where(sol.trajectory.solved, SOLVED, sol.trajectory.outcome).astype(object)
        with np.errstate(all="ignore"):
            curves, numbers = rates_on_nodes(sol, names, _ALONG, observed)
            table = np.array([*numbers.values()]).reshape(len(observed), known.size, len(names))
            out = np.stack([*curves.values()])
            finite = np.isfinite(out).all(axis=(0, 2, 3))
            return _judge(sol, names, out, observed, table, known, np.where(finite, error / STEP, np.inf))
    rates = ends_field_rates(sol, names) if ends else field_rates(sol.case, names)
    outcome = np.where(sol.trajectory.solved, SOLVED, sol.trajectory.outcome).astype(object)
    read = Moving(sol, rates, (key for name in observed for key in measure_of(name))) if observed else None
    finite, unseen = np.ones(sol.problem.size, dtype=bool), np.ones(sol.problem.size, dtype=bool)
    with np.errstate(all="ignore"):  # what leaves the finite numbers is told by the outcome
        if ends:
            out, moving = _blank_rates(sol, rates), of_equilibria(sol, outcome)
        else:
            out, kind = _of_starts(sol, rates, read)
            finite, unseen = kind != LOST, kind == HELIX
            moving = of_helices(sol, np.flatnonzero(unseen))
        for motion in moving:
            unit = amounts(motion, rates.take(motion.rows))
            for name, moved in zip(("lam", "mu", "phi"), unit[:, 2:].swapaxes(0, 1), strict=True):
                rates.of(name)[motion.rows] = moved  # held ends find them
            of_rows = rates.take(motion.rows)
            if isinstance(motion.varied, HelixVariations):
                out[:, motion.rows] = _of_helices(sol, motion, unit, of_rows)
                if read is not None:
                    read.add_helices(motion, unit, of_rows)
                continue
            shape, orbit = _shape_of(sol, of_rows, motion.rows), (motion.varied, unit)
            measured = None if read is None else read.measurement(motion.rows, given=True)
            answer = start_sensitivities(motion.problem, shape, measured, orbit)
            out[:, motion.rows] = answer.along
            if read is not None:
                read.take(motion.rows, answer)
        derivatives = np.empty((0, sol.problem.size, len(names))) if read is None else derivatives_of(observed, read)
    finite[unseen] = np.isfinite(out[:, unseen]).all(axis=(0, 2, 3))
    return _judge(sol, names, out, observed, derivatives, outcome, np.where(finite, error, np.inf))


def _judge(
    sol: ShapeArrays,
    names: tuple[str, ...],
    out: Array,
    wanted: tuple[str, ...],
    table: Array,
    outcome: Array,
    error: Array,
) -> Sensitivity:
    """The result; a case in which no digit is left gets an outcome that says so.

    out: (5, B, F, n), along the rods. table: (K, B, F), of the observables. error: (B,), by rounding; infinite
    where a derivative along the rod is.
    """
    growth, held = np.asarray(sol.trajectory.condition), isinstance(sol.problem, EndsProblem)
    begun = outcome == SOLVED
    where = "at a fold, or next to one" if held else "next to a separatrix"
    for i in np.flatnonzero(begun & ~(error < SHAPELESS)):
        outcome[i] = f"failed: {where}, condition above {decade(growth[i])} leaves no digit of the derivatives"
    solved, shape = outcome == SOLVED, sol.case.shape
    missing = solved & ~np.isfinite(table).all(axis=2)
    if not solved.all():
        out[:, ~solved] = table[:, ~solved] = np.nan
    along = dict(zip(_ALONG, out.reshape(len(_ALONG), *shape, *out.shape[2:]), strict=True))
    stated = np.where(solved, error + _CARRIED * np.asarray(sol.trajectory.error), np.inf)
    values = ByName(zip(wanted, table.reshape(len(wanted), *shape, len(names)), strict=True))
    remarks = np.full(missing.shape, "", dtype=object)
    for k in np.flatnonzero(missing.any(axis=1)):
        remarks[k, missing[k]] = why_missing(wanted[k], sol)
    by_case = {name: sol._each(value) for name, value in (("solved", solved), ("outcome", outcome), ("error", stated))}
    sentences = {name: sol._each(row) for name, row in zip(wanted, remarks, strict=True)}
    return Sensitivity(sol, names, **along, **by_case, observables=values, remarks=sentences)
