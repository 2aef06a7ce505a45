"""The derivatives of start problems in one pass, and of shapes from the changes of their orbits, by the compiled core:
`sensitivities.c`."""

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..numerics.arrays import Array, Integers
from .library import AT, FLOAT, INT, Cutting, cut, fine, numbers_of, on_grid, points, run, share_out, structure
from .measures import GROUPS, NUMBERS, RATED
from .orbits import arguments_of

LOST, PARTLY = -1, ("push", "turned", "risen")  # measured over the middle third
SERIES_GOAL = 1e-14  # of the series of which the places of extremes are found, relative
_SHAPES = "t beta rate z loads span by later ratio rho"
_Shapes = structure("shapes", (INT, "size stations F"), (AT, f"{_SHAPES} out"))
_Sensitivities = structure(
    "sensitivities", (_Shapes, "along"), (AT, "marks of varied parts problems sign error lifts peak"),
    (INT, "wanted groups partly"), (FLOAT, "goal rates_goal"), (AT, "kind half_period rates found"),
)  # fmt: skip


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
    run("rod_shape_rates", _shapes_of(out, shape))


def _shapes_of(out: Array, shape: Mapping[str, Array]) -> Any:
    _, B, F, n = out.shape
    return _Shapes(
        size=B, stations=n, F=F, out=out,
        **{name: np.ascontiguousarray(array, dtype=float) for name, array in shape.items()},
    )  # fmt: skip


class Measured(NamedTuple):
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
    the same over the middle third.
    """

    kind: Integers
    along: Array
    marks: Array
    half_period: Array
    rates: dict[str, Array]
    values: dict[str, tuple[Array, Array]]
    middle: dict[str, tuple[Array, Array]]


def start_sensitivities(
    problem: Any, shape: Mapping[str, Array], n: int, how: Cutting, measured: Measured | None = None,
    motion: tuple[Any, Array] | None = None,
) -> StartRates:  # fmt: skip
    """The derivatives of B start problems.

    shape: as of `shape_rates`. n, how: as of `orbits.orbits`. motion: of one problem whose orbit is known, its
    variations (`orbit.variations.Variations`) and the parts of its changes, (1, 5, F).
    """
    numbers, (B, stations), F = numbers_of(problem), shape["t"].shape, shape["by"].shape[2]
    out, marks = np.full((5, B, F, stations), np.nan), np.full((B, 5, F, 4), np.nan)
    kind, half = np.empty(B, dtype=np.int64), np.full((B, F), np.nan)
    along = _shapes_of(out, {**shape, "loads": numbers[:, :3], "span": numbers[:, 3]})
    rest: dict[str, Any] = {"along": along, "marks": marks, "problems": numbers, "kind": kind, "half_period": half}
    if motion is not None:
        varied, parts = motion
        of, kept = arguments_of(varied)
        rest |= {"of": of, "varied": kept, "parts": np.ascontiguousarray(parts.swapaxes(1, 2))}
    seen, rates = np.zeros((3, B, 2, len(NUMBERS))), np.full((B, F, len(NUMBERS) + 1), np.nan)
    names, plain, middle = (measured.names, measured.plain, measured.middle) if measured is not None else ((), (), ())
    if measured is not None:
        arrays = {"sign": measured.sign, "error": measured.error, **measured.seen}
        rest |= {name: np.ascontiguousarray(array, dtype=float) for name, array in arrays.items()}
        rest |= {"found": seen, "rates": rates, "goal": measured.goal, "rates_goal": SERIES_GOAL}
        rest["wanted"] = sum(1 << RATED[name] for name in names)
        rest["groups"], rest["partly"] = _groups_of(plain), _groups_of(middle)
    task, ways = _Sensitivities(**rest), (on_grid(), points(n), cut(how, False))
    share_out(lambda a, b: fine(run("rod_sensitivities", task, *ways, a, b)), B)
    places = [(name, NUMBERS.index(name)) for name in _members(plain)]
    (whole, less, more), thirds = seen, {name: NUMBERS.index(name) for name in _members(middle)}
    return StartRates(
        kind, out, marks, half,
        {name: rates[..., RATED[name]] for name in names},
        {name: (whole[:, 0, k], whole[:, 1, k]) for name, k in places},
        {name: (more[:, 0, k] - less[:, 0, k], more[:, 1, k] + less[:, 1, k]) for name, k in thirds.items()},
    )  # fmt: skip


def _groups_of(names: Collection[str]) -> int:
    return sum(1 << k for k, group in enumerate(GROUPS) if not set(names).isdisjoint(group))


def _members(names: Collection[str]) -> list[str]:
    return [name for group in GROUPS if not set(names).isdisjoint(group) for name in group]
