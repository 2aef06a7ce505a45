"""A scene as one offline HTML file: the rods of a dataset, turned by hand, with a slider for each axis."""

from collections.abc import Mapping
from functools import cache
from typing import Any

import xarray as xr

from ...figures import colours
from ...store import selection
from ...words import labels
from .. import pages
from ..live import live_document
from .stored import turntable_of_dataset

FIRST = "turntables"  # the module of the page with which the program begins


def html(ds: xr.Dataset, at: Mapping[str, Any] | None = None) -> str:
    """The file as text. It loads nothing from any address.

    Parameters
    ----------
    ds
        A stored study, or stored equilibria.
    at
        Values of axes, by name: these axes have no slider.

    Raises
    ------
    InputError
        As of `stored`.
    """
    stored = turntable_of_dataset(ds, at)
    style = look() + read("page.css")
    sliders = len(stored.data["axes"])
    return pages.page(
        read("page.html.j2"), style, {"program": program()}, data({"rod": stored.data}),
        title=str(ds.attrs["title"]),
        lead=". ".join(part for part in (labels.reading(ds), _held(ds, at or {})) if part),
        figure=figure("rod", "The rod on its cylinder", reset=bool(sliders)),
        sliders=sliders,
        left_out=stored.left_out,
    )  # fmt: skip


def figure(name: str, label: str, still: str = "", caption: str = "", reset: bool = True, row: bool = False) -> str:
    """The markup of a turntable; still: what is shown where it cannot turn, and on paper.

    row: whether `still` shows all rods of the turntable, so that it stays above the one that turns.
    """
    return pages.fill(read("figure.html.j2"), id=name, label=label, still=still, caption=caption, reset=reset, row=row)


def data(figures: Mapping[str, Any]) -> dict[str, Any]:
    """The data of all turntables of a page, and the core."""
    return {"colours": colours.for_pages(), "figures": dict(figures), "core": live_document.core_text()}


@cache
def program() -> str:
    """The script of a page with turntables, and that of the core."""
    return f"{live_document.core_script()}\n{live_document.bundle(FIRST)}"


def look() -> str:
    """The style of turntables: the colours of both schemes, light and dark, and their layout."""
    return read("scheme.css") + live_document.read("shared.css") + read("turntable.css")


def read(name: str) -> str:
    """The text of a file of this folder."""
    return pages.read(__package__, name)


def _held(ds: xr.Dataset, at: Mapping[str, Any]) -> str:
    """The values at which axes are fixed, as text."""
    where = selection.case(ds, at)
    names = [selection.axis_of(ds, name) for name in at]
    return labels.equations(ds, {name: where[name] for name in names})
