"""The pages of the documentation run as they stand: studies, tables, commands and Python, in the order of the page."""

import re
import subprocess
import sys
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from textwrap import dedent

import numpy as np
import pytest
from rich.console import Console

from tests.workbench import doc_pages
from tests.workbench.command import run
from tests.workbench.pictures import pixels
from workbench.commands import console

PAPER = " --style paper --no-title"  # as the page on diagrams says that the pictures of the pages are drawn
DOCS = Path(__file__).parents[2] / "docs"
FENCE = re.compile(r"^ *```(\w+|\{code-cell\} python)\n(.*?)^ *```$", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Page:
    """What a page needs beside itself, and what it does not say itself.

    files: names of its studies and tables, in order, where their first line gives none. before: commands that the page
    takes as run. status: of a command that ends with another one than 0, as the page says. left: commands that need
    OpenGL, or files of the reader. said: what is printed. made: files that are made. python: whether its Python is
    "left", only "run", or "checked" to print what the comments behind its prints say. quick: not a slow test.
    needs: a package that it cannot run without.
    """

    name: str
    part: str = ""
    files: tuple[str, ...] = ()
    before: tuple[str, ...] = ()
    status: dict[str, int] = field(default_factory=dict)
    left: tuple[str, ...] = ()
    said: tuple[str, ...] = ()
    made: tuple[str, ...] = ()
    python: str = "checked"
    quick: bool = False
    needs: str = ""


UNDETERMINED = "fit --table1 --M3 17 --points points.csv --vary E,M3,F3"
UNKNOWN = ("workbench scene", "workbench equilibria pipe.toml", "workbench solve pipe.toml", "workbench explore")
LYING = (
    "folds --length-unit m --EI 1 --GJ 1 --a 0.05 --L 6 --weight 1 --R 0.15 --side inside --inclination 90deg --M10 0 "
    "--M1L 0 --azimuth 0 --axis FZ=-6.2:-5 --axis weight=0.7:0.9 --plot lying.png"
)
HELD = (
    "folds --length-unit cm --force-unit N --E 10700 --nu 0.25 --a 0.25 --L 4 --R 0.75 --beta0 0.5 --betaL 0.8 "
    "--height 2.5 --azimuth 0.5 --axis height=3.2:3.6 --axis azimuth=0:1 --plot held.png"
)
SOFT = "how-to/analyse-stored-studies"
PAGES = [
    Page(
        SOFT, files=("soft.toml",), quick=True, status={"run stiff.toml": 1},
        said=("method swing, tolerance 1e-08; ", "largest condition: 22.217 at E = 9000, R = 0.5",
              "kappa_max 2.6139 3.5908 5.1185 1/cm", "48 cases, 0 unsolved"),
    ),
    Page("how-to/close-a-rod", left=UNKNOWN, made=("loops.png",)),
    Page("how-to/draw-diagrams", made=("curves.png", "portraits.png", "ridge.pdf", "ridge.csv")),
    Page(
        "how-to/draw-diagrams", "Draw a map", files=("three.toml",), status={"run regimes": 1},
        said=("true for 12 of 19 values of R",),
        made=("regimes.png", "bends.pdf", "turned.png", "lines.png", "three.png", "one.png"),
    ),
    Page("how-to/find-equilibria", left=UNKNOWN, python="left", made=("all.png", "b.png")),
    Page(
        "how-to/find-equilibria", "Map the folds", status={LYING: 1, HELD: 1},
        made=("folds_atlas.png", "buckling.png", "held.png", "lying.png"),
    ),
    Page(
        "how-to/find-equilibria", "Follow a branch", files=("snap.toml",), made=("dead.png", "held.png"),
        said=("14 branches, 9 folds over 21 values of FZ", "1 branch, 0 folds over 21 values of height"),
    ),
    Page("how-to/find-what-matters", files=("matters.toml",), made=("tornado.png", "sobol_indices.png"),
         said=("3072 cases, 0 unsolved", "height R 0.021 ± 0.078 0.448 ± 0.053")),
    Page("how-to/find-what-matters", "Differentiate a solution", quick=True),
    Page(
        "how-to/fit-parameters", files=("points.csv",), status={UNDETERMINED: 1}, made=("fit.png",),
        said=("F1 3.0812", "2.742", "reaches the target", "9 (bound)", "condition number 6.3",
              "caution: the data are also reached at 1 other minimum: the values are not unique",
              "E, M3 and F3 by +1 % each",
              "the data cannot tell E and M3 and F3 apart: no datum changes when these change together"),
    ),
    Page(
        "how-to/hold-the-ends", made=("held_height.png", "held_hinges.png", "held_equilibria.png"),
        said=("2 equilibria compared, 2 stable; shown: the stable one of least held energy",
              "index 0 under held ends, 0 under dead loads", "8 equilibria, 2 stable under held ends: height",
              "the seed, 0.", "rad from the seed",
              "equilibria, not proved complete: searched over FZ from -60 to 0"),
    ),
    Page("how-to/is-my-pipe-buckled", made=("pipe_states.png",)),
    Page("how-to/sample-a-study", "Refine a boundary", files=("", "critical.toml"), made=("critical.png",),
         said=("29947 cases, 6.7 % of the uniform grid of 769 x 577", "113 cases, 0 unsolved", "bends E 3 ")),
    Page("how-to/sample-a-study", files=("", "", "cases.csv", "measured.toml"),
         said=("256 cases, 0 unsolved", "256 samples of E, R, F1: scrambled Sobol' sequence", "3 samples of E,")),
    Page("how-to/use-other-programs", files=("moduli.toml",), said=("5000.0 8 4.542 7.563",),
         made=("stations.csv", "moduli.png")),
    Page("how-to/what-a-real-rod-does", left=("workbench scene",), needs="unopy", made=("real.png", "cable.step"),
         said=("the rod lies on 58 % of its length on the wall, at s = 3.5 to 15 cm",
               "falls by 5.5 %, from 39.74 to 37.56 N cm", "9 cases, 0 unsolved", "lies on 81 % of its length")),
    Page("how-to/wind-a-cable", left=UNKNOWN, quick=True),
    Page("how-to/write-your-own-in-python", made=("own.png", "family.png"),
         said=("1 passed", "[5, 5, 4, 4]", "solved True [9.65, ")),
    Page("how-to/write-a-study", "Write a law", files=("pipe.toml",), status={"run pipe.toml": 1}),
    Page("tutorial/a-notebook", made=("rod.pdf", "rod.html")),
    Page("tutorial/reproduce-a-figure", files=("radius.toml",), left=UNKNOWN,
         said=("8 → 5", "6 → 3", "9 cases, 0 unsolved")),
    Page("tutorial/solve-from-python", quick=True, python="run",
         said=("solved (201,) 7.075", "(9, 201) [8 7 6 6 6 5 5 5 5] True", "21 True")),
]  # fmt: skip


def parameter(page: Page):
    return pytest.param(page, id=f"{page.name} {page.part}".strip(), marks=() if page.quick else pytest.mark.slow)


def imports_what_is_installed(python: str) -> bool:
    """Whether a block of Python can run: some pages use packages that the tests do not need."""
    return all(find_spec(name) for name in re.findall(r"^ *import (\w+)", python, re.MULTILINE))


def words(text: str) -> str:
    return " ".join(text.split())


def check_picture(shown: Path, made: Path) -> None:
    """A picture of the page is the one that its command makes, but for the hinting of letters."""
    a, b = pixels(shown), pixels(made)
    assert a.shape[1] / a.shape[0] == pytest.approx(b.shape[1] / b.shape[0], rel=0.01), shown
    if a.shape == b.shape:
        assert np.abs(a - b).mean() < 0.02, shown


@pytest.mark.parametrize("page", [parameter(page) for page in PAGES])
def test_a_page_runs_as_it_stands(page: Page, tmp_path: Path, monkeypatch, capsys) -> None:
    if page.needs:
        pytest.importorskip(page.needs)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(console, "out", lambda: Console(width=80))
    for line in page.before:
        run(line)
    text = doc_pages.read(DOCS / f"{page.name}.md", page.part)
    files, names, printed = iter(page.files), {"__name__": "__main__"}, ""
    for language, body in FENCE.findall(text):
        if language in ("toml", "csv"):
            first = re.match(r"# (\w+\.\w+)\n", body)
            if name := first[1] if first else next(files, ""):
                Path(name).write_text(body, encoding="utf-8")
            if name == "soft.toml":  # the page says in words how the second study differs
                stiff = body.replace("Soft", "Stiff").replace("5e3", "2.1e4")
                stiff = stiff.replace("to = 2e4\ncount = 16", "to = 4e4\ncount = 20")
                Path("stiff.toml").write_text(stiff, encoding="utf-8")
        elif language == "sh":
            for line in map(str.strip, body.replace(" && ", "\n").splitlines()):
                if line.startswith("python "):
                    printed += subprocess.check_output([sys.executable, *line.split()[1:]], text=True)
                if line.startswith("workbench ") and not line.startswith(page.left or "-"):
                    drawn = re.search(r"^workbench plot | --plot ", line) and "--style" not in line
                    run(line + PAPER * bool(drawn), page.status.get(line.removeprefix("workbench "), 0))
        elif language.endswith("python") and page.python != "left" and imports_what_is_installed(body):
            printed += capsys.readouterr().out
            if first := re.match(r"# (\w+\.py)\n", body):
                Path(first[1]).write_text(body, encoding="utf-8")
            exec(compile(dedent(body), page.name, "exec"), names)
            out = capsys.readouterr().out
            if page.python == "checked":
                assert set(doc_pages.printed(body)) <= set(out.splitlines())
            printed += out
    printed = words(printed + capsys.readouterr().out)
    for block in [body for language, body in FENCE.findall(text) if language == "text"]:
        assert all(words(line) in printed for line in block.splitlines()), block
    for part in page.said:
        assert part in printed
    for name in page.made:
        assert Path(name).stat().st_size > 5_000, name
    for name in re.findall(r"\(\.\./figures/([\w-]+\.png)\)", text):
        if Path(name).exists():
            check_picture(DOCS / "figures" / name, Path(name))
