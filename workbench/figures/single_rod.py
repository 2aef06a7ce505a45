"""One rod along its length: angle, contact, and its curve on the unrolled cylinder."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from solver.mechanics.contact import push_from

from . import style
from .scales import larger, stretch

SIZE = (9.6, 8.0)  # inches
SHORT = 0.9  # of the arc: a shorter chord has turned by a right angle or more in between


def has_shape(ds: xr.Dataset) -> bool:
    """Whether the dataset stores what the unrolled curve is made of."""
    return all(name in ds.data_vars for name in ("alpha", "z", "rho"))


def unrolled(ds: xr.Dataset, where: dict[str, int]) -> tuple[Any, Any] | None:
    """rho (alpha - alpha(0)) and z of one case, (n,) each; None where it is not solved."""
    one = ds.isel(where)
    alpha, z = one["alpha"].values, one["z"].values
    across = float(one["rho"]) * (alpha - alpha[0])
    return (across, z) if np.isfinite([across, z]).all() else None


def too_coarse(ds: xr.Dataset, where: dict[str, int]) -> bool:
    """Whether the stations of one case miss a bend: some chord is much shorter than the arc between its ends."""
    one, found = ds.isel(where), unrolled(ds, where)
    if found is None:
        return False
    chords = np.hypot(np.diff(found[0]), np.diff(found[1]))
    return bool((chords < SHORT * np.diff(one["s"].values)).any())


def pushes(ds: xr.Dataset) -> Any:
    """The cylinder's push along one rod, (n,), negative where it would have to pull; None if not stored."""
    if "contact" not in ds.data_vars:
        return None
    return push_from(ds["contact"].values, str(ds.attrs.get("side", "outside")))


def figure(ds: xr.Dataset) -> Figure:
    """The angle, the contact and the unrolled curve of a dataset of one case; what is not stored is left out."""
    parts = [part for part, name in ((angle, "beta"), (contact, "contact")) if name in ds.data_vars]
    parts += [curve] if has_shape(ds) else []
    fig = Figure(figsize=(SIZE[0], SIZE[1] * max(len(parts), 1) / 3), layout="constrained")
    FigureCanvasAgg(fig)
    for i, part in enumerate(parts):
        part(ds, fig.add_subplot(max(len(parts), 1), 1, i + 1))
    return fig


def _drawn(ds: xr.Dataset) -> dict[str, Any]:
    """How a line along the rod is drawn: as dots where the stations are too few for a line."""
    coarse = has_shape(ds) and too_coarse(ds, {})
    return {"linestyle": "none", "marker": ".", "markersize": 3} if coarse else {"linewidth": 1.8}


def _told(ds: xr.Dataset, title: str) -> str:
    coarse = has_shape(ds) and too_coarse(ds, {})
    return f"{title}: dots, as it bends between its {ds.sizes['u']} stations" if coarse else title


def angle(ds: xr.Dataset, ax: Axes) -> Axes:
    """beta against s, in degrees."""
    ax.plot(ds["s"], np.degrees(ds["beta"]), color=style.PUSHED, **_drawn(ds))
    ax.axhline(0, color=style.SOFT, linewidth=0.8)
    ax.set_ylabel("β [°]")
    ax.set_title(_told(ds, "angle from the axis to the tangent"), loc="left")
    return _along(ds, ax)


def contact(ds: xr.Dataset, ax: Axes) -> Axes:
    """The push of the cylinder against s, positive on either side; shaded where the cylinder would have to pull."""
    push, unit = pushes(ds), str(ds["contact"].attrs.get("units", "1"))
    ax.plot(ds["s"], push, color=style.PUSHED, **_drawn(ds))
    ax.axhline(0, color=style.SOFT, linewidth=0.8)
    pulled = push < 0
    if pulled.any() and "marker" not in _drawn(ds):
        ax.fill_between(ds["s"], 0, 1, where=pulled, transform=ax.get_xaxis_transform(), color=style.LIFTED, alpha=0.28,
                        linewidth=0, label="the cylinder would have to pull: the rod would lift off")  # fmt: skip
        ax.fill_between(ds["s"], 0, push, where=~pulled, color=style.PUSHED, alpha=0.25, linewidth=0,
                        label="the cylinder pushes")  # fmt: skip
        ax.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=2, borderaxespad=0.2)
    ax.set_ylabel(f"push [{style.unit(unit)}]")
    ax.set_title("push of the cylinder per length", loc="left")
    return _along(ds, ax)


def curve(ds: xr.Dataset, ax: Axes) -> Axes:
    """The curve on the unrolled cylinder as one sees it from outside: z to the right, rho alpha down.

    At one scale, unless the rod would be too thin to see (`stretch`); then an axis says so.
    """
    found = unrolled(ds, {})
    unit = style.unit(str(ds.attrs["length_unit"]))
    ax.set_title("unrolled cylinder, seen from outside", loc="left")
    if found is None:
        ax.text(0.5, 0.5, str(ds["outcome"].values), transform=ax.transAxes, ha="center", color=style.SOFT)
        return ax
    across, up = found
    ax.set_title(_told(ds, "unrolled cylinder, seen from outside"), loc="left")
    pulled = pushes(ds) < 0 if "contact" in ds.data_vars else np.zeros(across.size, dtype=bool)
    thick = {"linewidth": 2.4, **_drawn(ds)} if "marker" in _drawn(ds) else {"linewidth": 2.4}
    ax.plot(up, across, color=style.LIFTED, solid_capstyle="round", **thick)
    ax.plot(np.where(pulled, np.nan, up), across, color=style.PUSHED, solid_capstyle="butt", **thick)
    ax.plot(up[0], across[0], "o", color=style.INK, markersize=5)
    ax.annotate("s = 0", (up[0], across[0]), (0, 6), textcoords="offset points", ha="center", va="bottom",
                size=style.SMALL)  # fmt: skip
    factor = stretch(float(np.ptp(up)), float(np.ptp(across)), (SIZE[0] - 1, SIZE[1] / 3 - 1))
    ax.set_aspect(1 / factor)
    ax.set_xlabel(f"z [{unit}]{larger(factor)}")
    ax.set_ylabel(style.wrapped(f"ρα [{unit}]{larger(1 / factor)}", ax, upward=True))
    if factor == 1 and "marker" not in thick:
        ax.set_title("unrolled cylinder, seen from outside, both to one scale", loc="left")
    ax.margins(x=0.08, y=0.15)
    ax.invert_yaxis()
    return style.quiet(ax)


def _along(ds: xr.Dataset, ax: Axes) -> Axes:
    ax.set_xlabel(f"s [{style.unit(str(ds.attrs['length_unit']))}]")
    ax.margins(x=0)
    return style.quiet(ax)
