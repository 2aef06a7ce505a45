"""A scene as one offline HTML file: the rods of a dataset, turned by hand, with a slider for each axis."""

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

import xarray as xr
from jinja2 import Environment, StrictUndefined

from ...figures import colours
from ...store import selection
from ...words import labels
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
    style, script = look() + read("page.css"), program()
    sliders = len(stored.data["axes"])
    return render(
        "page.html.j2",
        title=str(ds.attrs["title"]),
        lead=". ".join(part for part in (labels.reading(ds), _held(ds, at or {})) if part),
        figure=figure("rod", "The rod on its cylinder", reset=bool(sliders)),
        sliders=sliders,
        left_out=stored.left_out,
        style=style,
        program=script,
        data=data({"rod": stored.data}),
        policy=live_document.policy(style, script, "", served=False),
    )


def figure(name: str, label: str, still: str = "", caption: str = "", reset: bool = True, row: bool = False) -> str:
    """The markup of a turntable; still: what is shown where it cannot turn, and on paper.

    row: whether `still` shows all rods of the turntable, so that it stays above the one that turns.
    """
    return render("figure.html.j2", id=name, label=label, still=still, caption=caption, reset=reset, row=row)


def data(figures: Mapping[str, Any]) -> str:
    """The data of all turntables of a page, and the core, as JSON that may stand inside a script element."""
    plain = {"colours": colours.for_pages(), "figures": dict(figures), "core": live_document.core_text()}
    return live_document.json_text(plain)


@cache
def program() -> str:
    """The script of a page with turntables, and that of the core."""
    return f"{live_document.core_script()}\n{live_document.bundle(FIRST)}"


def look() -> str:
    """The style of turntables: the colours of both schemes, light and dark, and their layout."""
    return read("scheme.css") + live_document.read("shared.css") + read("turntable.css")


@cache
def read(name: str) -> str:
    """The text of a file of this folder."""
    return (files(__package__) / name).read_text(encoding="utf-8")


def render(name: str, **values: Any) -> str:
    """A template of this folder, filled in."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(read(name)).render(**values)


def _held(ds: xr.Dataset, at: Mapping[str, Any]) -> str:
    """The values at which axes are fixed, as text."""
    where = selection.case(ds, at)
    names = [selection.axis_of(ds, name) for name in at]
    return labels.equations(ds, {name: where[name] for name in names})
