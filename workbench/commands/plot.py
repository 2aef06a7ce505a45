"""The command plot: the figure of a stored study."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from solver.problem.errors import InputError, no_such
from solver.problem.quantities import current

from ..figures import figure_kinds
from ..run import atomic
from .options import (
    At,
    Dpi,
    File,
    ForceOutput,
    NoTitle,
    Style,
    Width,
    axis_values,
    check_file,
    field_number,
    names,
    option,
    ranges,
)
from .present import Result, presents, result_of_files

OF_FIGURES = ("x", "y", "show", "at", "shapes", "yield_stress")  # options of a kind of figure
FARTHEST = 1e100  # an end of --range; Matplotlib's ticks overflow from 1e300 on
LEAST_RANGE = 1e-9  # of the larger end; Matplotlib widens ranges below 1e-14 of it


@dataclass(frozen=True)
class PlotOptions:
    """What `plot` is asked to draw, and how; the names of most are those of the options of a kind of figure."""

    out: Annotated[
        Path | None, option("FILE", "Picture, .png, .pdf or .svg; default: FILE with the ending .png.", "--out", "-o")
    ] = None
    kind: Annotated[
        str | None,
        option(
            "KIND",
            "; ".join(f"{name}: {row.shows}" for name, row in figure_kinds.OF_STUDIES.items())
            + ". Default: rod for one case, samples, "
            + f"map where two axes have over {figure_kinds.FEW} values, else lines.",
        ),
    ] = None
    x: Annotated[
        str | None,
        option(
            "AXIS",
            "Axis to the right of a map or of lines, or that of the rods or bars; default: the study's first.",
            "--x",
        ),
    ] = None
    y: Annotated[str | None, option("AXIS", "Axis of a map upward; default: the study's next.", "--y")] = None
    show: Annotated[
        list[str] | None,
        option(
            "NAMES",
            "Observables of a map, of lines or of bars, separated by commas, at most twelve; default: those of the "
            "laws, then the first stored. Of a ridge arrays along the rod, at most six. Of a list of equilibria or of "
            "branches one, in their diagram; of a map of folds count, count_stable, or a number along its curves, "
            "such as dbeta0.",
        ),
    ] = None
    at: At = None
    range_: Annotated[
        list[str] | None,
        option(
            "NAME=LOW:HIGH",
            "Range of the vertical axis of an observable, in lines and diagrams of branches, in the units of the file; "
            "repeatable.",
            "--range",
        ),
    ] = None
    without: Annotated[
        list[str] | None,
        option(
            "WORD",
            "Leave out the numbers of rods with this caution, such as turned-back; laws are judged without them. Of "
            "branches turned-back alone; repeatable.",
        ),
    ] = None
    shapes: Annotated[
        str | None, option("NxM", "Draw N x M unrolled views over the first map, such as 5x5 (at most 12x12).")
    ] = None
    yield_stress: Annotated[
        str | None,
        option("STRESS", 'Stress at which a pipe yields, for --kind well, such as "75 ksi".', "--yield-stress"),
    ] = None
    style: Style = "screen"
    width: Width = None
    panel: Annotated[
        str | None,
        option(
            "NAME",
            "One panel alone: a stored observable; of lines also an axis (its unrolled view), or the claim of a law "
            "(with its observable where several laws share it).",
            rich_help_panel="Print",
        ),
    ] = None
    no_title: NoTitle = False
    data: Annotated[Path | None, option("FILE", "CSV file of the numbers that are drawn.", rich_help_panel="Print")] = (
        None
    )
    dpi: Dpi = 200
    force: ForceOutput = False

    @property
    def of_figure(self) -> dict[str, Any]:
        """The options that figures take, of those that were given."""
        return {name: value for name in OF_FIGURES if (value := getattr(self, name))}


@presents()
def plot(file: File, wanted: PlotOptions) -> Result:
    """Draw the observables of a stored study, as maps over two axes or along each axis.

    The FILE may be the folder that reproduce wrote: then the picture tells its story in four panels, as wide as one or
    two columns of a journal. A map shows where the rod would lift off or passes through itself, and on which lines a
    law is true. A third axis has a map for each of some values; further axes have one value (--at). The unrolled view
    of a rod is its centreline on the unrolled cylinder.
    """
    from ..figures import canvas, drawn_numbers, map_panel
    from ..figures.sheet import sheet
    from ..stored import file_kinds, reading

    given, kind = wanted.of_figure, wanted.kind
    of_kind = [*given, *(["range"] if wanted.range_ else [])]
    named = [*of_kind, *(name for name in ("kind", "panel") if getattr(wanted, name))]
    if file.is_dir():
        if alien := [*named, *(["data"] if wanted.data else [])]:
            raise InputError(f"{file} is a folder; plot draws its story without --{alien[0]}")
        return _story(file, wanted)
    page, of = sheet(wanted.style, wanted.width, not wanted.no_title, wanted.panel), reading.kind_of_file(file)
    if of is file_kinds.STUDY:
        stored = reading.read_stored(file)
        stored.check_any_solved()
        kind = figure_kinds.kind_of(stored, kind, of_kind)
    else:
        if not of.figure:
            raise file_kinds.other_kind(file, of, "plot has no figure of it")
        if alien := [name for name in named if name not in figure_kinds.KINDS[of.figure].options]:
            raise InputError(f"{file} is {of.what}, which plot draws without --{alien[0]}")
        stored, kind = reading.read_stored(file, study=False), of.figure
    for word in wanted.without or ():
        stored = stored.without(word.replace("-", " "))
    page = replace(page, ranges=_ranges(stored, wanted.range_))
    readers: dict[str, Callable[[Any], Any]] = {
        "at": partial(axis_values, stored),
        "show": names,
        "shapes": map_panel.read_shapes,
        "yield_stress": partial(_positive_stress, units=stored.units),
    }
    given = {name: readers.get(name, str)(value) for name, value in given.items()}
    if kind == "map" and wanted.panel:
        given["show"] = [wanted.panel]
    path = check_file(wanted.out or file.with_suffix(".png"), canvas.DIAGRAMS, wanted.force)
    numbers = check_file(wanted.data, (".csv",), wanted.force) if wanted.data else None
    drawn = figure_kinds.figure(stored, kind, page, **given)
    table = drawn_numbers.table(drawn) if numbers else ""
    if numbers and table.count("\n") < 2:
        raise InputError(f"--data writes lines, dots, bars and cells of maps, and the picture of {file} has none")
    ends = [ax.get_ylim() for ax in drawn.axes]
    missing = [
        f"--range {name}: the picture has no vertical axis of {name}"
        for name, range_ in page.ranges.items()
        if range_ not in ends
    ]
    canvas.save(drawn, path, wanted.dpi)
    if numbers:
        atomic.write_text(numbers, table)
    paths = [path, *([numbers] if numbers else [])]
    return result_of_files(paths, [*canvas.caption(drawn), *map(str, paths)], missing)


def _positive_stress(text: str, units: dict[str, str]) -> float:
    """The stress of --yield-stress in the unit of the file. Raises `InputError`, also for a number without a unit."""
    from solver.problem.units import split

    value = field_number("--yield-stress", "bending_stress_max", text, units)
    if 0 < value < FARTHEST and not split(text)[1]:
        raise InputError(f'--yield-stress needs its unit, such as "75 ksi" or 517MPa, got {text!r}')
    if not 0 < value < FARTHEST:
        raise InputError(f'--yield-stress must be a positive stress, such as "75 ksi", got {text!r}')
    return value


def _ranges(stored: Any, texts: list[str] | None) -> dict[str, tuple[float, float]]:
    """The ranges of vertical axes, in the units of labels. Raises `InputError` for what the file does not hold."""
    from ..words import labels

    read, known = ranges("--range", texts, stored.units, "height=4:9"), {}
    for name, ends in ((current(name), ends) for name, ends in read.items()):
        key = f"curve_{name}" if f"curve_{name}" in stored else name
        if key == name and name not in stored.observables:
            raise no_such("observable of --range", name, stored.observables)
        low, high = (float(end) for end in labels.in_label_unit(stored[key], ends))
        if not -FARTHEST <= low < high <= FARTHEST or high - low < max(LEAST_RANGE * max(-low, high), 1 / FARTHEST):
            raise InputError(
                f"--range takes NAME=LOW:HIGH with a lower and a higher number of at most {FARTHEST:g} that differ in "
                f"their first nine digits, got {name}={ends[0]:g}:{ends[1]:g}"
            )
        known[name] = low, high
    return known


def _story(folder: Path, wanted: PlotOptions) -> Result:
    """Draw the figure of the datasets that reproduce wrote into a folder."""
    from studies import tenants

    from ..figures import canvas
    from ..figures.sheet import sheet
    from ..stored import reading

    story = tenants.module_of("workbench.paper.story")
    path = check_file(wanted.out or folder / "story.png", canvas.DIAGRAMS, wanted.force)
    datasets = {name: reading.read_stored(folder / f"{name}.h5", study=name != story.CLAIMS) for name in story.NEEDED}
    drawn = story.figure(datasets, sheet("paper", wanted.width or 183, titled=False))
    canvas.save(drawn, path, wanted.dpi)
    return result_of_files([path], [*canvas.caption(drawn), str(path)])
