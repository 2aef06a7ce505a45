"""The command docs: open the documentation site."""

import shlex
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

from solver.problem.errors import InputError

from . import console
from .options import flag

ROOT = Path(__file__).resolve().parents[2]
# Where a site may lie: in a wheel that was made after the site was built, and in a checkout.
PLACES = (ROOT / "workbench" / "web" / "docs", ROOT / "build" / "docs" / "html")


BIBTEX = """@software{{rod_workbench,
  author  = {{{{The rod workbench authors}}}},
  title   = {{Rod workbench: the shape of an elastic rod on a cylinder}},
  version = {{{version}}},
  year    = {{{released}}}
}}

@article{{physical_modeling_2023,
  author  = {{{author} and others}},
  title   = {{{title}}},
  journal = {{{journal}}},
  volume  = {{{volume}}},
  year    = {{{year}}},
  doi     = {{{doi}}}
}}"""
YEAR = "2026"  # of this version
PAPER = {
    "title": "Physical modeling and geometric shape simulation for one-dimensional flexible objects with cylindrical "
    "surface constraints",
    "author": "Y. M.",
    "others": "H. D., Q. J. and W. X.",  # as the paper's list of contributions has them
    "journal": "Scientific Reports",
    "volume": "13",
    "year": "2023",
    "doi": "10.1038/s41598-023-32064-y",
}


def docs(
    address: Annotated[bool, flag("Print the address of the site and open nothing.", "--print")] = False,
    bibtex: Annotated[bool, flag("Print how to cite the workbench and the paper, as BibTeX.", "--bibtex")] = False,
) -> int:
    """Open the documentation site in the browser: tutorials, how-to pages, reference, examples, the live page.

    The site needs no network. A wheel carries it if it was built before the wheel was made; in a checkout it is built
    once, and until then the command names the line that does so.
    """
    if bibtex:
        from .. import __version__

        print(BIBTEX.format(version=__version__, released=YEAR, **PAPER))
        return 0
    import webbrowser

    address_of_site = site().as_uri()
    if address or not webbrowser.open(address_of_site):
        console.say(address_of_site)
    return 0


def site() -> Path:
    """The first page of the site. Raises `InputError` where it was not built, with the command that builds it."""
    for place in PLACES:
        if (place / "index.html").is_file():
            return place / "index.html"
    if not (ROOT / "docs" / "build.py").is_file():
        raise InputError(
            "this installation carries no documentation site: its pages are in the folder docs of the source"
        )
    raise InputError(f"the documentation site is built once, in some minutes; run: {build_command()}")


def build_command() -> str:
    """The line that builds the site of this checkout, whatever the folder it is run from."""
    python = shlex.quote(sys.executable)
    install = f"{python} -m pip install -q -c constraints.txt -c docs/constraints.txt -e '.[docs]'"
    steps = [f"cd {shlex.quote(str(ROOT))}", *([] if find_spec("sphinx") else [install]), f"{python} -m docs.build"]
    return " && ".join(steps)
