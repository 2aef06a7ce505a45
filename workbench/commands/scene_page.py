"""A scene as one offline HTML file: every case that --at leaves, with a slider for each axis."""

from pathlib import Path
from typing import TYPE_CHECKING

from . import console

if TYPE_CHECKING:
    import xarray as xr

SUFFIX = ".html"
KIND = "contact"  # the kind of scene that a file shows
SHARE = 1e-3  # of the height of a rod, by which its curve between stations may be off: a pixel of a large screen
FIRST, ROUNDS = 201, 6  # stations that are tried first for a study that is not stored; how often more are tried


def is_page(out: Path | None) -> bool:
    """Whether the output is an HTML file."""
    return out is not None and out.suffix.lower() == SUFFIX


def write(file: Path, at: list[str], out: Path, force: bool, kind: str | None, others: bool) -> int:
    """Write the file; 0, or 1 where the stations are too few.

    file: as of `scene.scene_file`. others: whether an option of a picture alone was given. Raises `InputError`.
    """
    from solver.problem.errors import InputError

    from ..data import atomic
    from ..web.turntable import page
    from . import at_option, output_file, study_scene
    from .scene import read_dataset

    if kind not in (None, KIND, "equilibria") or others:
        raise InputError(
            f"an {SUFFIX} file shows the kind {KIND} of all cases that --at leaves; --kind, --axis, --along, --from "
            "and --to are for pictures, .png and .jpg"
        )
    path = output_file.check(out, (SUFFIX,), force)
    if study_scene.is_study(file):
        ds, where = _solved(file, at)
    else:
        ds = read_dataset(file)
        where = at_option.values(ds, at)
    text = page.html(ds, where)
    atomic.write(path, lambda aside: aside.write_text(text, encoding="utf-8"))
    missing = _stations(ds)
    console.say(f"{path}: {len(text) / 1e6:.2g} MB, opens in a browser without a network")
    if missing > ds.sizes["u"]:
        console.warn(f"{ds.sizes['u']} stations are too few for a smooth rod, about {missing} are needed")
        return 1
    return 0


def _solved(file: Path, at: list[str]) -> "tuple[xr.Dataset, dict[str, float]]":
    """The dataset of the cases of a study, at the stations that its rods need, and the values of the axes held."""
    from ..data import schema, selection
    from ..run import in_memory
    from ..scene.kinds import kind_of
    from . import at_option, study_scene

    study, first = study_scene.two_stations(file)
    where = at_option.values(first, at)
    fixed = {selection.axis_of(first, name) for name in where}
    shown = [name for name in schema.axes_of(first) if name not in fixed]
    needed = study_scene.needed_cases(study, first, kind_of(KIND), where, shown)
    ds = in_memory.run(needed.at_stations(FIRST))
    for _ in range(ROUNDS):
        more = _stations(ds)
        if more <= ds.sizes["u"]:
            break
        ds = in_memory.run(needed.at_stations(more))
    return ds, where


def _stations(ds: "xr.Dataset") -> int:
    """About how many stations the rods need for a curve without corners; as many as there are where these suffice."""
    from itertools import product

    import numpy as np

    from ..data import schema
    from ..geometry import centreline, refinement

    axes = schema.axes_of(ds)
    most = int(ds.sizes["u"])
    for indices in product(*(range(ds.sizes[name]) for name in axes)):
        where = dict(zip(axes, indices, strict=True))
        if bool(ds["solved"].isel(where)):
            line = centreline.read(ds, where)
            most = max(most, refinement.stations_for(line, SHARE * max(float(np.ptp(line.z)), 2 * line.rho)))
    return most
