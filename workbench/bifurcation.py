"""All equilibria over an axis: joined into branches, folds marked, the study's laws judged on each branch."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy.optimize import linear_sum_assignment

from solver import Case, equilibria
from solver.equilibria import Equilibrium
from solver.observables import observe
from studies import Study
from studies.axes import quantity_of
from studies.laws import COUNTS, Law, judge

from . import dataset, style
from .asking import with_fields
from .gallery import attributes, with_case

EACH = ("dbeta0", "energy", "turns", "index", "attached")
STATIONS = 101
NEAR = 0.35  # rad, the mean distance of beta up to which two shapes at neighbouring values are one branch
MEETING = 0.8  # rad, up to which two that end together met in a fold


def sweep(study: Study, case: Case, name: str, values: Any, step: Callable[[str], None]) -> xr.Dataset:
    """Over (axis, member), members of each value by energy, NaN beyond their number: what is listed of each, the
    observables that the study's laws on this axis judge, and `branch`, its number. Over `fold`: where two branches
    meet. Attribute `branches`: a row each, with its laws' verdicts, as JSON."""
    cases, found = [], []
    for value in values:
        step(f"{name} = {value:.4g}")
        cases.append(with_fields(case, {name: float(value)}))
        found.append(equilibria(cases[-1], stations=STATIONS))
    laws = [law for law in study.laws if law.axis == name]
    branch, meets = _joined(found)
    units = study.unit_system
    most = max((len(f) for f in found), default=0)
    wanted = list(dict.fromkeys(law.observable for law in laws if law.observable not in EACH))
    table = {key: np.full((len(found), most), np.nan) for key in (*EACH, *wanted)}
    for k, members in enumerate(found):
        for i, one in enumerate(members):
            for key in EACH:
                table[key][k, i] = getattr(one, key)
            for key, value in observe(one.solution, wanted).items():
                table[key][k, i] = value
    dims = (name, "member")
    data: dict[str, Any] = {key: xr.Variable(dims, v, dataset.labels(key, units)) for key, v in table.items()}
    data["branch"] = xr.Variable(dims, _padded(branch, most), {"long_name": "number of the branch, -1 for none"})
    outcome = [[str(f[i].solution.outcome) if i < len(f) else "" for i in range(most)] for f in found]
    data["outcome"] = xr.Variable(dims, np.array(outcome, dtype=str).reshape(len(found), most))
    folded = [_fold(lambda x: equilibria(with_fields(case, {name: x}), stations=STATIONS), values, found, *meet)
              for meet in meets]  # fmt: skip
    for i, (key, row) in enumerate((("fold", name), ("fold_dbeta0", "dbeta0"), ("fold_energy", "energy"))):
        labels = dataset.labels(quantity_of(row).name, units)
        labels["long_name"] += " where two equilibria meet and cease to exist"
        data[key] = xr.Variable(("fold",), np.array([f[i] for f in folded], dtype=float), labels)
    numbers = np.array([[branch[k][i], branch[k][j]] for k, i, j in meets], dtype=np.int64).reshape(-1, 2)
    data["fold_branches"] = xr.Variable(("fold", "two"), numbers, {"long_name": "the two branches that meet"})
    ds = xr.Dataset(data, {name: xr.Variable((name,), values, dataset.labels(quantity_of(name).name, units))})
    ds.attrs = attributes(study, case, f"All equilibria over {quantity_of(name).symbol}")
    ds.attrs["branches"] = json.dumps(_rows(ds, name, laws))
    return with_case(ds, case, units, skip=name)


def branches(ds: xr.Dataset) -> list[dict[str, Any]]:
    """A row a branch: where it begins and ends on the axis, index, turns at both ends, and each law's verdict."""
    return list(json.loads(ds.attrs["branches"]))


def folds(ds: xr.Dataset) -> list[dict[str, float]]:
    """Where two branches meet."""
    names = ("fold", "fold_dbeta0", "fold_energy")
    return [{name: float(ds[name][i]) for name in names} for i in range(ds.sizes["fold"])]


def _apart(a: list[Equilibrium], b: list[Equilibrium]) -> Any:
    """Mean distance of beta along the rod, (len(a), len(b))."""
    first, second = (np.array([one.solution.beta for one in some]) for some in (a, b))
    return np.abs(first[:, None] - second[None]).mean(axis=2)


def _joined(found: list[list[Equilibrium]]) -> tuple[list[list[int]], list[tuple[int, int, int]]]:
    """The branch of each equilibrium, and the folds: (k, i, j), members i and j at value k, the last (or first) that
    the two branches have. Along a branch the index stays and the shape changes little; at a fold two meet whose
    indices differ by one."""
    branch = [list(range(len(found[0])))] if found else []
    count = len(found[0]) if found else 0
    meets: list[tuple[int, int, int]] = []
    for k in range(1, len(found)):
        a, b = found[k - 1], found[k]
        numbers = [-1] * len(b)
        if a and b:
            apart = _apart(a, b)
            index = [np.array([one.index for one in some]) for some in (a, b)]
            cost = np.where(index[0][:, None] == index[1][None], apart, 1e3)
            for i, j in zip(*linear_sum_assignment(np.minimum(cost, 1e3)), strict=True):
                if cost[i, j] < NEAR:
                    numbers[j] = branch[-1][i]
        ended = [i for i in range(len(a)) if branch[-1][i] not in numbers]
        begun = [j for j in range(len(b)) if numbers[j] < 0]
        meets += [(k - 1, *pair) for pair in _pairs(a, ended)] + [(k, *pair) for pair in _pairs(b, begun)]
        for j in begun:
            numbers[j] = count
            count += 1
        branch.append(numbers)
    return branch, meets


def _pairs(members: list[Equilibrium], loose: list[int]) -> list[tuple[int, int]]:
    """Of those that end (or begin) here, the two and two that meet in a fold: the nearest, of neighbouring index."""
    left, out = set(loose), []
    near = [
        (float(_apart([members[i]], [members[j]])[0, 0]), i, j)
        for i in loose for j in loose if i < j and abs(members[i].index - members[j].index) == 1
    ]  # fmt: skip
    for distance, i, j in sorted(near):
        if distance < MEETING and {i, j} <= left:
            left -= {i, j}
            out.append((i, j))
    return out


def _fold(
    at: Callable[[float], list[Equilibrium]], values: Any, found: list[list[Equilibrium]], k: int, i: int, j: int
) -> tuple[float, float, float]:
    """Axis, beta'(0) and energy at a fold: the square of the distance of the two start slopes falls as a line, so it
    is drawn on to zero, from nearer and nearer."""
    two = found[k][i], found[k][j]
    begins = k + 1 == len(found) or (k > 0 and _begins(found, k, i))
    back, ahead = (k + 1, values[k - 1]) if begins else (k - 1, values[k + 1])
    middle = float(values[k] + ahead) / 2
    if not (0 <= back < len(found) and found[back]):
        return middle, *_between(two)
    x0, x1 = float(values[back]), float(values[k])
    d0, d1, end = _square(_like(found[back], two)), _square(two), middle
    for _ in range(4):
        if d0 <= d1:
            return middle, *_between(two)
        end = x1 + (x1 - x0) * d1 / (d0 - d1)
        end = float(np.clip(end, *sorted((x1, ahead))))
        x2 = x1 + 0.8 * (end - x1)
        nearer = at(x2)
        if abs(end - x1) < 1e-7 * abs(values[-1] - values[0]) or not nearer or _like(nearer, two)[0] is two[0]:
            break
        two = _like(nearer, two)
        x0, x1, d0, d1 = x1, x2, d1, _square(two)
    return end, *_between(two)


def _like(found: list[Equilibrium], two: tuple[Equilibrium, Equilibrium]) -> tuple[Equilibrium, Equilibrium]:
    """The two of them most like these; these themselves where their indices are gone."""
    out = []
    for one in two:
        same = [other for other in found if other.index == one.index]
        if not same:
            return two
        out.append(same[int(np.argmin(_apart([one], same)[0]))])
    return out[0], out[1]


def _square(two: tuple[Equilibrium, Equilibrium]) -> float:
    return (two[0].dbeta0 - two[1].dbeta0) ** 2


def _between(two: tuple[Equilibrium, Equilibrium]) -> tuple[float, float]:
    return (two[0].dbeta0 + two[1].dbeta0) / 2, (two[0].energy + two[1].energy) / 2


def _begins(found: list[list[Equilibrium]], k: int, i: int) -> bool:
    """Whether member i at value k has no like at the value before it."""
    one, before = found[k][i], [e for e in found[k - 1] if e.index == found[k][i].index]
    return not before or float(_apart([one], before).min()) >= NEAR


def _padded(rows: list[list[int]], most: int) -> Any:
    out = np.full((len(rows), most), -1, dtype=np.int64)
    for k, numbers in enumerate(rows):
        out[k, : len(numbers)] = numbers
    return out


def _rows(ds: xr.Dataset, name: str, laws: list[Law]) -> list[dict[str, Any]]:
    rows = []
    scale = 180 / np.pi if style.is_angle(ds[name]) else 1.0
    for number in range(int(ds["branch"].max()) + 1 if ds["branch"].size else 0):
        k, i = np.nonzero(ds["branch"].values == number)
        turns = ds["turns"].values[k, i].astype(int)
        row: dict[str, Any] = {
            "branch": number, "from": float(ds[name].values[k[0]] * scale), "to": float(ds[name].values[k[-1]] * scale),
            "values": int(k.size), "index": int(ds["index"].values[k[0], i[0]]),
            "turns": f"{turns[0]} to {turns[-1]}" if turns[0] != turns[-1] else str(turns[0]),
        }  # fmt: skip
        for law in laws:
            values = ds[law.observable].values[k, i]
            whole = values.astype(int) if law.observable in COUNTS else values
            said = judge(whole, law.direction)
            row[f"{law.observable} {law.direction}"] = said.verdict if k.size > 2 else "too short"
        rows.append(row)
    return rows


def figure(ds: xr.Dataset, path: Path) -> Figure:
    """beta'(0) and energy against the axis: stable branches solid, unstable ones thin, folds marked; where laws were
    judged, the branches on which all hold have a colour. Saved by the name's ending."""
    style.picture_kind(path, (".png", ".pdf", ".svg"))
    with rc_context(style.RC):
        fig = Figure(figsize=(9.6, 9.2), layout="constrained")
        FigureCanvasAgg(fig)
        for i, key in enumerate(("dbeta0", "energy")):
            panel(ds, fig.add_subplot(2, 1, i + 1), key)
        style.entitle(fig, ds)
        fig.savefig(path)
    return fig


def panel(ds: xr.Dataset, ax: Axes, key: str) -> Axes:
    """One quantity of each equilibrium against the axis, a line a branch."""
    name = str(ds["outcome"].dims[0])
    along = np.degrees(ds[name].values) if style.is_angle(ds[name]) else ds[name].values
    for row in branches(ds):
        k, i = np.nonzero(ds["branch"].values == row["branch"])
        look, label = _look(row)
        ax.plot(along[k], ds[key].values[k, i], label=label, solid_capstyle="round",
                marker="." if k.size == 1 else "", **look)  # fmt: skip
    at = np.degrees(ds["fold"].values) if style.is_angle(ds[name]) else ds["fold"].values
    share = np.linspace(0, 1, 21)  # next to a fold a branch is a parabola
    for which, pair in enumerate(ds["fold_branches"].values):
        fold, there = at[which], float(ds[f"fold_{key}"][which])
        for row in branches(ds):
            if row["branch"] in pair:
                k, i = np.nonzero(ds["branch"].values == row["branch"])
                tip = 0 if abs(along[k[0]] - fold) < abs(along[k[-1]] - fold) else -1
                last = ds[key].values[k[tip], i[tip]]
                bend = fold + (along[k[tip]] - fold) * share**2, there + (last - there) * share
                ax.plot(*bend, **_look(row)[0])
        ax.plot(fold, there, "o", color=style.INK, markersize=4, fillstyle="none", label="fold", zorder=5)
    ax.set_xlabel(style.axis_label(name, ds[name]))
    ax.set_ylabel(style.label(ds[key]))
    ax.margins(x=0.01)
    if key == "dbeta0":
        handles, labels = ax.get_legend_handles_labels()
        once = dict(zip(labels, handles, strict=True))
        ax.legend(list(once.values()), list(once), loc="lower left", bbox_to_anchor=(0, 1), ncols=5)
    return style.quiet(ax)


def _look(row: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """How a branch is drawn, and what that means."""
    verdicts = [v for key, v in row.items() if " " in key]
    holds = bool(verdicts) and all(v == "holds" for v in verdicts)
    stable = row["index"] == 0
    colour = style.PUSHED if holds else style.INK if stable else style.SOFT
    look = {"color": colour, "linewidth": 2.6 if stable else 1.3, "zorder": 4 if stable else 3 if holds else 2}
    if not stable and not holds:
        look["alpha"] = 0.55
    return look, ("stable" if stable else "unstable") + (", the study's laws hold" if holds else "")
