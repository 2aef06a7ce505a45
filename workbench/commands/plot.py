"""The command plot: the figure of a stored study."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from .options import At, Dpi, File, ForceOutput, NoTitle, Style, Width, option
from .present import Result, presents, result_of_files

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from ..figures.sheet import Sheet
    from ..store.file_kinds import Kind


@presents()
def plot(
    file: File,
    out: Annotated[
        Path | None,
        option("FILE", "Picture, .png, .pdf or .svg; default: FILE with the ending .png.", "--out", "-o"),
    ] = None,
    kind: Annotated[
        str | None,
        option(
            "KIND",
            "map: each observable over two axes; lines: unrolled views, and observables along each axis with their "
            "laws, or against the sampled fields; curves: unrolled views in the colours of the push; ridge: β, κ, the "
            "push or other arrays along s; portrait: (β, β′) beside the potential G; states: where rods are straight, "
            "sinusoidal or helical; pipe: the azimuth along s in the colours of the push, with these states; bars: "
            "observables along an axis of at most twelve values. Default: map for a grid of two axes or more, else "
            "lines.",
        ),
    ] = None,
    x: Annotated[
        str | None,
        option(
            "AXIS",
            "Axis to the right of a map or of lines, or that of the rods or bars; default: the study's first.",
            "--x",
        ),
    ] = None,
    y: Annotated[str | None, option("AXIS", "Axis of a map upward; default: the study's next.", "--y")] = None,
    show: Annotated[
        list[str] | None,
        option(
            "NAMES",
            "Observables of a map, of lines or of bars, separated by commas, at most twelve; default: those of the "
            "laws, or the first stored. Of a ridge arrays along the rod, at most six. Of a list of equilibria or of "
            "branches one, in their diagram; of a map of folds count, count_stable, or a number along its curves, "
            "such as dbeta0.",
        ),
    ] = None,
    at: At = None,
    shapes: Annotated[
        str | None, option("NxM", "Draw N x M unrolled views over the first map, such as 5x5 (at most 12x12).")
    ] = None,
    style: Style = "screen",
    width: Width = None,
    panel: Annotated[
        str | None,
        option(
            "NAME",
            "One panel alone: a stored observable; of lines also an axis (its unrolled view), the claim of a law (with "
            "its observable where several laws share it), or samples.",
            rich_help_panel="Print",
        ),
    ] = None,
    no_title: NoTitle = False,
    data: Annotated[
        Path | None, option("FILE", "CSV file of the numbers that are drawn.", rich_help_panel="Print")
    ] = None,
    dpi: Dpi = 200,
    force: ForceOutput = False,
) -> Result:
    """Draw the observables of a stored study, as maps over two axes or along each axis.

    The FILE may be the folder that reproduce wrote: then the picture tells its story in four panels, as wide as one or
    two columns of a journal. A map shows where the rod would lift off or passes through itself, and on which lines a
    law holds. A third axis has a map for each of some values; further axes have one value (--at). The unrolled view of
    a rod is its centreline on the unrolled cylinder.
    """
    from solver.problem.errors import InputError

    from ..figures import canvas, drawn_numbers, kinds, legend
    from ..figures.sheet import sheet
    from ..store import atomic, reading
    from ..words import outcomes
    from . import option_checks

    given: dict[str, Any] = {"x": x, "y": y, "show": show, "at": at, "shapes": shapes}
    named = {name: value for name, value in {**given, "kind": kind, "panel": panel}.items() if value}
    if file.is_dir():
        if alien := [*named, *(["data"] if data else [])]:
            raise InputError(f"{file} is a folder, whose story plot draws without --{alien[0]}")
        return _story(file, out or file / "story.png", width, force, dpi)
    page = sheet(style, width, not no_title, panel)
    if (other := _other(file)) is not None:
        if alien := [name for name in named if name not in kinds.KINDS[other.figure].options]:
            raise InputError(f"{file} is {other.what}, which plot draws without --{alien[0]}")
        ds, kind, given = reading.read(file, study=False), other.figure, named
    else:
        ds = reading.read(file)
        outcomes.check_any_solved(ds)
        kind, given = _kind(ds, kind, given)
    path = option_checks.check(out or file.with_suffix(".png"), canvas.DIAGRAMS, force)
    numbers = option_checks.check(data, (".csv",), force) if data else None
    drawn = _figure(ds, kind, given, page)
    table = drawn_numbers.table(drawn) if numbers else ""
    if numbers and table.count("\n") < 2:
        raise InputError(f"--data writes lines, dots, bars and cells of maps, and the picture of {file} has none")
    canvas.save(drawn, path, dpi)
    if numbers:
        atomic.write(numbers, lambda aside: aside.write_text(table, encoding="utf-8"))
    paths = [path, *([numbers] if numbers else [])]
    return result_of_files(paths, [*legend.notes_of(drawn), *map(str, paths)])


def _other(file: Path) -> "Kind | None":
    """The kind of a file that holds no study; None for a study. Raises `InputError` where it has no figure."""
    from ..store import file_kinds, reading

    kind = reading.kind_of_file(file)
    if kind is file_kinds.STUDY:
        return None
    if not kind.figure:
        raise file_kinds.other_kind(file, kind, "plot has no figure of it")
    return kind


def _story(folder: Path, out: Path, width: float | None, force: bool, dpi: int) -> Result:
    """Draw the figure of the datasets that reproduce wrote into a folder."""
    from ..figures import canvas, story
    from ..figures.sheet import sheet
    from ..store import reading
    from . import option_checks

    path = option_checks.check(out, canvas.DIAGRAMS, force)
    datasets = {name: reading.read(folder / f"{name}.h5", study=name != story.CLAIMS) for name in story.NEEDED}
    canvas.save(story.figure(datasets, sheet("paper", width or 183, titled=False)), path, dpi)
    return result_of_files([path])


def _kind(ds: "xr.Dataset", kind: str | None, options: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """The kind of picture, and its given options. Raises `InputError` for one that does not fit."""
    from ..figures import kinds
    from . import option_checks

    given = {name: value for name, value in options.items() if value}
    kind = kinds.kind_of(ds, kind, list(given))
    if "at" in given:
        given["at"] = option_checks.axis_values(ds, given["at"])
    return kind, given


def _figure(ds: "xr.Dataset", kind: str, given: dict[str, Any], page: "Sheet") -> "Figure":
    """The figure of that kind."""
    from ..figures import kinds, thumbnails
    from . import option_checks

    if "show" in given:
        given["show"] = option_checks.names(given["show"])
    if "shapes" in given:
        given["shapes"] = thumbnails.read(given["shapes"])
    if kind == "map" and page.panel:
        given["show"] = [page.panel]
    return kinds.figure(ds, kind, page, **given)
