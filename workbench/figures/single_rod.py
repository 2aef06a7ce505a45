"""One rod along its length: its angle, the push of the cylinder, and its developed curve."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solver.mechanics.contact import push_from
from solver.problem.errors import InputError, no_such

from ..data import labels
from . import canvas, developed, legend, push_scale, style
from .sheet import SCREEN, Sheet

SIZE = (9.6, 8.0)  # inches
FINE = 4001  # stations of a diagram, two for each pixel: fewer cut off the peaks of push
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
    count = len(panels)

    def draw(fig: Figure) -> None:
        for i, panel in enumerate(panels):
            panel(ds, fig.add_subplot(count, 1, i + 1))

    height = SIZE[1] * max(sheet.width / SIZE[0], 0.7)
    return canvas.figure((sheet.width, height * count / 3), draw, ds, sheet=sheet)


def _at_pixels(ds: xr.Dataset) -> xr.Dataset:
    """The dataset with its arrays at `FINE` stations; as it is where its case cannot be solved again."""
    from ..run import stored_case  # it loads the solver

    names = [name for name in ("beta", "alpha", "z", "contact") if name in ds.data_vars]
    finer = ds.drop_dims("u").assign_coords(u=np.linspace(0.0, 1.0, FINE))
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
    ax.set_title(_title(ds, "angle from the axis to the tangent"), loc="left")
    return _along(ds, ax)


def contact(ds: xr.Dataset, ax: Axes) -> Axes:
    """The push of the cylinder against s, positive on either side; shaded where the cylinder would have to pull."""
    push, unit = pushes(ds), str(ds["contact"].attrs.get("units", "1"))
    norm = push_scale.scale([push])
    pulled = push < (norm.vmin or 0.0)
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
        legend.add(ax, loc="lower right", bbox_to_anchor=(1, 1), ncols=2, borderaxespad=0.2)
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
    title = "developed curve (unrolled cylinder), seen from outside"
    ax.set_title(title, loc="left")
    if found is None:
        ax.text(0.5, 0.5, str(ds["outcome"].values), transform=ax.transAxes, ha="center", color=style.SOFT)
        return ax
    across, up = found
    if "contact" in ds.data_vars:
        push_scale.draw(ax, up, across, pushes(ds), width=2.4, dots=_is_coarse(ds))
    else:
        ax.plot(up, across, color=style.PUSHED, **_look(ds))
    ax.plot(up[0], across[0], "o", color=style.INK, markersize=5)
    ax.annotate("s = 0", (up[0], across[0]), (0, 6), textcoords="offset points", ha="center", va="bottom",
                size=style.small())  # fmt: skip
    figure_ = ax.get_figure(root=True)
    assert figure_ is not None
    room = figure_.get_figwidth() - 1, SIZE[1] / 3 - 1
    factor = developed.stretch(float(np.ptp(up)), float(np.ptp(across)), room)
    ax.set_aspect(1 / factor)
    ax.set_xlabel(f"z [{unit}]{developed.larger(factor)}")
    ax.set_ylabel(style.wrapped(f"ρα [{unit}]{developed.larger(1 / factor)}", ax, upward=True))
    ax.set_title(f"{title}, at one scale" if factor == 1 and not _is_coarse(ds) else _title(ds, title), loc="left")
    ax.margins(x=0.08, y=0.15)
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
    ax.xaxis.set_major_formatter(labels.tick)
    return style.with_grid(ax)
