"""One stored rod as a file for other programs, or those along an axis as one file each.

A rod is solved only where its stations are too few for the file and a study gives its case.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from solver.problem.errors import InputError, choices

from ..geometry import solid_body
from ..geometry.centreline import Centreline, TooFewStations, advice_to_store
from ..geometry.tube_tolerance import push_along
from ..run import atomic, writing
from ..stored.enough_stations import at_needed_stations, solver_of
from ..stored.stored_study import StoredStudy
from . import FORMATS, pvd, surface_files
from .file_format import ExportedRod, ExportOptions, Format, metres

DEFAULT = ExportOptions()
LARGE = 100e6  # bytes of meshes, of which is told before they are written
NUMBERED = re.compile(r"[^{}]*\{(:0?\d*d)?\}[^{}]*")  # the name of a file for each value of an axis


@dataclass(frozen=True)
class Exported:
    """A file that was written: the case, numbers about the file by name, and what a real rod could not do."""

    path: Path
    at: dict[str, float]
    facts: dict[str, Any]
    warnings: list[str]


def format_of(path: Path) -> Format:
    """The format of a file, by its suffix. Raises `InputError` with the choices."""
    return _format(atomic.check_name(path, tuple(FORMATS)).suffix.lower())


def _format(suffix: str) -> Format:
    row: Format = import_module(f".{FORMATS[suffix]}", __package__).FORMAT
    return row


def check_holds_all(stored: StoredStudy, path: Path) -> None:
    """Raise `InputError` where the files of that name would not hold every rod of a dataset."""
    axes = stored.varied
    if len(axes) > 1:
        raise InputError(f"files go along one axis, and these rods vary along {choices(axes)}: solve those along one")
    if axes and not format_of(path).series and "{" not in path.name:
        numbered = f"{path.stem}_{{:03d}}{path.suffix}"
        raise InputError(
            f"{path.name} holds one rod, and there are {stored.sizes[axes[0]]} along {axes[0]}: give a name with a "
            f"number in braces, such as {numbered}, or one that ends in .pvd"
        )


def _suffixes(able: Callable[[Format], object]) -> str:
    """The suffixes of the formats that are able to do something, as choices."""
    return choices(suffix for suffix in FORMATS if able(_format(suffix)))


def export(
    stored: StoredStudy,
    path: Path,
    options: ExportOptions = DEFAULT,
    force: bool = False,
    tell: Callable[[str], object] = str,
) -> Exported:
    """Write one case of a dataset to a file. Nothing is left where it fails.

    Parameters
    ----------
    stored : StoredStudy
        Of a stored study, or of `Solution.to_dataset`: its ``.rod``.
    path : Path
        Its suffix chooses the format: docs/how-to/solve-one-rod.md. With a number in its name, as in
        ``frame_{:03d}.stl``, each solved rod along the one axis that the options do not name is a file.
    options : Options
        Which case, how exactly, and what to do with a rod that passes through itself.
    force : bool
        Replace an existing file.
    tell : callable
        Called with a sentence before meshes of more than 100 MB are written; default: nothing is called.

    Returns
    -------
    Exported
        The file, numbers about it, and what a real rod could not do.

    Raises
    ------
    InputError
        An invalid name, value or file, an existing file without `force`, a case without a shape, too few stations, or a
        solid that the rod cannot be.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from solver import Case, Cylinder, Rod, Start, solve
    >>> import workbench.accessor
    >>> from workbench.export.stored_rod import export
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    >>> sol = solve(Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)))
    >>> with TemporaryDirectory() as folder:
    ...     written = export(sol.to_dataset(length="cm", force="N").rod, Path(folder) / "rod.csv")
    >>> written.path.name
    'rod.csv'
    """
    format = format_of(path)
    if options.centreline and not format.has_centreline:
        able = _suffixes(lambda each: each.has_centreline)
        raise InputError(f"--centreline is for {able}, got {path.name!r}")
    if options.color is not None and not format.coloured:
        able = _suffixes(lambda each: each.coloured)
        raise InputError(f"--color is for {able}: {path.suffix} has no colours")
    if options.tolerance is not None and format.tolerance is None:
        able = _suffixes(lambda each: each.tolerance)
        raise InputError(f"--tolerance is for {able}; {path.suffix} holds the stations as they are stored")
    if options.tolerance is not None and not 0 < options.tolerance < np.inf:
        raise InputError(f"--tolerance must be positive and finite, got {options.tolerance:g}")
    _check_triangles(path, options, format)
    if format.series:  # an index, and a folder of files beside it
        pvd.check_free(path, force)
        series = pvd.along(stored, path.stem, options)
        return Exported(path, series.at, _write_file(path, series, format, force), [])
    if "{" in path.name:
        return _frames(stored, path, options, force, format, tell)
    where = stored.place(options.at)
    at = {name: float(stored[name].values[i]) for name, i in where.items()}
    title = " ".join([str(stored.attrs["study_name"]), *(f"{name}={value:.6g}" for name, value in at.items())])
    rod = ExportedRod(stored, where, stored.select(where).centreline, title, options)
    _tell_size(path, [rod], format, tell)
    facts, warnings = _write(path, rod, format, force)
    return Exported(path, at, facts, warnings)


def _check_triangles(path: Path, options: ExportOptions, format: Format) -> None:
    """Raise `InputError` for a number of triangles that is none, is not of a mesh, or beside a tolerance."""
    if options.triangles is None:
        return
    if not format.triangle_bytes:
        able = _suffixes(lambda each: each.triangle_bytes)
        raise InputError(f"--triangles is for the meshes {able}, got {path.name!r}")
    if options.tolerance is not None:
        raise InputError("--triangles and --tolerance each fix the mesh: give one of them")
    if options.triangles < 1:
        raise InputError(f"--triangles must be positive, got {options.triangles}")


def _tolerance(line: Centreline, format: Format, options: ExportOptions) -> float:
    """The tolerance of the file of a rod [length]. Raises `InputError` where a mesh takes more triangles than asked."""
    if options.triangles is not None:
        return surface_files.within(line, options.triangles)
    assert format.tolerance is not None
    return options.tolerance or format.tolerance(line)


def _tell_size(path: Path, rods: Sequence[ExportedRod], format: Format, tell: Callable[[str], object]) -> None:
    """Tell about how large the files of meshes will be, where that is more than `LARGE`."""
    if not format.triangle_bytes:
        return
    count = 0
    for rod in rods:
        try:
            tolerance = _tolerance(rod.line, format, rod.options)
            count += surface_files.triangles_of(rod.line, tolerance, rod.options.triangles)
        except InputError:  # which is said where that rod is written
            continue
    size = count * format.triangle_bytes[path.suffix.lower()]
    if size > LARGE:
        files = f"{path.name}: {len(rods)} files of" if len(rods) > 1 else f"{path.name}:"
        tell(f"{files} {count} triangles, about {size / 1e6:.0f} MB; --triangles and --tolerance make a smaller mesh")


def _write(path: Path, rod: ExportedRod, format: Format, force: bool) -> tuple[dict[str, Any], list[str]]:
    """Write one rod; returns numbers about the file by name, and what a real rod could not do. Raises `InputError`."""
    options = rod.options
    facts: dict[str, Any] = {}
    if format.tolerance is not None:
        stations, own_error = rod.line.s.size, _own_error(rod)
        rod = _at_needed_stations(rod, format, own_error)
        unit = format.unit or rod.unit
        facts = {"tolerance": rod.tolerance, "unit": unit}
        if rod.line.s.size > stations:
            facts["solved_at"] = rod.line.s.size
        if own_error:
            facts["solution_error"] = own_error
        facts["R"] = rod.line.R if unit == rod.unit else rod.line.R * metres(rod.unit) / metres(unit)
    faults = [] if format.body == "curve" or options.centreline else solid_body.findings(rod.line, rod.unit)
    for finding in faults if format.body == "solid" else []:
        if finding.tight or not options.overlap:
            also = "" if finding.tight else ", --overlap the solid all the same"
            raise atomic.Undone(f"no solid: {finding.sentence}; --centreline writes the curve alone{also}")
    return {**facts, **_write_file(path, rod, format, force)}, [finding.sentence for finding in faults]


def _own_error(rod: ExportedRod) -> float:
    """The estimated error of the stored rod at its stations [length]; 0 where none is stored."""
    if "error" not in rod.stored:
        return 0.0
    error = float(rod.stored["error"].isel(rod.where))  # of beta, and of alpha and z/rho divided by max(1, L/rho)
    return error * max(rod.line.L, rod.line.rho)


def _at_needed_stations(rod: ExportedRod, format: Format, own_error: float) -> ExportedRod:
    """The rod with the tolerance that its file keeps, solved again where its stations are too few for that.

    own_error: of the rod [length]. Where no tolerance is given, the file keeps the one that the stations allow, as long
    as they fix the rod between them to that error; and within a number of triangles also where no study gives the rod.
    Any other lack of stations raises `TooFewStations`.
    """

    def draw(stored: StoredStudy, strict: bool) -> ExportedRod:
        line = rod.line if stored is rod.stored else stored.select(dict.fromkeys(rod.where, 0)).centreline
        tolerance = _tolerance(line, format, rod.options)
        least = (line.cubic_error if format.cubic else line.error) / format.curve_share
        is_own = rod.options.tolerance is None and format.curve_share * least <= own_error
        if is_own or (rod.options.triangles is not None and not strict):
            tolerance = max(tolerance, least)
        line.check(tolerance, format.curve_share, format.cubic)
        if format.coloured and (more := push_along(line).stations()) > (n := line.s.size):
            few = f"{n} stations are too few for the colours of the push between them: {advice_to_store(more)}"
            raise TooFewStations(few, more)
        return replace(rod, line=line, tolerance=tolerance)

    return at_needed_stations(rod.stored, solver_of(rod.stored, rod.where, ()), draw)[0]


def _frames(
    stored: StoredStudy, path: Path, options: ExportOptions, force: bool, format: Format, tell: Callable[[str], object]
) -> Exported:
    """Write each solved rod along an axis to a file of its own; a rod that the format cannot hold is left out."""
    series = pvd.along(stored, path.stem, options)
    places = [rod.where[series.axis] for rod in series.rods]
    files = [path.with_name(name_of_file(path.name, i)) for i in places]
    for file in files:
        writing.check_new(file, force)
    _tell_size(path, series.rods, format, tell)
    facts: dict[str, Any] = {}
    warnings, values, few = list[str](), [], list[tuple[str, TooFewStations]]()
    for file, rod, value in zip(files, series.rods, series.values, strict=True):
        case = f"{series.axis}={value:.6g}"
        try:
            facts, more = _write(file, rod, format, force)
        except TooFewStations as error:
            few.append((case, error))
            continue
        except InputError as error:
            warnings.append(f"{case} is left out: {error}")
            continue
        values.append(value)
        warnings += [f"{case}: {sentence}" for sentence in more]
    if few:
        case, worst = max(few, key=lambda each: each[1].stations)
        also = f", as {len(few) - 1} others with too few stations are," if len(few) > 1 else ""
        warnings.append(f"{case} is left out{also}: {worst}")
    if not values:
        raise InputError(f"no rod along {series.axis} could be written; {warnings[0]}")
    kept = {name: facts[name] for name in ("unit", "without") if name in facts}
    about = {"axis": series.axis, "files": len(values), "unsolved": series.skipped, "values": values}
    return Exported(path, series.at, about | kept, warnings)


def name_of_file(name: str, i: int) -> str:
    """The name of the i-th file. Raises `InputError` for a pattern that does not hold one whole number."""
    if not NUMBERED.fullmatch(name):
        raise InputError(f"the name {name!r} must hold one number in braces, such as frame_{{:03d}}{Path(name).suffix}")
    return name.format(i)


def _write_file(path: Path, content: Any, format: Format, force: bool) -> dict[str, Any]:
    """Write a rod or a series beside `path` under a name of the same suffix, and move that there once it is complete.

    Returns numbers about the file by name. Raises `InputError` for an existing file without `force`, or where the
    folder cannot be written.
    """
    writing.check_new(path, force)
    facts: dict[str, Any] = {}
    atomic.write(path, lambda aside: facts.update(format.write(aside, content)))
    return facts
