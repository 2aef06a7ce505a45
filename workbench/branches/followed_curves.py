"""What a diagram of branches is drawn from: the followed curves, their special points and a shape of each branch."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from solver import Solution
from solver.follow import solutions_of
from solver.levels.morse_index import jacobi_zeros
from solver.observe.observables import OBSERVABLES, observe
from solver.problem.errors import no_such
from studies.grammar.axes import quantity_of

from ..store import schema
from .tracing import PARTNER, Piece, Traced

STATIONS = 161  # of a shape
FEW_SHAPES = 8  # in a row: one or two branches have so many together
LOADS = ("FZ", "MZ", "M3")
OWN = ("dbeta0", "beta0", "betaL", *LOADS)  # what a diagram may show beside observables
NAMES = tuple(dict.fromkeys((*OWN, *OBSERVABLES)))


INDICES = {
    "index": {"units": "1", "long_name": "Morse index under the ends of the case"},
    "dead_index": {"units": "1", "long_name": "Morse index between the same end angles under dead loads"},
}


def default_observable(name: str) -> str:
    """What a diagram over a field shows: the displacement that goes with a load, or the load that holds it."""
    return PARTNER.get(name, "wraps" if name in ("MZ", "M3") else "height")


def check_shown(name: str) -> None:
    """Raise `InputError` unless a diagram can show it."""
    if name not in NAMES:
        raise no_such("quantity to show", name, NAMES)


def special_points(seen: Traced, name: str, units: Mapping[str, str], shown: Sequence[str]) -> dict[str, Any]:
    """The folds over `fold`, and the other special points over `special`."""
    data = dict[str, Any]()
    for dim, words, group in (
        ("fold", "where two equilibria meet and cease to exist", [e for e in seen.special if e[1].kind == "fold"]),
        ("special", "where branches meet or end", [e for e in seen.special if e[1].kind != "fold"]),
    ):
        rows = [
            _numbers(branch.points[point.position].solution, ("dbeta0", "energy", *shown)) | {name: point.value}
            for branch, point, _ in group
        ]
        for key, label in _labels(name, ("dbeta0", "energy", *shown), units).items():
            label["long_name"] += f" {words}"
            values = np.array([float(row[key]) for row in rows])
            data[dim if key == name else f"{dim}_{key}"] = xr.Variable((dim,), values, label)
        pairs = np.array([two for _, _, two in group], dtype=np.int64).reshape(-1, 2)
        data[f"{dim}_branches"] = xr.Variable((dim, "two"), pairs, {"long_name": "the two branches that meet"})
    kinds = [point.kind for _, point, _ in seen.special if point.kind != "fold"]
    data["special_kind"] = xr.Variable(("special",), np.array(kinds, dtype=str), {"long_name": "kind of special point"})
    return data


def _labels(name: str, keys: Sequence[str], units: Mapping[str, str]) -> dict[str, dict[str, str]]:
    """The attributes of the field and of what is shown, by name."""
    return {key: schema.labels(quantity_of(name).name if key == name else key, units) for key in (name, *keys)}


def _numbers(sol: Solution, keys: Sequence[str]) -> dict[str, Any]:
    """Observables, loads and values at the ends, one for each case."""
    ends = {"dbeta0": lambda: sol.dbeta[..., 0], "beta0": lambda: sol.beta[..., 0], "betaL": lambda: sol.beta[..., -1]}
    ends |= {name: partial(getattr, sol, name) for name in LOADS}
    return observe(sol, [key for key in keys if key not in ends]) | {key: ends[key]() for key in keys if key in ends}


def follow_curves(
    seen: Traced, name: str, units: Mapping[str, str], shown: Sequence[str], ends: tuple[float, float]
) -> dict[str, Any]:
    """The points of the branches over `curve_point`, and the shape in the middle of each over (shape, u).

    Of one or two branches several shapes are kept; `shape_branch` says whose they are. ends: of the axis, between which
    shapes are kept; branches may go on beyond.
    """
    solved = [solutions_of(curve, STATIONS) for curve in seen.curves]
    numbers = [
        _numbers(sol, shown)
        | {"index": curve.index, "dead_index": jacobi_zeros(sol.trajectory.orbit.exact), name: curve.values}
        | {"rho": np.broadcast_to(sol.case.rho, sol.case.shape)}
        for sol, curve in zip(solved, seen.curves, strict=True)
    ]
    data: dict[str, Any] = {}
    parts = [(piece, np.arange(piece.first, piece.last + 1)) for piece in seen.pieces]
    for key, label in (_labels(name, shown, units) | INDICES).items():
        values = np.concatenate([np.empty(0), *(numbers[piece.curve][key][at] for piece, at in parts)])
        data[f"curve_{key}"] = xr.Variable(("curve_point",), values, label)
    which = np.concatenate([np.empty(0), *(np.full(at.size, piece.number) for piece, at in parts)])
    owner = {"long_name": "number of the branch"}
    data["curve_branch"] = xr.Variable(("curve_point",), which.astype(np.int64), owner)
    middles = [(piece, at) for piece in seen.pieces for at in _places(seen, piece, ends)]
    for key in ("alpha", "z"):
        rows = [getattr(solved[piece.curve], key)[at] for piece, at in middles]
        values = np.array(rows).reshape(len(rows), STATIONS)
        data[f"shape_{key}"] = xr.Variable(("shape", "u"), values, schema.labels(key, units))
    data["shape_branch"] = xr.Variable(("shape",), np.array([p.number for p, _ in middles], dtype=np.int64), owner)
    for key, label in _labels(name, ("rho", *shown), units).items():
        values = np.array([numbers[piece.curve][key][at] for piece, at in middles], dtype=float)
        data[f"shape_{key}"] = xr.Variable(("shape",), values, label)
    return data


def _places(seen: Traced, piece: Piece, ends: tuple[float, float]) -> list[int]:
    """The points of a piece whose shapes are kept: the one in the middle of its values; of few pieces more of each."""
    values = seen.curves[piece.curve].values[piece.first : piece.last + 1]
    low, high = (float(np.clip(end, values.min(), values.max())) for end in ends)
    count = max(FEW_SHAPES // len(seen.pieces), 1)
    shares = (np.arange(count) + 0.5) / count
    goals = low + shares * (high - low)
    return sorted({piece.first + int(np.argmin(np.abs(values - goal))) for goal in goals})
