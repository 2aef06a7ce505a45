"""The pictures of the kinds of scene, and the two at the top of the README.

`python -m docs.scene_pictures FOLDER NAMES`; without names all are drawn. rod.png shows one rod in the four kinds of
scene that show one. hero_sweep.webp is animated: a rod in a tube that is pushed and released. hero_page.png shows the
live page; a Chromium on PATH draws it.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import cos, pi
from pathlib import Path

from matplotlib import rc_context

from solver import equilibria as every
from studies import load
from studies.grammar.axes import Axis
from workbench.branches.ends_study import ends_problem
from workbench.branches.equilibria_dataset import as_dataset
from workbench.figures import fonts
from workbench.run import atomic, in_memory
from workbench.scene import body, composition, film, layout, page, scene_kinds, signs
from workbench.scene.views import View, camera_before
from workbench.stored.stored_study import StoredStudy
from workbench.web import pages
from workbench.web.live import live_document, presets

DPI = 200  # of print
SWEEP, PAGE = "hero_sweep", "hero_page"
# of the animated picture: as wide to its height as the other, and from where its turns are seen as such
HERO = composition.Settings(dpi=160, size=(860, 600), camera="-35,45")
# there and back: 120 frames; slow near both ends, so that nothing jumps where the loop begins again
FORCES = [-10.0 - 25.0 * (1 - cos(pi * k / 60)) for k in range(61)]
OWN = ("inside", "long")  # drawn as `contact`
# from where both ends are seen; the colours of most of the rod, as its tightest bends have six times the push
LOOKS = {"inside": composition.Settings(dpi=DPI, camera="140,15", color_range=(-200.0, 200.0))}
RODS = Path(__file__).with_name("scene_rods")  # the studies of the pictures that are of no shipped study
ROD, VIEWS = "rod", ("plain", "contact", "curvature", "twist")  # four kinds of one rod, two by two
BAR_BELOW = 0.4  # inches from a view to the scale below it
BROWSERS = ("chromium", "chromium-browser", "google-chrome-stable", "google-chrome", "chrome")
SIZE = (430, 300)  # CSS pixels of the page: on a phone its letters are hardly smaller
RATIO = 2.5  # pixels of the picture per CSS pixel
SETTLED = 8000  # ms of the page's own clock, after which it has drawn everything at rest
PATIENCE = 120  # s
FLAGS = (
    "--headless",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    f"--window-size={SIZE[0]},{SIZE[1]}",
    f"--force-device-scale-factor={RATIO}",
    f"--virtual-time-budget={SETTLED}",
)


def main(folder: str = "pictures", *only: str) -> None:
    """Draw the pictures of these names into a folder; default: all."""
    datasets, out = _datasets(), Path(folder)
    known = dict.fromkeys(datasets, ".png") | {SWEEP: ".webp", PAGE: ".png"}
    if strange := [name for name in only if name not in known]:
        sys.exit(f"no picture {strange[0]!r}; choose from {', '.join(known)}")
    out.mkdir(parents=True, exist_ok=True)
    for name in only or known:
        path = out / f"{name}{known[name]}"
        if name == PAGE:
            draw_page(path)
        elif name == ROD:
            _draw_four_views(datasets[name](), path)
        else:
            _draw_scene(datasets[name](), path)
        print(path)


def _draw_scene(rods: StoredStudy, path: Path) -> None:
    """Draw one scene, or the rod along the axis of the film and back."""
    if path.stem == SWEEP:
        film.write([path], film.frames(rods, film.Film("F3", {}, settings=HERO)), back=True)
        return
    kind, axes = "contact" if path.stem in OWN else path.stem, ["F1", "F3"] if path.stem == "grid" else []
    settings = LOOKS.get(path.stem, composition.Settings(dpi=DPI))
    layout.render(rods, path, None, kind, axes, settings=settings, level=9)


def _draw_four_views(rods: StoredStudy, path: Path) -> None:
    """Draw a rod in four kinds of scene, two by two, with one key; the scale of a kind stands below its view."""
    where, views = rods.place(None), []
    for letter, name in zip("abcd", VIEWS, strict=True):
        kind = scene_kinds.kind_of(name)
        rod = body.read(rods, where, kind)
        rod = replace(rod, paint=kind.paint(rods.units, rod.extremes() if kind.value else None))
        views.append(View([rod], scene_kinds.Cell(f"{letter}  {name}\n\n\n ")))
    each = [rod for view in views for rod in view.bodies]
    camera = camera_before(each, None, None)[0]
    kind = replace(scene_kinds.kind_of(VIEWS[-1]), cells="together")  # each rod has colours of its own
    settings = composition.Settings(dpi=DPI)
    picture = composition.compose(page.Scene(rods, kind, [views[:2], views[2:]], each, "", camera, settings))
    with rc_context(fonts.RC):
        for rod, (x, y, wide, high) in zip(each, picture.boxes.reshape(-1, 4), strict=True):
            left, down = x + (wide - page.BAR) / 2, y + high + BAR_BELOW
            if rod.paint.label:
                signs.draw_bar(picture.ax, rod.paint, (left, down), (page.BAR, 0.1))
    page.save(picture, path, level=9)


def _datasets() -> dict[str, Callable[[], StoredStudy]]:
    """What solves the dataset of each picture."""

    def equilibria() -> StoredStudy:
        study = load("fig7_4_end_angle")
        case = ends_problem(study)
        return StoredStudy(as_dataset(study, case, every(case)))

    def run(study: str | Path, title: str = "", **axes: list[float]) -> StoredStudy:
        chosen = load(study)
        values = {name: Axis.model_validate({"values": each}) for name, each in axes.items()}
        changes = {"title": title or chosen.title, "axes": values or chosen.axes}
        return StoredStudy(in_memory.run(chosen.model_copy(update=changes)))

    return {
        ROD: partial(run, "fig6", "The rod of Table 1"),
        "ghosts": partial(run, "fig7_1_modulus", "Three rods, from soft to stiff"),
        "grid": partial(run, "fig7_5_forces", "Pulled hard enough, each rod passes through itself"),
        "equilibria": equilibria,
        **{name: partial(run, RODS / f"{name}.toml") for name in OWN},
        SWEEP: partial(run, RODS / f"{SWEEP}.toml", F3=FORCES[::-1]),
    }


def browser() -> str | None:
    """The path of a Chromium that PATH names; None without one."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def draw_page(path: Path) -> None:
    """Write a PNG of the live page with the rod of Table 1. Ends the script with one sentence where this fails."""
    program = browser()
    if program is None:
        sys.exit(f"{path.name} is left out: no browser was found on PATH (looked for {', '.join(BROWSERS)})")
    with tempfile.TemporaryDirectory(prefix="still-", dir=path.parent, ignore_cleanup_errors=True) as name:
        folder = Path(name).resolve()
        style, frame = (RODS.joinpath(f"still.{end}").read_text(encoding="utf-8") for end in ("css", "html"))
        (folder / "page.html").write_text(live_document.text(presets.PRESETS, False, style), encoding="utf-8")
        (folder / "frame.html").write_text(pages.fill(frame, wide=SIZE[0], high=SIZE[1]), encoding="utf-8")
        shot, options = folder / "shot.png", [f"--user-data-dir={folder / 'profile'}"]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            options.append("--no-sandbox")  # Chromium refuses root otherwise
        command = [program, *FLAGS, *options, f"--screenshot={shot}", (folder / "frame.html").as_uri()]
        subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=PATIENCE, check=False)
        if not shot.exists():
            sys.exit(f"{path.name} is left out: {program} took no picture")
        atomic.write(path, lambda aside: shutil.copyfile(shot, aside))


if __name__ == "__main__":
    main(*sys.argv[1:])
