"""The live page as one HTML text: its markup, style, program, the compiled core and the data that it begins with.

The text loads nothing from any address. With a server it asks the server for what the page cannot compute; without one
it is a file that works offline.
"""

import base64
import gzip
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from solver.core import build
from solver.observe import observables
from solver.problem.errors import InputError
from solver.problem.quantities import QUANTITIES
from studies.paper.readings import READINGS

from ...figures import colours
from ...run import atomic
from ...words import labels
from .. import pages
from . import page_model
from .presets import PRESETS, Preset

PAGE = Path(__file__).parent / "page"
FIRST = "page"
_IMPORT = re.compile(r'^import (\{.*\}) from "\./(\w+)\.mjs";$', re.M)
_EXPORT = re.compile(r"^export ((?:async )?(?:const|function|class) (\w+))", re.M)
BROWSERS = ("chromium", "chromium-browser", "google-chrome-stable", "google-chrome", "chrome")
SIZE = (540, 377)  # CSS pixels of the page
RATIO = 2  # pixels of the picture per CSS pixel
SETTLED = 8000  # ms of the page's own clock, after which it has drawn everything at rest
PATIENCE = 120  # s
FLAGS = (
    "--headless", "--disable-gpu", "--enable-unsafe-swiftshader", "--hide-scrollbars", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    f"--window-size={SIZE[0]},{SIZE[1]}", f"--force-device-scale-factor={RATIO}", f"--virtual-time-budget={SETTLED}",
)  # fmt: skip


def text(presets: Sequence[Preset], served: bool, style: str = "") -> str:
    """The page.

    presets: the rods to begin with, the first is drawn. served: whether a server answers it. style: rules of CSS after
    those of the page.
    """
    style = read("shared.css") + read("page.css") + style
    scripts = {"core": core_script(), "program": bundle()}
    return pages.page(read("index.html"), style, scripts, _data(presets, served), served)


def core_text() -> str:
    """The compiled core for browsers, compressed and in base64, as `page/packed_core.mjs` reads it."""
    packed = gzip.compress((build.HERE / build.WASM).read_bytes(), mtime=0)
    return base64.b64encode(packed).decode("ascii")


def core_script() -> str:
    """The script that calls it."""
    return (build.HERE / "rod.js").read_text(encoding="utf-8")


def read(name: str) -> str:
    """The text of a file of the page."""
    return pages.read(__package__, "page", name)


def bundle(first: str = FIRST) -> str:
    """The modules that `first` needs as one script: each a function that returns its exports, after its imports."""
    source = {path.stem: path.read_text(encoding="utf-8") for path in PAGE.glob("*.mjs")}
    done: list[str] = []

    def add(name: str) -> None:
        for _, other in _IMPORT.findall(source[name]):
            if other not in done:
                add(other)
        done.append(name)

    add(first)
    return "\n".join(_module(name, source[name]) for name in done)


def _module(name: str, source: str) -> str:
    exported = ", ".join(export for _, export in _EXPORT.findall(source))
    body = _EXPORT.sub(r"\1", _IMPORT.sub(r"const \1 = module_\2;", source))
    if unknown := re.search(r"^(?:import|export)\b.*", body, re.M):
        raise ValueError(f"{name}.mjs: write import {{ ... }} or export const, function or class, not {unknown[0]}")
    return f"const module_{name} = (() => {{\n{body}return {{ {exported} }};\n}})();"


def _data(presets: Sequence[Preset], served: bool) -> dict[str, Any]:
    return {
        "served": served,
        "presets": [asdict(preset) | ({} if served else _begin(preset)) for preset in presets],
        "readings": list(READINGS),
        "quantities": {
            name: [row.symbol, labels.quantity_name(row.long_name), row.dimension] for name, row in QUANTITIES.items()
        },
        "branches": {
            "fields": page_model.FIELDS,
            "shown": page_model.SHOWN,
            "counts": [name for name in page_model.SHOWN if observables.is_count(name)],
        },
        "colours": colours.for_pages(),
        "core": core_text(),
    }


def _begin(preset: Preset) -> dict[str, Any]:
    """The solved shape of a rod between two ends, from which a page without a server follows. Raises `InputError`."""
    sol = page_model.shape(page_model.study_of(preset.state)).sol
    if sol.case.varies:
        raise InputError("a page without a server shows rods without weight and friction: use workbench explore")
    if sol.problem.kind != "ends":
        return {}
    return {"shape": page_model.round_rows({"s": sol.s, "beta": sol.beta, "dbeta": sol.dbeta}, 9)}


def browser() -> str | None:
    """The path of a Chromium that PATH names; None without one."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def take_picture(path: Path) -> str:
    """Write a PNG of the live page with the rod of Table 1; returns why there is none, or nothing.

    Raises `InputError` where the file cannot be written.
    """
    program = browser()
    if program is None:
        return f"no browser was found on PATH (looked for {', '.join(BROWSERS)})"
    with (
        atomic.refusing(path),
        tempfile.TemporaryDirectory(prefix="still-", dir=path.parent, ignore_cleanup_errors=True) as name,
    ):
        folder = Path(name).resolve()
        (folder / "page.html").write_text(text(PRESETS, False, read("still.css")), encoding="utf-8")
        (folder / "frame.html").write_text(pages.fill(read("still.html"), wide=SIZE[0], high=SIZE[1]), encoding="utf-8")
        shot, options = folder / "shot.png", [f"--user-data-dir={folder / 'profile'}"]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            options.append("--no-sandbox")  # Chromium refuses root otherwise
        command = [program, *FLAGS, *options, f"--screenshot={shot}", (folder / "frame.html").as_uri()]
        try:
            subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=PATIENCE, check=False)
        except subprocess.TimeoutExpired:
            return f"{program} took no picture within {PATIENCE} s"
        except OSError as error:
            return f"{program} did not start: {error.strerror or error}"
        if not shot.exists():
            return f"{program} took no picture"
        atomic.write(path, lambda aside: shutil.copyfile(shot, aside))
    return ""
