"""Several cases side by side, each in a cell of its own. Needs OpenGL."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from ..data import labels, selection
from . import body as rods
from . import camera as cameras
from . import captions
from .arrangement import in_rows
from .body import Body
from .cells import Cell
from .composition import Picture, Scene, composed, room
from .kinds import Kind
from .settings import Settings
from .views import View

MOST_ROWS = 5
ROW, GRID = (2000, 1300), (2000, 2400)  # pixels at `style.DPI`: width, and largest height, of a page
IN_ROW = 9  # cases of one axis


def several(
    ds: xr.Dataset, kind: Kind, names: list[str], at: Mapping[str, float] | None, settings: Settings
) -> Picture:
    """The cases of an axis in rows, or of two axes in a table."""
    line = selection.line(ds, names[0], at)
    cases = _table(ds, kind, names, at, line)
    table, rows = len(names) == 2, []
    for row in cases:
        found = [(where, *rods.of_case(ds, where, kind, settings.span)) for where in row]
        cells = [kind.cell(ds, [] if table else names, where, why) for where, _, why in found]
        drawn = [rods.beginning(b) if b and not settings.span else b for _, b, _ in found]
        rows.append([View([b] if b else [], cell) for b, cell in zip(drawn, cells, strict=True)])
    bodies = [body for row in rows for view in row for body in view.bodies]
    (azimuth, elevation), *_ = cameras.views_of(settings.camera)
    rows = [[replace(view, turned=-np.radians(azimuth)) for view in row] for row in rows]
    camera = cameras.facing(bodies, elevation)
    size = GRID if table or len(cases[0]) > IN_ROW else ROW
    held = {k: i for k, i in cases[0][0].items() if k not in names}
    shown = [] if table else [labels.axis_label(n, ds[n]) for n in names if n != "equilibrium"]
    case = ", ".join([*shown, *captions.values(ds, held)])
    scene = Scene(ds, kind, rows, bodies, case, camera, settings, _notes(ds, kind, names, cases, line, bodies), size,
                  ringed="all")  # fmt: skip
    if table:
        heads = [captions.headings(ds, names[0], cases[0]), captions.headings(ds, names[1], [row[0] for row in cases])]
        scene = replace(scene, columns=heads[0], heads=heads[1])
    else:
        scene = replace(scene, rows=in_rows(rows[0], camera, room(scene), View([], Cell(""))))
    return composed(scene)


def _notes(
    ds: xr.Dataset, kind: Kind, names: list[str], cases: list[list[dict[str, int]]], line: list[dict[str, int]],
    bodies: Sequence[Body],
) -> list[str]:  # fmt: skip
    """Which cases are shown, and which part of them."""
    shown = {names[0]: (len(cases[0]), len(line))}
    if len(names) == 2:
        shown[names[1]] = len(cases), ds.sizes[names[1]]
    notes = [f"{count} of {of} values of {labels.axis_symbol(name) if name != 'equilibrium' else 'the list'}"
             for name, (count, of) in shown.items() if count < of]  # fmt: skip
    return [*notes, *captions.part_drawn(bodies, str(ds.attrs["length_unit"])), *kind.notes]


def _table(
    ds: xr.Dataset, kind: Kind, names: list[str], at: Mapping[str, float] | None, line: list[dict[str, int]]
) -> list[list[dict[str, int]]]:
    """The cases that are shown, row by row; of one axis in one row."""
    cases = selection.spread(line, kind.most)
    if len(names) == 1:
        return [cases]
    down = selection.spread(selection.line(ds, names[1], at), MOST_ROWS)
    return [[{**case, names[1]: row[names[1]]} for case in cases] for row in down]
