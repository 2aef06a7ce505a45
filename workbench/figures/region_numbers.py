"""The number of each region of a map, and beside it the stable shapes, where there is room."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray
from scipy import ndimage

from . import style
from .room import name_beside, room

SHAPE, SMALL_SHAPE = 0.62, 0.4  # inches, the height of a shape, and that on a narrow map; its room is as wide
NARROW = 4.0  # inches of a map
MOST = 4  # shapes in a region
PAD = 0.05  # inches around a text


def placed(ds: xr.Dataset, ax: Axes, inches: tuple[float, float], texts: list[str]) -> tuple[list[str], list[int]]:
    """Write the texts into their regions, with the stable shapes below each where they fit.

    Returns notes, and the regions for whose text there is no room.

    inches: width and height of the map. A text that does not fit stands in two lines, or beside its region with a line
    to it.
    """
    numbers = ds["region_at"].values
    cell = inches[1] / numbers.shape[0], inches[0] / numbers.shape[1]
    largest, side = _largest(ds), SHAPE if inches[0] > NARROW else SMALL_SHAPE
    left_out, fewer, drawn = list[int](), False, False
    free = room(numbers, np.linspace(0, 1, numbers.shape[0] + 1), np.linspace(0, 1, numbers.shape[1] + 1), inches[::-1])
    for k, text in enumerate(texts):
        stable = int(ds["count_stable"].values[k])
        lines = text.replace(", ", ",\n")
        line = style.small() * 1.25 / 72
        for said, shapes in (*((text, count) for count in range(min(stable, MOST), -1, -1)), (lines, 0)):
            wide = max(style.width_of(part, style.small()) for part in said.split("\n"))
            width = max(wide, shapes * side) + PAD
            height = line * (1 + said.count("\n")) + (side if shapes else 0) + PAD
            place = _room(numbers == k, cell, (height, width))
            if place is not None:
                fewer |= 0 < shapes < stable
                drawn |= shapes > 0
                middle = place[0] * cell[0], place[1] * cell[1]
                _write(ds, ax, middle, inches, said, (k, shapes), (largest, side))
                free.take(middle, (height, width))
                break
        else:
            left_out.append(k)
    left_out = [k for k in left_out if not (numbers == k).any() or not name_beside(ax, free, k, texts[k])]
    some = "; where there is not room for all, those of lowest energy" if fewer else ""
    notes = [f"Shapes: developed curves of the stable equilibria, ρα to the right and z up, all at one scale{some}."]
    return notes if drawn else [], left_out


def _room(mask: NDArray[Any], cell: tuple[float, float], size: tuple[float, float]) -> tuple[float, float] | None:
    """The place, row and column, in the middle of a box of so many inches inside the mask; None where none fits."""
    rows, columns = (max(int(np.ceil(length / step)), 1) for length, step in zip(size, cell, strict=True))
    if rows > mask.shape[0] or columns > mask.shape[1]:
        return None
    whole = np.pad(mask.astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    inside = whole[rows:, columns:] - whole[:-rows, columns:] - whole[rows:, :-columns] + whole[:-rows, :-columns]
    fits = inside == rows * columns
    if not fits.any():
        return None
    away = ndimage.distance_transform_edt(np.pad(fits, 1))[1:-1, 1:-1]
    row, column = np.unravel_index(int(np.argmax(away)), fits.shape)
    return float(row + rows / 2), float(column + columns / 2)


def _largest(ds: xr.Dataset) -> float:
    """The largest width or height of a shape [length]; 0 where there is none."""
    alpha, z = ds["stable_alpha"].values, ds["stable_z"].values
    known = np.isfinite(alpha).all(axis=2)
    if not known.any():
        return 0.0
    wide = (_rho(ds)[:, None] * np.ptp(alpha, axis=2))[known].max()
    return float(max(wide, np.ptp(z, axis=2)[known].max()))


def _rho(ds: xr.Dataset) -> NDArray[Any]:
    """rho of each region, (regions,)."""
    if "rho" in ds:
        return np.full(ds.sizes["region"], float(ds["rho"]))
    R, a = (ds[f"region_{n}"].values if f"region_{n}" in ds else float(ds[n]) for n in ("R", "a"))
    return np.asarray(R + (1 if ds.attrs["side"] == "outside" else -1) * a)


def _write(
    ds: xr.Dataset, ax: Axes, place: tuple[float, float], inches: tuple[float, float], said: str,
    shapes: tuple[int, int], sizes: tuple[float, float],
) -> None:  # fmt: skip
    """The text, and so many stable shapes of a region, about a place given in inches (up, across)."""
    k, count = shapes
    up, across = place[0] / inches[1], place[1] / inches[0]
    largest, side = sizes
    room = side / inches[1], side / inches[0]
    halo = [withStroke(linewidth=2.2, foreground="white", alpha=0.85)]
    ax.text(across, up + (room[0] / 2 if count else 0), said, transform=ax.transAxes, ha="center", va="center",
            size=style.small(), color=style.INK, linespacing=1.1, path_effects=halo, zorder=6)  # fmt: skip
    rho = _rho(ds)[k]
    half = max(largest, 1e-12) / 2 * 1.08
    for i in range(count):
        left = across + (i - count / 2) * room[1]
        inset = ax.inset_axes((left, up - 0.62 * room[0], room[1], 0.9 * room[0]), zorder=6)
        x, z = rho * (ds["stable_alpha"].values[k, i] - ds["stable_alpha"].values[k, i, 0]), ds["stable_z"].values[k, i]
        inset.plot(x, z, color="white", linewidth=2.6, alpha=0.8, clip_on=False)
        inset.plot(x, z, color=style.INK, linewidth=1.1, clip_on=False)
        inset.plot(x[0], z[0], "o", color=style.INK, markersize=2.2, clip_on=False)
        for set_, values in ((inset.set_xlim, x), (inset.set_ylim, z)):
            middle = (values.min() + values.max()) / 2
            set_(middle - half, middle + half)
        inset.set_aspect("equal")
        inset.set_axis_off()
