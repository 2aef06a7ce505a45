"""The command folds: fold curves over two fields of an ends problem, and the equilibria in the regions between them."""

from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.errors import InputError

from . import console, tables
from .case_options import AXES, ENDS_FIELDS, HELD, GivenOptions
from .options import OneCase, Table1, option, read_range
from .present import Result, presents

if TYPE_CHECKING:
    import xarray as xr

    from solver.region_map import RegionMap

MOST_POINTS = 100_000  # as of `RegionMap.checked`
MOST_LINES = 101  # of the lattice, as of `solver.region_map.MOST`


@presents(
    "Picture, .png, .pdf or .svg: the map.",
    "HDF5 file of the curves and regions.",
    kind="folds",
    case=(*ENDS_FIELDS, *HELD),
)
def folds(
    file: OneCase = None,
    table1: Table1 = False,
    *,
    given: GivenOptions,
    axis: Annotated[
        list[str] | None,
        option(
            "NAME=FROM:TO",
            "A field that varies, such as betaL=-90deg:90deg or FZ=4:12, in the units of the case; give two of them.",
        ),
    ] = None,
    lattice: Annotated[
        int | None,
        option(
            "COUNT",
            "Points along each field between which curves are searched for, 2 to 101; default: 9, with held ends or "
            "weight 3.",
        ),
    ] = None,
    points: Annotated[
        int, option("COUNT", "Random points at which the map is checked by all equilibria there.", "--check", min=0)
    ] = 0,
) -> Result:
    """Map where equilibria appear and disappear over two fields.

    Fold curves divide the rectangle of the two fields into regions; in each the number of equilibria and of stable ones
    is constant. With held ends or weight, curves and equilibria are those that a search finds. Exit status 1 if curves
    may be missing, or a check fails.

    The options of a case are those of the command equilibria.
    """
    from solver.region_map import points_of_lattice, region_map

    from ..branches.ends_study import study_and_case
    from ..branches.region_dataset import as_dataset

    study, case = study_and_case(file, given.values, given.units, table1, held=True)
    read = [read_range("--axis", text, study.unit_system, AXES) for text in axis or []]
    ranges: dict[str, Any] = {name: (low, high) for name, low, high, _ in read}
    if len(axis or []) != 2 or len(ranges) != 2:
        said = ", ".join(axis or []) or "none"
        raise InputError(f"folds takes --axis NAME=FROM:TO twice, with two different fields, got {said}")
    if points > MOST_POINTS:
        raise InputError(f"--check takes at most {MOST_POINTS} points, got {points}")
    regions = region_map(case, lattice=lattice, **ranges)
    wrong = regions.check(points) if points else []

    def contents() -> "xr.Dataset":
        ds = as_dataset(study, regions, (points, len(wrong)) if points else None)
        return ds.assign_attrs(reading="") if given.values else ds  # it would not be that of Table 1

    def show() -> None:
        _print(regions, points, wrong, points_of_lattice(case) if lattice is None else lattice)
        console.say_units(study.unit_system)

    status = 1 if regions.remark or wrong else 0
    return Result(lambda: _as_data(regions, points, wrong), show, status, contents)


def _curves(found: "RegionMap") -> list[dict[str, Any]]:
    return [
        {
            "curve": i,
            "kind": curve.kind,
            "index": f"{curve.lower}, {curve.lower + 1}",
            "cusps": curve.cusps.shape[0],
            "ends": ", ".join(dict.fromkeys(curve.ends)),
        }
        for i, curve in enumerate(found.folds.curves)
    ]


def _regions(found: "RegionMap") -> list[dict[str, Any]]:
    return [
        {
            **dict(zip(found.folds.names, map(float, region.values), strict=True)),
            "area": region.area,
            "equilibria": region.count,
            "stable": region.stable,
        }
        for region in found.regions
    ]


def _as_data(found: "RegionMap", points: int, wrong: list[str]) -> dict[str, Any]:
    """The curves, the regions and the check as plain data."""
    folds = found.folds
    cusps = [dict(zip(folds.names, map(float, cusp), strict=True)) for curve in folds.curves for cusp in curve.cusps]
    return {
        "fields": list(folds.names),
        "curves": _curves(found),
        "cusps": cusps,
        "regions": _regions(found),
        "check": {"points": points, "failed": wrong},
        "remark": found.remark,
    }


def _print(found: "RegionMap", points: int, wrong: list[str], lattice: int) -> None:
    """Print the curves, the regions, and what the check says; lattice: the points along each field."""
    from studies.laws.law_words import count_of

    curves, regions = _curves(found), _regions(found)
    tables.print_rows(curves)
    tables.print_rows(regions)
    cusps = sum(row["cusps"] for row in curves)
    console.say(f"{count_of(len(curves), 'curve')}, {count_of(cusps, 'cusp')}, {count_of(len(regions), 'region')}")
    if points:
        console.say(f"checked at {points} random points: {len(wrong)} differ from the map")
        for sentence in wrong[:10]:
            console.say(sentence)
    if found.remark:
        finer = min(2 * lattice - 1, MOST_LINES)
        console.say(f"a curve may be missing; try --lattice {finer}: {found.remark}")
