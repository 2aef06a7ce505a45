"""The motions of the solved cases of a solution: how each orbit answers what is given; and the derivatives of shapes
and of what is measured along them, from these changes, by the compiled core (`sensitivities.c`)."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from ..branches.orbit_rates import rates_of_helices, rates_of_variations
from ..branches.path_correction import settle
from ..core.library import ANGLE, cut, fine, numbers_of, on_grid, points, run, share_out, structure, widest
from ..core.measures import GROUPS, NUMBERS, RATED
from ..numerics.arrays import Array, Integers
from ..numerics.roots import EXACT
from ..orbits.boundary import Path, path_of
from ..orbits.path_orbits import path_from_start, variations_of
from ..orbits.shape_arrays import ShapeArrays
from ..orbits.variations import HOW as LONGER
from ..orbits.variations import POINTS, HelixVariations, Variations
from ..problem.dimensionless import EndsProblem, Reduced, StartProblem, end_number_names, flat
from .measurement import MIDDLE
from .solution_pieces import CASES

MARKS = np.array([0.0, *MIDDLE, 1.0])  # shares of the length that observables need
# of panels: with 0.45 derivatives of one rod in 13 are off by more than their error. x10: beyond what a series holds
HOW = LONGER._replace(length=0.36)


@dataclass(frozen=True, eq=False)
class Motion:
    """The motions of b cases, the `rows` of a solution.

    problem: the start problems of the orbits. varied: their variations. parts: (b, 5, k), the parts of a change by a
    unit of what is given: of beta(0), beta_t(0), lam, mu and phi of a start problem (k = 5), of the five given numbers
    of an ends problem and of the length (k = 6).
    """

    rows: Integers
    problem: StartProblem
    varied: Variations | HelixVariations
    parts: Array


def of_equilibria(sol: ShapeArrays, outcome: Array) -> Iterator[Motion]:
    """The motions of the solved cases of an ends problem. outcome: (B,), set where one of them has none."""
    for i in np.flatnonzero(sol.trajectory.solved):
        problem = sol.problem.take(slice(i, i + 1))
        assert isinstance(problem, EndsProblem)
        path = _path(sol, problem, int(i))
        if path is None:
            outcome[i] = (
                "failed: no orbit with beta(0) and beta'(0) of this solution ends at beta(L), so it has no derivatives"
            )
        else:
            yield _of_equilibrium(sol, problem, path, int(i))


def of_helices(sol: ShapeArrays, rows: Integers) -> Iterator[Motion]:
    """The motions of start problems whose orbits are helices, some at a time."""
    for block in (rows[k : k + CASES] for k in range(0, rows.size, CASES)):
        problem = sol.problem.take(block)
        assert isinstance(problem, StartProblem)
        parts = np.broadcast_to(np.eye(5), (block.size, 5, 5))
        yield Motion(block, problem, HelixVariations(problem), parts)


def marks_of(problem: Reduced) -> Array:
    """t at the shares `MARKS` of the length, (b, 4)."""
    return np.asarray(problem.span[:, None] * MARKS)


def _of_equilibrium(sol: ShapeArrays, problem: EndsProblem, path: Path, i: int) -> Motion:
    names, ratio = end_number_names(sol.case), float(flat(sol.case.rod.stiffness_ratio, sol.case.shape)[i])
    start = problem.with_start(sol.trajectory.dbeta[i : i + 1, 0])
    varied = variations_of(problem, path)
    rates = rates_of_helices(problem) if isinstance(varied, HelixVariations) else rates_of_variations(problem, varied)
    return Motion(np.array([i]), start, varied, rates.parts(names, ratio))


def _path(sol: ShapeArrays, problem: EndsProblem, i: int) -> Path | None:
    """The level and the path of the equilibrium of case i; None where no orbit is found that joins the ends."""
    if (paths := getattr(sol.trajectory.orbit, "paths", None)) is not None:
        return path_of(paths, i)
    path = path_from_start(problem, float(sol.trajectory.dbeta[i, 0]))
    if path is None or path.helix:
        return path
    settled = settle(problem, path)  # the slope is as exact as the method
    return path if isinstance(settled, str) else settled.path


LOST, PARTLY = -1, ("push", "turned", "risen")  # measured over the middle third
_Shapes = structure("shapes", "variations.h")
_Sensitivities = structure("sensitivities", "sensitivities.c", along=_Shapes)


def shape_rates(out: Array, shape: Mapping[str, Array]) -> None:
    """Turn the changes of orbits into the derivatives of shapes, in place.

    Parameters
    ----------
    out : (5, B, F, n)
        The changes of beta, beta_t and the integrals of H_q d beta; filled with the derivatives of beta, dbeta, alpha,
        z and gamma at constant s/L.
    shape : mapping
        t, beta, rate (beta_t) and z/rho, (B, n) each; loads, (B, 3); span, ratio and rho, (B,); by, (11, B, F), rates
        of the numbers of the case; later, (B, F), those of the length in t. Without by, ratio and rho all is in units
        of rho.
    """
    run("rod_shape_rates", _shapes_of(out, shape), widest())


def _shapes_of(out: Array, shape: Mapping[str, Array]) -> Any:
    _, B, F, n = out.shape
    return _Shapes(size=B, stations=n, F=F, out=out, **shape)


class RatedNumbers(NamedTuple):
    """What is measured of B rods for their derivatives.

    sign, error : (B,), of the push, and of beta. names: of `RATED`. plain: of `NUMBERS`, whose values are wanted.
    middle: of `PARTLY`, over the middle third. goal: allowed error of the series, relative. seen: "lifts" and "peak",
    (B,) each, where what is observed is not what is measured here.
    """

    sign: Array
    error: Array
    names: Collection[str]
    plain: Collection[str]
    middle: Collection[str]
    goal: float
    seen: Mapping[str, Array]


class StartRates(NamedTuple):
    """The derivatives of B start problems by F fields.

    kind: (B,), of their orbits; of helices, and where it is `LOST`, nothing else is known. along: (5, B, F, n), of
    beta, dbeta, alpha, z and gamma. marks: (B, 5, F, 4), of the same in units of rho at 0, 1/3, 2/3 and 1 of the
    length. half_period: (B, F). rates: (B, F) by name. values: numbers and their errors, (B,) each, by name; middle:
    the same over the middle third. Where nothing is measured kind and along alone are known.
    """

    kind: Integers
    along: Array
    marks: Array = np.empty(0)
    half_period: Array = np.empty(0)
    rates: Mapping[str, Array] = MappingProxyType({})
    values: Mapping[str, tuple[Array, Array]] = MappingProxyType({})
    middle: Mapping[str, tuple[Array, Array]] = MappingProxyType({})


def start_sensitivities(
    problem: Reduced,
    shape: Mapping[str, Array],
    measured: RatedNumbers | None = None,
    motion: tuple[Variations, Array] | None = None,
) -> StartRates:
    """The derivatives of B start problems.

    shape: as of `shape_rates`. motion: of one problem whose orbit is known, its variations and the parts of its
    changes, (1, 5, F).
    """
    numbers, (B, stations), F = numbers_of(problem), shape["t"].shape, shape["by"].shape[2]
    out, kind = np.empty((5, B, F, stations)), np.empty(B, dtype=np.int64)
    along = _shapes_of(out, {**shape, "loads": numbers[:, :3], "span": numbers[:, 3]})
    rest: dict[str, Any] = {"along": along, "problems": numbers, "kind": kind}
    if motion is not None:
        varied, parts = motion
        of, kept = varied.arguments
        rest |= {"of": of, "varied": kept, "parts": parts.swapaxes(1, 2)}
    ways = on_grid(), points(POINTS), cut(HOW, ANGLE)

    def derive() -> None:
        task = _Sensitivities(**rest)
        share_out(lambda a, b: fine(run("rod_sensitivities", task, *ways, a, b)), B)

    if measured is None:
        derive()
        return StartRates(kind, out)
    marks, half = np.full((B, 5, F, 4), np.nan), np.full((B, F), np.nan)
    seen, rates = np.zeros((3, B, 2, len(NUMBERS))), np.full((B, F, len(NUMBERS) + 1), np.nan)
    names, plain, middle = measured.names, measured.plain, measured.middle
    rest |= {"sign": measured.sign, "error": measured.error, **measured.seen}
    rest |= {"found": seen, "rates": rates, "marks": marks, "half_period": half}
    rest |= {"goal": measured.goal, "rates_goal": EXACT, "wanted": sum(1 << RATED[name] for name in names)}
    rest |= {"groups": _groups_of(plain), "partly": _groups_of(middle)}
    derive()
    places = [(name, NUMBERS.index(name)) for name in _members(plain)]
    (whole, less, more), thirds = seen, {name: NUMBERS.index(name) for name in _members(middle)}
    return StartRates(
        kind,
        out,
        marks,
        half,
        {name: rates[..., RATED[name]] for name in names},
        {name: (whole[:, 0, k], whole[:, 1, k]) for name, k in places},
        {name: (more[:, 0, k] - less[:, 0, k], more[:, 1, k] + less[:, 1, k]) for name, k in thirds.items()},
    )


def _groups_of(names: Collection[str]) -> int:
    return sum(1 << k for k, group in enumerate(GROUPS) if not set(names).isdisjoint(group))


def _members(names: Collection[str]) -> list[str]:
    return [name for group in GROUPS if not set(names).isdisjoint(group) for name in group]
