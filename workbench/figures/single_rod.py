"""One rod along its length: its angle, the push of the cylinder, and its developed curve."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from solver.mechanics.contact import push_from
from solver.problem.errors import InputError, no_such

from ..data import labels
from ..data.cautions import SLIGHT
from . import canvas, developed, legend, long_curve, push_scale, style
from .scales import Ticks, angle_locator
from .sheet import SCREEN, Sheet

SIZE = (9.6, 8.0)  # inches
FINE = 4001  # stations of a diagram, two for each pixel: fewer cut off the peaks of push
FINE_IN_LINES = 20_001
CURVE = "unrolled view, seen from outside"
DOTS = {"linestyle": "none", "marker": ".", "markersize": 3}


def pushes(ds: xr.Dataset) -> Any:
    """The cylinder's push along one rod, (n,) [force/length], negative where it would have to pull."""
    return push_from(ds["contact"].values, str(ds.attrs.get("side", "outside")))


def figure(ds: xr.Dataset, sheet: Sheet = SCREEN) -> Figure:
    """The angle, the push and the developed curve of a dataset of one case; what is not stored is left out.

    The case is solved again at as many stations as the diagrams have pixels. Raises `InputError` for a panel that the
    figure has not.
    """
    ds = _at_pixels(ds)
    panels = [panel for panel, name in ((angle, "beta"), (contact, "contact")) if name in ds.data_vars]
    panels += [curve] if developed.has_curve(ds) else []
    panels = [panel for panel in panels if sheet.panel in (None, NAMES[panel])]
    if not panels:
        raise no_such("panel", sheet.panel, NAMES.values())
    each = SIZE[1] / 3 * max(sheet.width / SIZE[0], 0.7)
    lines = _lines(ds, sheet.width) if curve in panels else None
    heights = [lines.height + 1.0 if panel is curve and lines else each for panel in panels]

    def draw(fig: Figure) -> None:
        grid = fig.add_gridspec(len(panels), 1, height_ratios=heights)
        notes: list[str] = []
        for i, panel in enumerate(panels):
            ax = fig.add_subplot(grid[i, 0])
            if panel is curve and lines:
                notes = _in_lines(ds, ax, lines)
            else:
                panel(ds, ax)
        entries = [handle for ax in fig.axes for handle in ax.get_legend_handles_labels()[0]]
        legend.below(fig, [one for one in entries if isinstance(one, PolyCollection)], notes, sheet)

    return canvas.figure((sheet.width, sum(heights) + 0.3), draw, ds, sheet=sheet)


def _curve(ds: xr.Dataset) -> long_curve.Curve | None:
    """The developed curve; None where the rod is not solved."""
    found = developed.curve(ds, {})
    if found is None:
        return None
    push = pushes(ds) if "contact" in ds.data_vars else None
    rho, a = (float(ds[name]) if name in ds.variables else 0.0 for name in ("rho", "a"))
    return long_curve.Curve(ds["s"].values, found[1], found[0], push, rho, rho + a)


def _lines(ds: xr.Dataset, width: float) -> long_curve.Lines | None:
    """The lines in which a long rod is set on a figure of that width in inches."""
    found = _curve(ds)
    return long_curve.lines_for(found, long_curve.room(width)) if found else None


def _in_lines(ds: xr.Dataset, ax: Axes, lines: long_curve.Lines) -> list[str]:
    """The developed curve of a long rod; what is to be said of its lines."""
    found = _curve(ds)
    assert found is not None
    unit = labels.unit(str(ds.attrs["length_unit"]))
    ax.set_title(style.wrap(_title(ds, CURVE), ax), loc="left")
    return long_curve.draw(ax, found, lines, unit, _is_coarse(ds))


def _at_pixels(ds: xr.Dataset) -> xr.Dataset:
    """The dataset with its arrays at `FINE` stations; as it is where its case cannot be solved again."""
    from ..run import stored_case  # it loads the solver

    names = [name for name in ("beta", "alpha", "z", "contact") if name in ds.data_vars]
    is_long = developed.has_curve(ds) and _lines(ds, SIZE[0]) is not None
    finer = ds.drop_dims("u").assign_coords(u=np.linspace(0.0, 1.0, FINE_IN_LINES if is_long else FINE))
    try:
        sol = stored_case.solve_at(finer, stored_case.study_of(ds), {})
    except InputError:
        return ds
    if not (names and np.all(sol.solved)):
        return ds
    arrays = {name: ("u", np.ravel(getattr(sol, name)), ds[name].attrs) for name in names}
    return finer.assign(arrays).assign_coords(s=("u", np.ravel(sol.s), ds["s"].attrs))


def angle(ds: xr.Dataset, ax: Axes) -> Axes:
    """beta against s, in degrees."""
    ax.plot(ds["s"], np.degrees(ds["beta"]), color=style.PUSHED, **_look(ds))
    ax.axhline(0, color=style.SOFT, linewidth=0.8)
    ax.set_ylabel("β [°]")
    ax.yaxis.set_major_locator(angle_locator(float(np.ptp(ax.get_ylim())), 1.6))
    ax.set_title(style.wrap(_title(ds, "angle from the axis to the tangent"), ax), loc="left")
    return _along(ds, ax)


def contact(ds: xr.Dataset, ax: Axes) -> Axes:
    """The push of the cylinder against s, positive on either side; shaded where the cylinder would have to pull."""
    push, unit = pushes(ds), str(ds["contact"].attrs.get("units", "1"))
    norm = push_scale.scale([push])
    pulled = push < -SLIGHT * np.abs(push).max()
    if _is_coarse(ds):
        ax.plot(ds["s"], push, color=style.PUSHED, **_look(ds))
    else:
        push_scale.line(ax, ds["s"], push, push, norm, 1.6, order=3)
    ax.axhline(0, color=style.SOFT, linewidth=0.8)
    if pulled.any() and not _is_coarse(ds):
        ax.fill_between(ds["s"], 0, 1, where=pulled, transform=ax.get_xaxis_transform(), color=style.LIFTED, alpha=0.28,
                        linewidth=0, label="the cylinder would have to pull: the rod would lift off")  # fmt: skip
        ax.fill_between(ds["s"], 0, push, where=~pulled, color=style.PUSHED, alpha=0.25, linewidth=0,
                        label="the cylinder pushes")  # fmt: skip
    ax.set_ylabel(f"push [{labels.unit(unit)}]")
    ax.set_title("push of the cylinder per length", loc="left")
    return _along(ds, ax)


def curve(ds: xr.Dataset, ax: Axes) -> Axes:
    """The developed curve as one sees it from outside: z to the right, rho alpha down.

    Each point has the colour of the push there. Both directions have one scale, unless the rod would be too thin to see
    (`developed.stretch`); then the label of an axis names the factor.
    """
    found = developed.curve(ds, {})
    unit = labels.unit(str(ds.attrs["length_unit"]))
    ax.set_title(CURVE, loc="left")
    if found is None:
        ax.text(0.5, 0.5, str(ds["outcome"].values), transform=ax.transAxes, ha="center", color=style.SOFT)
        return ax
    across, up = found
    if "contact" in ds.data_vars:
        push_scale.draw(ax, up, across, pushes(ds), width=2.4, dots=_is_coarse(ds))
    else:
        ax.plot(up, across, color=style.PUSHED, **_look(ds))
    ax.plot(up[0], across[0], "o", color=style.INK, markersize=5)
    ax.annotate("s = 0", (up[0], across[0]), (-6, 0), textcoords="offset points", ha="right", va="center",
                size=style.small())  # fmt: skip
    figure_ = ax.get_figure(root=True)
    assert figure_ is not None
    room = figure_.get_figwidth() - 1, SIZE[1] / 3 - 1
    factor = developed.stretch(float(np.ptp(up)), float(np.ptp(across)), room)
    ax.set_aspect(1 / factor)
    ax.set_xlabel(f"z [{unit}]{developed.larger(factor)}")
    ax.set_ylabel(style.wrap(f"{developed.AROUND} [{unit}]{developed.larger(1 / factor)}", ax, upward=True))
    title = f"{CURVE}, at one scale" if factor == 1 and not _is_coarse(ds) else _title(ds, CURVE)
    ax.set_title(style.wrap(title, ax), loc="left")
    ax.margins(x=max(0.08, 0.55 / style.inches(ax)[0]), y=0.15)  # room for s = 0
    ax.invert_yaxis()
    return style.with_grid(ax)


NAMES = {angle: "angle", contact: "push", curve: "curve"}  # what --panel calls them


def _is_coarse(ds: xr.Dataset) -> bool:
    return developed.has_curve(ds) and developed.too_coarse(ds, {})


def _look(ds: xr.Dataset) -> dict[str, Any]:
    """The look of a line along the rod: dots where the stations are too few for a line."""
    return DOTS if _is_coarse(ds) else {"linewidth": 1.8}


def _title(ds: xr.Dataset, title: str) -> str:
    return f"{title}; dots: {ds.sizes['u']} stations miss bends" if _is_coarse(ds) else title


def _along(ds: xr.Dataset, ax: Axes) -> Axes:
    ax.set_xlabel(f"s [{labels.unit(str(ds.attrs['length_unit']))}]")
    ax.margins(x=0)
    ax.xaxis.set_major_locator(MaxNLocator(nbins=8, steps=[1, 2, 5, 10]))
    ax.xaxis.set_major_formatter(Ticks())
    return style.with_grid(ax)
