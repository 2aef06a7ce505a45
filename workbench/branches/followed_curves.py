"""What a diagram of branches is drawn from: the followed curves, their special points and a shape of each branch."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import Branch, Solution
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
    for dim, group in (
        ("fold", [event for event in seen.special if event[1].kind == "fold"]),
        ("special", [event for event in seen.special if event[1].kind != "fold"]),
    ):
        keys = list(dict.fromkeys(("dbeta0", "energy", *shown)))
        numbers = {key: [_at(branch, point.position, key) for branch, point, _ in group] for key in keys}
        for key, row in ((name, name), *((key, key) for key in keys)):
            values = [point.value for _, point, _ in group] if key == name else numbers[key]
            labels = schema.labels(quantity_of(row).name if key == name else row, units)
            labels["long_name"] += (
                " where two equilibria meet and cease to exist" if dim == "fold" else " where branches meet or end"
            )
            data[dim if key == name else f"{dim}_{key}"] = xr.Variable((dim,), np.array(values, dtype=float), labels)
        pairs = np.array([two for _, _, two in group], dtype=np.int64).reshape(-1, 2)
        data[f"{dim}_branches"] = xr.Variable((dim, "two"), pairs, {"long_name": "the two branches that meet"})
    kinds = [point.kind for _, point, _ in seen.special if point.kind != "fold"]
    data["special_kind"] = xr.Variable(("special",), np.array(kinds, dtype=str), {"long_name": "kind of special point"})
    return data


def _at(branch: Branch, position: int, key: str) -> float:
    return float(_numbers(branch.points[position].solution, [key])[key])


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
    keys = list(dict.fromkeys(shown))
    numbers = [
        _numbers(sol, keys) | {"index": curve.index, "dead_index": jacobi_zeros(sol.trajectory.orbit.exact)}
        for sol, curve in zip(solved, seen.curves, strict=True)
    ]
    parts = [(piece, np.arange(piece.first, piece.last + 1)) for piece in seen.pieces]
    dims = ("curve_point",)
    columns = {f"curve_{key}": ([numbers[p.curve][key][at] for p, at in parts], key) for key in keys}
    columns |= {f"curve_{name}": ([seen.curves[p.curve].values[at] for p, at in parts], quantity_of(name).name)}
    data: dict[str, Any] = {
        key: xr.Variable(dims, _join(values), schema.labels(row, units)) for key, (values, row) in columns.items()
    }
    which = [np.full(at.size, piece.number) for piece, at in parts]
    data["curve_branch"] = xr.Variable(dims, _join(which).astype(np.int64), {"long_name": "number of the branch"})
    for key in ("index", "dead_index"):
        data[f"curve_{key}"] = xr.Variable(dims, _join([numbers[p.curve][key][at] for p, at in parts]), INDICES[key])
    middles = [(piece, at) for piece in seen.pieces for at in _places(seen, piece, ends)]
    for key in ("alpha", "z"):
        rows = [getattr(solved[piece.curve], key)[at] for piece, at in middles]
        values = np.array(rows).reshape(len(rows), STATIONS)
        data[f"shape_{key}"] = xr.Variable(("shape", "u"), values, schema.labels(key, units))
    owners = np.array([piece.number for piece, _ in middles], dtype=np.int64)
    data["shape_branch"] = xr.Variable(("shape",), owners, {"long_name": "number of the branch"})
    rho = [float(np.broadcast_to(solved[p.curve].case.rho, solved[p.curve].case.shape)[at]) for p, at in middles]
    data["shape_rho"] = xr.Variable(("shape",), np.array(rho, dtype=float), schema.labels("rho", units))
    for key in (name, *keys):
        each = [seen.curves[p.curve].values[at] if key == name else numbers[p.curve][key][at] for p, at in middles]
        row = quantity_of(name).name if key == name else key
        data[f"shape_{key}"] = xr.Variable(("shape",), np.array(each, dtype=float), schema.labels(row, units))
    return data


def _join(parts: list[NDArray[Any]]) -> NDArray[Any]:
    return np.concatenate([np.asarray(part, dtype=float) for part in parts]) if parts else np.empty(0)


def _places(seen: Traced, piece: Piece, ends: tuple[float, float]) -> list[int]:
    """The points of a piece whose shapes are kept: the one in the middle of its values; of few pieces more of each."""
    values = seen.curves[piece.curve].values[piece.first : piece.last + 1]
    low, high = (float(np.clip(end, values.min(), values.max())) for end in ends)
    count = max(FEW_SHAPES // len(seen.pieces), 1)
    shares = (np.arange(count) + 0.5) / count
    goals = low + shares * (high - low)
    return sorted({piece.first + int(np.argmin(np.abs(values - goal))) for goal in goals})
