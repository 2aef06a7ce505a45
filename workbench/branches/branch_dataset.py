"""All equilibria over an axis as a dataset: their branches with the study's laws judged on each, and what the diagram
shows."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import Branch, Case, Solution
from solver.equilibria import Equilibrium
from solver.follow import solutions_of
from solver.observe.observables import OBSERVABLES, observe
from solver.orbits.periodic_orbit import jacobi_zeros
from solver.problem.errors import check_known
from solver.problem.quantities import current
from studies import Study
from studies.grammar.axes import quantity_of
from studies.laws.case_rows import Grid
from studies.laws.judgement import Law, decide
from studies.laws.line_verdicts import QUALIFIED

from ..stored import quantity_variables
from ..stored.stored_cases import BACK
from ..stored.stored_study import StoredStudy
from .equilibria_dataset import COUNT, EACH, PUSH, attributes, numbers_of, stability, with_case
from .tracing import PARTNER, Piece, Step, Traced, trace_branches, trace_held

STATIONS = 101
SHAPE_STATIONS = 161
FEW_SHAPES = 8  # in a row: one or two branches have so many together
OWN = ("dbeta0", "beta0", "betaL", *quantity_variables.LOADS)  # what a diagram may show beside observables
FROM_ZERO = "number of the branch, from 0: one less than is printed"
NAMES = tuple(dict.fromkeys((*OWN, *OBSERVABLES)))
IS_BACK = {"long_name": "whether the rod turns back against both its ends"}
INDICES = {
    "index": {"units": "1", "long_name": "Morse index under the ends of the case"},
    "dead_index": {"units": "1", "long_name": "Morse index between the same end angles under dead loads"},
}


def sweep(
    study: Study, case: Case, name: str, values: Any, step: Step, show: str | None = None, points: int | None = None
) -> xr.Dataset:
    """All equilibria of an ends problem at each value of one field, joined into branches.

    Parameters
    ----------
    study
        The study of the case: its units, and the laws to judge on each branch.
    case
        The ends problem.
    name, values
        The field that varies and its values, (n,), rising; angles in rad.
    step
        Called with words, how much is done, and of how much.
    show
        The observable, or dbeta0, that a diagram shows over the axis; default: `default_observable`.
    points
        As of `tracing.trace_branches`.

    Returns
    -------
    Over (axis, member), members by rising energy and NaN beyond their number: the numbers of `EACH`, the observables
    of the study's laws on this axis, the outcome, and `branch`, the number of the branch (-1: no member). Over
    `fold`: where two branches meet. Over `special`: where other branches meet. Over `curve_point`: the branches as they
    were followed. Over (shape, u): a shape of each. The attribute `branches` holds a row for each branch, with the
    verdict of each law, as JSON.
    """
    on_axis = [law for law in study.laws if law.axis == name and law.direction is not None]
    laws = [law for law in on_axis if set(law.observables) <= set(OBSERVABLES)]  # formulas are those of a stored study
    units = study.unit_system
    held = name in PARTNER
    trace = trace_held if held else trace_branches
    seen = trace(case, name, [float(x) for x in values], STATIONS, step, points)
    judged = [*dict.fromkeys(key for law in laws for key in law.observables if key not in EACH), *PUSH]
    rows = [
        [_numbers(member, judged) | {"branch": number} for member, number in zip(members, numbers, strict=True)]
        for members, numbers in zip(seen.found, seen.branch, strict=True)
    ]
    most = max(map(len, rows), default=0)
    blank = dict.fromkeys((*EACH, *judged), np.nan) | {"branch": -1, "solved": False, "outcome": ""}

    def column(key: str, kind: type, label: Mapping[str, str]) -> xr.Variable:
        padded = [[row[key] for row in (*members, *[blank] * (most - len(members)))] for members in rows]
        return xr.Variable((name, "member"), np.array(padded, dtype=kind).reshape(len(rows), most), label)

    data: dict[str, Any] = {key: column(key, float, quantity_variables.labels(key, units)) for key in (*EACH, *judged)}
    if not held:
        data["count"] = xr.Variable((name,), np.array(list(map(len, rows))), COUNT)
    data["branch"] = column("branch", np.int64, {"long_name": f"{FROM_ZERO}; -1 for none"})
    data |= {"solved": column("solved", bool, {}), "outcome": column("outcome", str, {})}
    chosen = default_observable(name) if show is None else show
    shown = (chosen,) if held else (chosen, "energy")
    data |= special_points(seen, name, units, shown)
    solved = list[Solution]()
    for curve in seen.curves:
        step(f"shapes of branch {len(solved) + 1}", len(solved), len(seen.curves))
        solved.append(solutions_of(curve, SHAPE_STATIONS))
    data |= follow_curves(seen, solved, name, units, shown, (values[0], values[-1]))
    axis = xr.Variable((name,), values, quantity_variables.labels(quantity_of(name).name, units))
    ds = xr.Dataset(data, {name: axis})
    every = "Equilibria with a held" if held else "All equilibria over"
    ds.attrs = attributes(study, case, f"{every} {quantity_of(name).symbol}")
    if held:
        ds.attrs["stability"] = stability(seen.curves[0].points[0].case) if seen.curves else ""
    ds.attrs["branches"] = json.dumps(_rows(ds, name, laws, seen, solved))
    ds.attrs |= {"axis": name, "shown": shown[0], "remarks": json.dumps(seen.remarks)}
    ds = with_case(ds, case, units, (name, PARTNER.get(name, name)))
    return ds.drop_dims([dim for dim, size in ds.sizes.items() if not size])  # a file holds no empty array


def folds(stored: StoredStudy) -> list[dict[str, Any]]:
    """Axis value, beta'(0) and energy of each fold, and the two branches that meet there, numbered as printed."""
    names = ("fold", "fold_dbeta0", "fold_energy")
    return [
        {name: float(stored[name][i]) for name in names}
        | {"numbers": sorted((stored["fold_branches"].values[i] + 1).tolist())}
        for i in range(stored.sizes.get("fold", 0))
    ]


def _numbers(member: Equilibrium, judged: Sequence[str]) -> dict[str, Any]:
    """The numbers of `EACH`, the observables of the laws, and the outcome of an equilibrium."""
    sol = member.solution
    numbers = {key: getattr(member, key) for key in EACH} | observe(sol, judged)
    return numbers | {"solved": bool(sol.solved), "outcome": str(sol.outcome)}


def _bends(solved: Solution, piece: Piece) -> NDArray[np.int64]:
    """Numbers of bends of the solved points of a piece between its ends; solved: all points of its curve."""
    inner = observe(solved, ["bends"])["bends"][piece.first + 1 : piece.last]
    return inner[np.isfinite(inner)].astype(np.int64)


def _rows(ds: xr.Dataset, name: str, laws: list[Law], seen: Traced, solved: Sequence[Solution]) -> list[dict[str, Any]]:
    """A row for each branch: the values of the axis at its ends, index, number of bends, and each law's verdict.

    solved: the points of each curve.
    """
    rows = []
    scale = 180 / np.pi if ds[name].attrs["units"] == "rad" else 1.0
    for piece in seen.pieces:
        k, i = np.nonzero(ds["branch"].values == piece.number)
        points = seen.curves[piece.curve].points[piece.first : piece.last + 1]
        bends = ds["bends"].values[k, i].astype(int)
        ends = sorted(point.value for point in (points[0], points[-1]))
        row: dict[str, Any] = {
            "branch": piece.number,
            "from": float(ends[0] * scale),
            "to": float(ends[1] * scale),
            "values": len(points) if name in PARTNER else int(k.size),
            "index": points[len(points) // 2].index,
            "bends": _range(bends if k.size else _bends(solved[piece.curve], piece)),
        }
        for law in laws:
            key = f"{law.observable} {law.direction}"
            if k.size <= 2:
                row[key] = "too short"
                continue
            observed = {observable: ds[observable].values[k, i] for observable in law.observables}
            said = decide(law, observed, Grid({name: ds[name].values[k]}))
            kinds = f": {', '.join(said['qualifications'])}" if said["verdict"] == QUALIFIED else ""
            row[key] = said["verdict"] + kinds
        rows.append(row)
    return rows


def _range(counts: NDArray[np.int64]) -> str:
    if not counts.size:
        return ""
    return f"{counts[0]} to {counts[-1]}" if counts[0] != counts[-1] else str(counts[0])


def default_observable(name: str) -> str:
    """What a diagram over a field shows: the displacement that goes with a load, or the load that holds it."""
    return PARTNER.get(name, "turns_around" if name in ("MZ", "M3") else "height")


def check_shown(name: str) -> str:
    """The name of what a diagram can show, a former one as that of today. Raises `InputError` for any other."""
    name = current(name)
    check_known("quantity to show", name, NAMES)
    return name


def special_points(seen: Traced, name: str, units: Mapping[str, str], shown: Sequence[str]) -> dict[str, Any]:
    """The folds over `fold`, and the other special points over `special`."""
    data = dict[str, Any]()
    for dim, words, group in (
        ("fold", "where two equilibria meet and cease to exist", [e for e in seen.special if e[1].kind == "fold"]),
        ("special", "where branches meet or end", [e for e in seen.special if e[1].kind != "fold"]),
    ):
        rows = [
            numbers_of(branch.points[point.position].solution, ("dbeta0", "energy", *shown, BACK)) | {name: point.value}
            for branch, point, _ in group
        ]
        for key, label in _labels(name, ("dbeta0", "energy", *shown), units).items():
            label["long_name"] += f" {words}"
            values = np.array([float(row[key]) for row in rows])
            data[dim if key == name else f"{dim}_{key}"] = xr.Variable((dim,), values, label)
        data[f"{dim}_{BACK}"] = xr.Variable((dim,), np.array([bool(row[BACK]) for row in rows], dtype=bool), IS_BACK)
        pairs = np.array([two for _, _, two in group], dtype=np.int64).reshape(-1, 2)
        data[f"{dim}_branches"] = xr.Variable(
            (dim, "two"), pairs, {"long_name": f"the two branches that meet; {FROM_ZERO}"}
        )
    kinds = [point.kind for _, point, _ in seen.special if point.kind != "fold"]
    data["special_kind"] = xr.Variable(("special",), np.array(kinds, dtype=str), {"long_name": "kind of special point"})
    return data


def _labels(name: str, keys: Sequence[str], units: Mapping[str, str]) -> dict[str, dict[str, str]]:
    """The attributes of the field and of what is shown, by name."""
    return {
        key: quantity_variables.labels(quantity_of(name).name if key == name else key, units) for key in (name, *keys)
    }


def _known(sol: Solution, curve: Branch) -> NDArray[np.bool_]:
    """Which points of a branch have numbers: at a fold the condition number alone may say that one is not solved."""
    known = np.array(sol.solved, dtype=bool)
    known[[point.position for point in curve.special]] = True
    return known


def follow_curves(
    seen: Traced,
    solved: Sequence[Solution],
    name: str,
    units: Mapping[str, str],
    shown: Sequence[str],
    ends: tuple[float, float],
) -> dict[str, Any]:
    """The points of the branches over `curve_point`, and the shape in the middle of each over (shape, u).

    Of one or two branches several shapes are kept; `shape_branch` says whose they are. solved: the points of each
    curve. ends: of the axis, between which shapes are kept; branches may go on beyond.
    """
    known = [_known(sol, curve) for sol, curve in zip(solved, seen.curves, strict=True)]
    numbers = [
        {key: np.where(mine, values, np.nan) for key, values in numbers_of(sol, shown).items()}
        | numbers_of(sol, [BACK])
        | {"index": curve.index, "dead_index": _dead_indices(sol), name: curve.values}
        | {"rho": np.broadcast_to(sol.case.rho, sol.case.shape)}
        for sol, curve, mine in zip(solved, seen.curves, known, strict=True)
    ]
    data: dict[str, Any] = {}
    parts = [(piece, np.arange(piece.first, piece.last + 1)) for piece in seen.pieces]
    for key, label in (_labels(name, shown, units) | INDICES).items():
        values = np.concatenate([np.empty(0), *(numbers[piece.curve][key][at] for piece, at in parts)])
        data[f"curve_{key}"] = xr.Variable(("curve_point",), values, label)
    values = np.concatenate([np.empty(0, bool), *(numbers[piece.curve][BACK][at] for piece, at in parts)])
    data[f"curve_{BACK}"] = xr.Variable(("curve_point",), values, IS_BACK)
    which = np.concatenate([np.empty(0), *(np.full(at.size, piece.number) for piece, at in parts)])
    owner = {"long_name": FROM_ZERO}
    data["curve_branch"] = xr.Variable(("curve_point",), which.astype(np.int64), owner)
    middles = [(piece, at) for piece in seen.pieces for at in _places(seen, piece, ends, known[piece.curve])]
    for key in ("alpha", "z"):
        rows = [getattr(solved[piece.curve], key)[at] for piece, at in middles]
        values = np.array(rows).reshape(len(rows), SHAPE_STATIONS)
        data[f"shape_{key}"] = xr.Variable(("shape", "u"), values, quantity_variables.labels(key, units))
    data["shape_branch"] = xr.Variable(("shape",), np.array([p.number for p, _ in middles], dtype=np.int64), owner)
    for key, label in _labels(name, ("rho", *shown), units).items():
        values = np.array([numbers[piece.curve][key][at] for piece, at in middles], dtype=float)
        data[f"shape_{key}"] = xr.Variable(("shape",), values, label)
    values = np.array([numbers[piece.curve][BACK][at] for piece, at in middles], dtype=bool)
    return data | {f"shape_{BACK}": xr.Variable(("shape",), values, IS_BACK)}


def _dead_indices(sol: Solution) -> NDArray[np.float64]:
    """The Morse index of each point under dead loads, between its own end angles.

    NaN where it is not decided, and with weight or friction.
    """
    known, orbit = sol.trajectory.dead_index, sol.trajectory.orbit
    if known is None:
        return np.full(sol.case.size, np.nan) if orbit is None else jacobi_zeros(orbit.exact)
    return known


def _places(seen: Traced, piece: Piece, ends: tuple[float, float], known: NDArray[np.bool_]) -> list[int]:
    """The points of a piece whose shapes are kept: the one in the middle of its values; of few pieces more of each.

    None is a special point, where a rod is not determined by its case, unless the piece has no other. known: which
    points of its curve have numbers.
    """
    curve = seen.curves[piece.curve]
    able = piece.first + np.flatnonzero(known[piece.first : piece.last + 1])
    if not able.size:
        return []
    ordinary = np.setdiff1d(able, [point.position for point in curve.special])
    able = ordinary if ordinary.size else able
    values = curve.values[able]
    low, high = (float(np.clip(end, values.min(), values.max())) for end in ends)
    count = max(FEW_SHAPES // len(seen.pieces), 1)
    shares = (np.arange(count) + 0.5) / count
    goals = low + shares * (high - low)
    return sorted({int(able[np.argmin(np.abs(values - goal))]) for goal in goals})
