"""The command scene: a stored dataset, or a study, drawn in three dimensions."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from solver.problem.errors import InputError, choices

from ..run import atomic
from .options import argument, axis_values, check_file
from .present import Result, presents, result_of_files
from .scene_options import OF_FILM, OF_PICTURE, SceneOptions

if TYPE_CHECKING:
    from studies import Study

    from ..scene.page import Page
    from ..scene.scene_kinds import SceneKind
    from ..scene.settings import Settings
    from ..stored.stored_study import StoredStudy

PAGE, PAGE_KIND = ".html", "contact"  # the suffix of a page, and the kind of scene that it shows
PAGE_FIRST = 201  # stations that are tried first for a page of a study


@presents()
def scene(
    file: Annotated[
        Path,
        argument(
            "FILE|STUDY",
            "Stored study, equilibria or branches; or the TOML file or name of a study, which is then solved with the "
            "stations that the picture needs.",
        ),
    ],
    wanted: SceneOptions,
) -> Result:
    """Draw the rod on its cylinder in three dimensions.

    A stored study with too few stations is solved again. Exit status 1 if OpenGL does not work on this machine, or if a
    file without a study has too few stations for --pixel-error.
    """
    from ..scene import film
    from ..stored import file_kinds, reading
    from ..stored.case_of_file import is_study
    from . import study_scene

    out, suffix = wanted.out, "" if wanted.out is None else wanted.out.suffix.lower()
    is_film = suffix in film.SUFFIXES or wanted.has_film_pictures
    if wanted.flags_of(*OF_FILM) and not is_film:
        raise InputError(
            f"--show, --fps, --frames and --stored are for films: give --out NAME, with {choices(film.SUFFIXES)}, or "
            "--frames with a picture for each, frame_{:03d}.png"
        )
    is_stored = file.is_file() and not is_study(file)
    if is_stored and reading.kind_of_file(file) is file_kinds.BRANCHES:
        from . import scene_branches

        return scene_branches.scene_of(file, reading.read_stored(file, study=False), wanted)
    if out is not None and is_film:
        if len({*wanted.axes, wanted.along} - {None}) > 1:
            raise InputError(f"a film runs along one axis, got {choices([*wanted.axes, wanted.along])}")
        from . import scene_film

        return scene_film.film_of(file, out, wanted)
    alien = [f"--kind {wanted.kind}"] * (wanted.kind not in (None, PAGE_KIND, "equilibria"))
    alien += wanted.flags_of("axis", "along", "color", *OF_PICTURE)
    if suffix == PAGE and alien:
        raise InputError(
            f"an {PAGE} file shows the kind {PAGE_KIND} of all cases that --at leaves, without {choices(alien)}, "
            "for pictures alone, .png and .jpg"
        )
    settings = wanted.settings()
    study, rods = study_scene.open_rods(file)
    where = axis_values(rods, wanted.at)
    if out is not None and suffix == PAGE:
        look = settings.look if wanted.theme or wanted.background else None
        return _page(study, rods, where, check_file(out, (PAGE,), wanted.force), look)
    return _pictures(file if study is None else Path(f"{study.name}.h5"), study, rods, where, settings, wanted)


def _pictures(
    file: Path,
    study: "Study | None",
    rods: "StoredStudy",
    where: "dict[str, float]",
    settings: "Settings",
    wanted: SceneOptions,
) -> Result:
    """Draw one picture, or one for each case along an axis, at as many stations as it needs."""
    from ..scene import opengl, scene_kinds
    from ..scene.settings import PICTURES, check_name
    from ..stored import chosen_cases
    from ..stored.enough_stations import at_needed_stations
    from . import study_scene

    axes, along, out = wanted.axes, wanted.along, wanted.out
    chosen = scene_kinds.kind_of(wanted.kind or scene_kinds.default_kind(rods))
    if chosen.name == scene_kinds.LET_GO and axes:
        raise InputError(
            f"a scene of kind {chosen.name} shows one case before and after, so it takes no --axis: use --at"
        )
    case = [f"{name}={chosen_cases.write(name, value)}" for name, value in where.items()]
    named = [] if chosen.name in ("contact", "equilibria") else [chosen.name, *axes]
    default = file.with_name("_".join([file.stem, "scene", *named, *case]) + ".png")
    frames_of = None
    if out is not None and "{" in out.name:
        frames_of = _frames(rods, where, out, along, chosen, wanted.force)
    path = out if frames_of and out is not None else check_file(out or default, PICTURES, wanted.force)
    check_name(path, settings)
    opengl.check()
    from ..figures import canvas
    from ..scene import layout

    def draw(rods: "StoredStudy", strict: bool) -> "Page":
        if frames_of:
            (way, places), drawn = frames_of, replace(settings, strict=strict)
            pages = (layout.render(rods, file, where | {way: at}, chosen.name, axes, way, drawn) for at, file in places)
            return max(pages, key=lambda page: page.error)
        return layout.render(rods, path, where or None, chosen.name, axes, along, replace(settings, strict=strict))

    paths = [path]
    if frames_of:
        along, files = frames_of
        paths, case = [file for _, file in files], [f"{len(files)} values of {along}"]
    elif chosen.cells == "one" or chosen.name == scene_kinds.LET_GO:  # the case is named also where --at was not given
        indices = rods.place(where).items()
        case = [f"{name}={chosen_cases.write(name, float(rods[name].values[i]))}" for name, i in indices]
    shown = [*(axes or ([] if chosen.cells == "one" else rods.axes[:1])), *([along] if along else [])]
    solve = study_scene.solver_of(rods, chosen, where, shown)
    if chosen.name == scene_kinds.LET_GO:
        solve = study_scene.release_of(rods, where)
        rods, where, axes = solve(study_scene.FIRST), {}, [scene_kinds.RELEASED]
    elif solve is not None and (study is not None or rods.leaves):  # no file holds point forces
        rods = solve(study_scene.FIRST if study is not None else rods.sizes["u"])
    picture, stations = at_needed_stations(rods, solve, draw)
    solved = f", solved at {stations} stations" if study or stations != rods.sizes["u"] else ""
    said = [" at ".join([str(path), *([", ".join(case)] if case else [])]) + solved, *canvas.caption(picture.fig)]
    if picture.error <= wanted.pixel_error * (1 + 1e-9):
        return result_of_files(paths, said)
    reached = f"{picture.error:.1f} pixels, not {wanted.pixel_error:g}: {stations} stations are too few for that"
    warning = f"drawn to within {reached}, about {picture.stations} are needed"
    return result_of_files(paths, said, [warning], 1)


def _frames(
    rods: "StoredStudy", where: "dict[str, float]", out: Path, along: str | None, kind: "SceneKind", force: bool
) -> tuple[str, list[tuple[float, Path]]]:
    """The one axis along which a name with a number in braces asks for pictures, and the value of each solved case with
    its file. Raises `InputError` for another."""
    from ..export.stored_rod import name_of_file
    from ..scene.settings import PICTURES

    what = f"{out.name} has a picture for each case"
    if kind.cells != "one":
        raise InputError(f"{what} along one axis, and the kind {kind.name} shows several at once")
    way = rods.axis(along) if along else rods.axis_left(where, what, "choose one with --along")
    solved = [case[way] for case in rods.places(way, where) if rods["solved"].isel(case)]
    if not solved:
        raise InputError(f"no case along {way} is solved: there is nothing to draw")
    files = [check_file(out.with_name(name_of_file(out.name, i)), PICTURES, force) for i in solved]
    return way, [(float(rods[way].values[i]), file) for i, file in zip(solved, files, strict=True)]


def _page(
    study: "Study | None", stored: "StoredStudy", where: "dict[str, float]", path: Path, look: dict[str, str] | None
) -> Result:
    """A scene as one offline HTML file: every case that --at leaves; of status 1 where the stations are too few.

    look: of `Settings`; default: as the browser prefers.
    """
    from ..geometry.centreline import TooFewStations
    from ..scene.scene_kinds import kind_of
    from ..stored.enough_stations import at_needed_stations
    from ..web.turntable import turntable_page
    from . import study_scene

    sliders = [name for name in stored.axes if name not in where]
    solve = study_scene.solver_of(stored, kind_of(PAGE_KIND), where, sliders)
    if study is not None and solve is not None:
        stored = solve(PAGE_FIRST)

    def draw(stored: "StoredStudy", strict: bool) -> "tuple[str, int]":
        needed = _station_count(stored)
        if strict and needed > stored.sizes["u"]:
            raise TooFewStations("too few for a smooth rod", needed)
        return turntable_page.html(stored, where, look), needed

    (text, needed), stations = at_needed_stations(stored, solve, draw)
    atomic.write_text(path, text)
    said = [f"{path}: {len(text) / 1e6:.2g} MB, opens in a browser without a network"]
    if needed <= stations:
        return result_of_files([path], said)
    warning = f"{stations} stations are too few for a smooth rod, about {needed} are needed"
    return result_of_files([path], said, [warning], 1)


def _station_count(stored: "StoredStudy") -> int:
    """About how many stations the rods need for a curve without corners; as many as there are where these suffice."""
    from ..web.turntable.turntable_page import stations_for

    return max(int(stored.sizes["u"]), *(stations_for(case.centreline) for case in stored.each() if case["solved"]), 0)
