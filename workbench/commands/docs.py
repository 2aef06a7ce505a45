"""The command docs: open the documentation site."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from . import console
from .options import flag

ROOT = Path(__file__).resolve().parents[2]
# Where a site may lie: in a wheel that was made after the site was built, and in a checkout.
PLACES = (ROOT / "workbench" / "web" / "docs", ROOT / "build" / "docs" / "html")


def docs(
    address: Annotated[bool, flag("Print the address of the site and open nothing.", "--print")] = False,
) -> int:
    """Open the documentation site in the browser: tutorials, how-to pages, reference, examples, the live page.

    The site needs no network. A wheel carries it if it was built before the wheel was made.
    """
    import webbrowser

    found = site(PLACES).as_uri()
    if address or not webbrowser.open(found):
        console.say(found)
    return 0


def site(places: Sequence[Path]) -> Path:
    """The first page of the site. Raises `InputError` where it was not built."""
    from solver import InputError

    for place in places:
        if (place / "index.html").is_file():
            return place / "index.html"
    raise InputError(
        "this copy of the workbench carries no documentation site; in a checkout, pip install -e '.[docs]' and "
        "python -m docs.build make it, or read the pages in docs"
    )
