"""A picture of the live page: the saved page in a browser without a window, without the controls.

It stands in half of the width of a text, where only the rod and two diagrams can be read.
"""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from ...store import atomic
from . import live_document
from .presets import PRESETS

BROWSERS = ("chromium", "chromium-browser", "google-chrome-stable", "google-chrome", "chrome")
SIZE = (540, 377)  # CSS pixels of the page
RATIO = 2  # pixels of the picture per CSS pixel
STYLE = """
.controls, .facts, .legend, .tools, .scale, .triad, .diagram:not(:has(#d-beta, #d-push)) { display: none; }
#page { display: grid; grid-template: "stage diagrams" 100vh / 170px 1fr; }
.stage { display: block; position: static; padding: 6px; border: 0; }
.view { position: relative; height: 100%; border-width: 1px; border-radius: 6px; }
.diagrams { border: 0; padding: 0 4px; display: block; overflow: hidden; }
"""
SETTLED = 8000  # ms of the page's own clock, after which it has drawn everything at rest
PATIENCE = 120  # s
# A browser resizes its window for the picture, and the page then draws coarsely for a moment: in a frame it keeps its
# size.
FRAME = """<!doctype html><meta charset="utf-8"><title>still</title>
<style>body {{ margin: 0 }} iframe {{ border: 0; display: block; width: {0}px; height: {1}px }}</style>
<iframe src="page.html"></iframe>"""
FLAGS = (
    "--headless", "--disable-gpu", "--enable-unsafe-swiftshader", "--hide-scrollbars", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    f"--window-size={SIZE[0]},{SIZE[1]}", f"--force-device-scale-factor={RATIO}", f"--virtual-time-budget={SETTLED}",
)  # fmt: skip


def browser() -> str | None:
    """The path of a Chromium that PATH names; None without one."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def take(path: Path) -> str:
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
        (folder / "page.html").write_text(live_document.text(PRESETS, False, STYLE), encoding="utf-8")
        (folder / "frame.html").write_text(FRAME.format(*SIZE), encoding="utf-8")
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
