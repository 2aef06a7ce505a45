"""A scene as one offline HTML file: every case that --at leaves, with a slider for each axis."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from .present import Result, result_of_files

if TYPE_CHECKING:
    import xarray as xr

SUFFIX = ".html"
KIND = "contact"  # the kind of scene that a file shows
FIRST, ROUNDS = 201, 6  # stations that are tried first for a study; how often more are tried


def is_page(out: Path | None) -> bool:
    """Whether the output is an HTML file."""
    return out is not None and out.suffix.lower() == SUFFIX


def write(file: Path, at: list[str], out: Path, force: bool, kind: str | None, others: bool) -> Result:
    """Write the file; of status 1 where the stations are too few.

    file: as of `scene.scene_file`. others: whether an option of a picture alone was given. Raises `InputError`.
    """
    from solver.problem.errors import InputError

    from ..scene.scene_kinds import kind_of
    from ..store import atomic
    from ..web.turntable import turntable_page
    from . import option_checks, study_scene

    if kind not in (None, KIND, "equilibria") or others:
        raise InputError(
            f"an {SUFFIX} file shows the kind {KIND} of all cases that --at leaves; --kind, --axis, --along, --from "
            "and --to are for pictures, .png and .jpg"
        )
    path = option_checks.check(out, (SUFFIX,), force)
    study, ds = study_scene.open_rods(file)
    where = option_checks.axis_values(ds, at)
    solve = study_scene.solver_of(study, ds, kind_of(KIND), where, _free(ds, where))
    if study is not None and solve is not None:
        ds = solve(FIRST)
    for _ in range(ROUNDS):
        if solve is None or (more := _stations(ds)) <= ds.sizes["u"]:
            break
        ds = solve(more)
    text = turntable_page.html(ds, where)
    atomic.write(path, lambda aside: aside.write_text(text, encoding="utf-8"))
    missing = _stations(ds)
    said = [f"{path}: {len(text) / 1e6:.2g} MB, opens in a browser without a network"]
    if missing > ds.sizes["u"]:
        warning = f"{ds.sizes['u']} stations are too few for a smooth rod, about {missing} are needed"
        return result_of_files([path], said, [warning], 1)
    return result_of_files([path], said)


def _free(ds: "xr.Dataset", where: Mapping[str, float]) -> list[str]:
    """The axes without a value, each of which has a slider."""
    from ..store import schema, selection

    fixed = {selection.axis_of(ds, name) for name in where}
    return [name for name in schema.axes_of(ds) if name not in fixed]


def _stations(ds: "xr.Dataset") -> int:
    """About how many stations the rods need for a curve without corners; as many as there are where these suffice."""
    from ..geometry.stored_line import lines_of_solved
    from ..web.turntable.turntable_page import stations_for

    return max(int(ds.sizes["u"]), *map(stations_for, lines_of_solved(ds)), 0)
