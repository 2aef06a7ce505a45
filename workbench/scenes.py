"""The rod on its cylinder in three dimensions: off-screen pictures of a stored dataset, never solving.

The tube has the rod's true radius and touches the surface; where the cylinder would have to pull to hold it
there, it has a second colour. All views are parallel projections, so one scale bar is right everywhere.
Needs OpenGL: ask `gl.probe` first, as without it VTK ends the process.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from solver.errors import InputError

from . import picking, sheet, style, tube
from .dataset import axes_of
from .sheet import Cell, Sheet
from .stage import Shot, ends_of, photograph, view_of
from .tube import Curve

KINDS = (".png", ".jpg")
LYING = 1.3  # how much taller than wide a scene is laid on its side
MOST_CELLS = 9
PAGE, ROW = (1600, 1200), (2000, 1100)  # pixels of a sheet with one case, and at most of one with a row


def render(ds: xr.Dataset, path: str | Path, at: Mapping[str, float] | None = None) -> Path:
    """Draw one case large, seen from its front and from its side.

    at: values of axes; the nearest stored case is drawn, at the study's base where an axis is left out. Raises
    `InputError` for an axis or value that is not there, and for a case without a shape.
    """
    path = _checked(path)
    where = picking.case(ds, at)
    curve = tube.read(ds, where)
    chosen = ", ".join(_told(ds, name, i) for name, i in where.items())
    if curve is None:
        outcome = str(ds["outcome"].isel(where).values)
        raise InputError(f"nothing to draw{f' at {chosen}' if chosen else ''}: {outcome}")
    lying = np.ptp(ends_of([curve])) > LYING * 2 * curve.reach
    front = Shot(curve, Cell("facing the rod"))
    side = Shot(curve, Cell("turned by 90° about the axis"), -np.pi / 2)
    _save(ds, path, [[front], [side]] if lying else [[front, side]], chosen, PAGE, lying)
    return path


def render_row(
    ds: xr.Dataset, path: str | Path, axis: str, at: Mapping[str, float] | None = None, most: int = MOST_CELLS
) -> Path:
    """Draw the cases along an axis side by side, at one scale and with one camera.

    at: values of the other axes, the study's base where left out. most: how many cells at most, evenly chosen.
    A case without a shape leaves an empty cell that says why. Raises `InputError`.
    """
    path = _checked(path)
    cases = picking.spread(picking.line(ds, axis, at), most)
    shots = []
    for where in cases:
        curve, why = _try(ds, where)
        shots.append(Shot(curve, Cell(style.shown(float(ds[axis].values[where[axis]]), ds[axis]), why)))
    others = [_told(ds, name, i) for name, i in cases[0].items() if name != axis]
    _save(ds, path, [shots], ", ".join([style.axis_label(axis, ds[axis]), *others]), ROW, False)
    return path


def draw(ds: xr.Dataset, path: str | Path) -> dict[str, Path]:
    """The scenes of a study, name -> file: a row along each axis, or the one case large. Raises `InputError`.

    path: of the file; with several axes each row's file has the axis's name appended.
    """
    path = Path(path)
    axes = axes_of(ds)
    if not axes:
        return {"scene": render(ds, path)}
    files = {axis: path.with_stem(f"{path.stem}_{axis}") if len(axes) > 1 else path for axis in axes}
    return {f"scene {axis}": render_row(ds, file, axis) for axis, file in files.items()}


def _try(ds: xr.Dataset, where: dict[str, int]) -> tuple[Curve | None, str]:
    """The curve, or why there is none."""
    try:
        curve = tube.read(ds, where)
    except InputError as error:
        return None, str(error)
    return curve, "" if curve else str(ds["outcome"].isel(where).values)


def _save(
    ds: xr.Dataset, path: Path, shots: Sequence[Sequence[Shot]], chosen: str, page: tuple[int, int], lying: bool
) -> None:
    """Photograph the shots and write the sheet; page: its width and height in pixels, at most."""
    curves = [shot.curve for row in shots for shot in row if shot.curve]
    ends = ends_of(curves)
    room = page[0] - 2 * sheet.MARGIN, page[1] - sheet.HEAD - sheet.FOOT
    view = view_of(curves, ends, (room[0] // len(shots[0]), room[1] // len(shots) - sheet.LABEL), lying)
    pixels = photograph(shots, ends, view)
    inside = "inside the cylinder, cut open" if ds.attrs["side"] == "inside" else ""
    subtitle = " · ".join(fact for fact in (chosen, style.reading(ds), inside) if fact)
    unit = str(ds.attrs["length_unit"])
    cells = [[shot.cell for shot in row] for row in shots]
    least = page if page == PAGE else (1300, 0)
    drawn = Sheet(
        str(ds.attrs["title"]), subtitle, pixels, cells, view.per_unit, unit, view.page.T, _legend(curves),
        _notes(curves, unit), least,
    )  # fmt: skip
    sheet.figure(drawn).savefig(path, dpi=style.DPI)


def _legend(curves: Sequence[Curve]) -> list[tuple[str, str]]:
    if not curves:
        return []
    if not all(np.isfinite(curve.push).all() for curve in curves):
        return [(style.PUSHED, "the rod (where it would lift off is not stored)")]
    return [(style.PUSHED, "the cylinder pushes"), (style.LIFTED, "it would have to pull: the rod would lift off")]


def _notes(curves: Sequence[Curve], unit: str) -> list[str]:
    notes = []
    part = [curve for curve in curves if not curve.whole]
    if part:
        shown, L = style.number(part[0].shown), style.number(part[0].L)
        notes.append(f"only the first {shown} {unit} of {L} {unit} are drawn")
    if any(curve.overlaps for curve in curves):
        notes.append("where turns cross, the equations let\nthe rod pass through itself")
    return notes


def _told(ds: xr.Dataset, name: str, index: int) -> str:
    return f"{style.symbol(name)} = {style.shown(float(ds[name].values[index]), ds[name])}"


def _checked(path: str | Path) -> Path:
    path = Path(path)
    style.picture_kind(path, KINDS)
    return path
