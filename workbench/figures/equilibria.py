"""All equilibria of one case: their dataset, and the figure of their developed curves and energies."""

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from solver import Case
from solver.equilibria import Equilibrium
from studies import Study

from ..data import cautions, dataset, labels, schema
from . import canvas, style

ALONG = ("beta", "alpha", "z", "contact")
EACH = ("dbeta0", "energy", "turns", "index", "attached")
WIDTH, MOST = 10.0, 40  # inches; curves shown
COLUMNS = (4, 8)  # the fewest and the most panels in a row


def dataset_of(study: Study, case: Case, found: list[Equilibrium]) -> xr.Dataset:
    """Over `equilibrium`, lowest energy first: what is listed, and along `u` the shape; the case as scalars."""
    units = study.unit_system
    data: dict[str, Any] = {}
    stations = found[0].solution.s.size if found else 2
    for name in ALONG:
        values = np.array([getattr(one.solution, name) for one in found]).reshape(len(found), stations)
        data[name] = xr.Variable(("equilibrium", "u"), values, schema.labels(name, units))
    for name in EACH:
        values = np.array([getattr(one, name) for one in found])
        data[name] = xr.Variable(("equilibrium",), values, schema.labels(name, units))
    solved = np.array([bool(one.solution.solved) for one in found], dtype=bool)
    data["solved"] = xr.Variable(("equilibrium",), solved)
    data["outcome"] = xr.Variable(("equilibrium",), np.array([str(one.solution.outcome) for one in found], dtype=str))
    solved = np.array([bool(one.solution.solved) for one in found], dtype=bool)
    data["solved"] = xr.Variable(("equilibrium",), solved)
    cautions_of = [str(cautions.of_cases(one.solution, {})) for one in found]
    data["caution"] = xr.Variable(("equilibrium",), np.array(cautions_of, dtype=str))
    u = np.linspace(0, 1, stations)
    coords = {
        "equilibrium": xr.Variable(("equilibrium",), np.arange(1, len(found) + 1), {"long_name": "rank by energy"}),
        "u": xr.Variable(("u",), u, schema.labels("u", units)),
        "s": xr.Variable(("u",), u * float(case.rod.L), schema.labels("s", units)),
    }
    ds = xr.Dataset(data, coords, attributes(study, case, "All equilibria between two ends"))
    return with_case(ds, case, units)


def attributes(study: Study, case: Case, title: str) -> dict[str, Any]:
    """What every dataset of equilibria says of itself."""
    return {
        "title": title, "study_name": "equilibria", "study": study.text, "reading": study.reading or "",
        "side": case.cylinder.side, "stiffness": case.rod.stiffness, "length_unit": study.units.length,
        "force_unit": study.units.force, "laws": json.dumps([]), "versions": json.dumps(dataset.versions()),
        "stability": "both end angles held, FZ, MZ and M3 dead loads, the ends free to move",
    }  # fmt: skip


def with_case(ds: xr.Dataset, case: Case, units: dict[str, str], skip: str = "") -> xr.Dataset:
    """The dataset with the numbers of the case as scalars, but for the axis."""
    ends = {name: getattr(case.given, name) for name in ("beta0", "betaL", "FZ", "MZ", "M3")}
    rod = {name: getattr(case.rod, name) for name in ("E", "nu", "a", "L")}
    numbers = {**rod, "R": case.cylinder.R, "rho": case.rho, **ends}
    for name, value in numbers.items():
        if name != skip and not (name == "rho" and skip in ("R", "a")):
            ds[name] = xr.Variable((), float(value), schema.labels(name, units))
    return ds


def figure(ds: xr.Dataset) -> Figure:
    """The developed curves in the order of energy, and below them energy against index."""
    count = min(ds.sizes["equilibrium"], MOST)
    columns = int(np.clip(np.ceil(np.sqrt(1.9 * count)), *COLUMNS))
    rows, cell = max(-(-count // columns), 1), WIDTH / columns + 0.1

    def draw(fig: Figure) -> None:
        grid = fig.add_gridspec(2, 1, height_ratios=[rows * cell, 2.9])
        cells = grid[0].subgridspec(rows, columns)
        half = _half_width(ds, count)
        for k in range(count):
            _draw_curve(ds, fig.add_subplot(cells[k // columns, k % columns]), k, half)
        energies(ds, fig.add_subplot(grid[1]))

    return canvas.figure((WIDTH, rows * cell + 3.6), draw, ds)


def energies(ds: xr.Dataset, ax: Axes) -> Axes:
    """Energy against index, a dot an equilibrium, in the colours of the curves."""
    ax.scatter(ds["index"], ds["energy"], c=colours(ds), s=40, edgecolors="white", linewidths=0.7, zorder=3)
    ax.set_xlabel("Morse index: number of unstable directions (0: stable)")
    ax.set_ylabel(labels.label(ds["energy"]))
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.margins(0.04, 0.08)
    stable = int((ds["index"] == 0).sum())
    counts = f"{ds.sizes['equilibrium']} equilibria, {stable} stable (red): {ds.attrs['stability']}"
    ax.set_title(f"Above: developed curves, all at one scale, the energy below each.\n{counts}", loc="left")
    return style.with_grid(ax)


def colours(ds: xr.Dataset) -> list[Any]:
    """The colour of each by its index; the stable ones stand out."""
    ramp = style.ramp_colours(int(ds["index"].max()) + 1 if ds["index"].size else 1)
    return [style.STABLE if i == 0 else ramp[i] for i in ds["index"].values]


def _curve(ds: xr.Dataset, k: int) -> tuple[Any, Any]:
    one = ds.isel(equilibrium=k)
    return float(one["rho"]) * (one["alpha"].values - one["alpha"].values[0]), one["z"].values


def _half_width(ds: xr.Dataset, count: int) -> float:
    """Half of the widest or tallest curve: one scale for all."""
    curves = [_curve(ds, k) for k in range(count)]
    return 0.53 * max((max(np.ptp(x), np.ptp(z)) for x, z in curves), default=1.0)


def _draw_curve(ds: xr.Dataset, ax: Axes, k: int, half: float) -> None:
    x, z = _curve(ds, k)
    one = ds.isel(equilibrium=k)
    ax.plot(x, z, color=colours(ds)[k], linewidth=1.5, solid_capstyle="round")
    ax.plot(x[0], z[0], "o", color=style.INK, markersize=3)
    middle = (x.max() + x.min()) / 2, (z.max() + z.min()) / 2
    ax.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half), xticks=[], yticks=[])
    ax.set_aspect("equal")
    for spine in ax.spines.values():
        spine.set(visible=True, color=style.FAINT)
    ax.set_title(f"{k + 1}  index {int(one['index'])}", loc="left", size=style.SMALL, pad=2)
    ax.set_xlabel(labels.value(float(one["energy"]), one["energy"]), size=style.SMALL, labelpad=1)
