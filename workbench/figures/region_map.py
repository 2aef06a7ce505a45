"""The map of a dataset of regions: the number of equilibria over two fields, fold curves, cusps, stable shapes."""

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..data import labels
from . import canvas, legend, region_raster, style
from .region_numbers import placed
from .sheet import SCREEN, Sheet

HIGH = 0.72  # height of the map over its width


def figure(ds: xr.Dataset, sheet: Sheet = SCREEN) -> Figure:
    """The map: colours and numbers by region, curves where stable equilibria appear or disappear thick.

    A shape stands beside the number where there is room: the developed curves of the stable equilibria there.
    """
    high = sheet.width * (HIGH if not sheet.narrow else 1.0)

    def draw(fig: Figure) -> None:
        ax = fig.add_subplot()
        box = sheet.width - 1.1, high - 0.6
        notes, colours = panel(ds, ax, box)
        legend.below(fig, [*colours, *entries(ds)], notes)

    return canvas.figure((sheet.width, high + 0.75 * sheet.titled + 0.5), draw, ds, sheet=sheet)


def panel(ds: xr.Dataset, ax: Axes, inches: tuple[float, float]) -> tuple[list[str], list[Artist]]:
    """Draw the map on axes of about that width and height.

    Returns notes on what is drawn, and for the legend the colours that no number explains.
    """
    x, y = json.loads(ds.attrs["fields"])
    edges = [labels.in_label_unit(ds[name], np.array([ds.attrs[end][k] for end in ("low", "high")]))
             for k, name in enumerate((x, y))]  # fmt: skip
    lines = [np.transpose([labels.in_label_unit(ds[name], ds[f"curve_{name}"].values[k]) for name in (x, y)])
             for k in range(ds.sizes["curve"])]  # fmt: skip
    low, size = (np.array([[ends[0], np.ptp(ends)] for ends in edges]).T[k] for k in (0, 1))
    regions = region_raster.fine(ds["region_at"].values, [(line - low) / size for line in lines])
    counts = np.append(ds["count"].values, 0)[regions].astype(float)
    counts[regions < 0] = np.nan
    known = np.unique(counts[np.isfinite(counts)])
    ramp = ListedColormap(style.map_colours(max(known.size, 2))(np.arange(max(known.size, 1))))
    ax.imshow(np.searchsorted(known, np.where(np.isnan(counts), known[:1], counts)), cmap=ramp, origin="lower",
              extent=(*edges[0], *edges[1]), aspect="auto", interpolation="nearest", alpha=0.8,
              vmin=-0.5, vmax=max(known.size, 2) - 0.5, zorder=0)  # fmt: skip
    for k, line in enumerate(lines):
        ax.plot(*line.T, zorder=3, solid_capstyle="round", **_look(ds, k))
    cusps = [labels.in_label_unit(ds[name], ds[f"cusp_{name}"].values) for name in (x, y)]
    ax.plot(*cusps, "D", color="white", markeredgecolor=style.INK, markersize=4, zorder=5, linestyle="none")
    ax.set(xlim=edges[0], ylim=edges[1], xlabel=labels.axis_label(x, ds[x]), ylabel=labels.axis_label(y, ds[y]))
    notes, left_out = placed(ds, ax, inches, _texts(ds))
    told = {int(count) for k, count in enumerate(ds["count"].values) if k not in left_out}
    unsaid = sorted({int(ds["count"].values[k]) for k in left_out} - told)
    colours = {count: ramp(int(np.searchsorted(known, count)))[:3] for count in unsaid}
    return notes, [Patch(color=(*colours[count], 0.8), label=f"{count} equilibria") for count in unsaid]


def entries(ds: xr.Dataset) -> list[Artist]:
    """The legend of the curves and the cusps."""
    words = {
        ("fold", True): "fold of a stable and an unstable equilibrium",
        ("fold", False): "fold of two unstable equilibria",
        ("pitchfork", True): "pitchfork of a stable equilibrium",
        ("pitchfork", False): "pitchfork of an unstable equilibrium",
    }
    out: list[Artist] = []
    seen = set()
    for k in range(ds.sizes["curve"]):
        key = str(ds["curve_kind"].values[k]), bool(ds["curve_index"].values[k] == 0)
        if key not in seen:
            seen.add(key)
            out.append(Line2D([], [], label=words[key], **_look(ds, k)))
    if ds.sizes["cusp"]:
        out.append(Line2D([], [], marker="D", linestyle="none", color="white", markeredgecolor=style.INK, markersize=4,
                          label="cusp"))  # fmt: skip
    return out


def _look(ds: xr.Dataset, k: int) -> dict[str, Any]:
    stable = int(ds["curve_index"].values[k]) == 0
    return {
        "color": style.INK,
        "linewidth": 2.4 if stable else 0.9,
        "linestyle": "-" if str(ds["curve_kind"].values[k]) == "fold" else (0, (4, 2)),
    }


def _texts(ds: xr.Dataset) -> list[str]:
    """``13, 2 stable`` for each region."""
    pairs = zip(ds["count"].values, ds["count_stable"].values, strict=True)
    return [f"{count}, {stable} stable" for count, stable in pairs]
