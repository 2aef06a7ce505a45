"""The live page as one HTML text: its markup, style, program, the compiled core and the data that it begins with.

The text loads nothing from any address. With a server it asks the server for what the page cannot compute; without one
it is a file that works offline.
"""

import base64
import gzip
import re
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from solver.core import build
from solver.observe import observables
from solver.problem.errors import InputError
from solver.problem.quantities import QUANTITIES
from studies import tenants

from ...figures import colours
from ...words import labels
from .. import pages
from . import page_model
from .presets import Preset

PAGE = Path(__file__).parent / "page"
FIRST = "page"
_IMPORT = re.compile(r'^import (\{.*\}) from "\./(\w+)\.mjs";$', re.M)
_EXPORT = re.compile(r"^export ((?:async )?(?:const|function|class) (\w+))", re.M)


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
    readings = {}
    if tenants.is_there("studies.paper"):
        readings = tenants.module_of("studies.paper.readings").READINGS
    return {
        "served": served,
        "presets": [asdict(preset) | ({} if served else _begin(preset)) for preset in presets],
        "readings": {name: [" · ".join(reading.symbols), reading.words] for name, reading in readings.items()},
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
    study = page_model.study_of(preset.state)
    if study.leaves or study.case().varies:
        raise InputError(
            "a page without a server shows rods without weight and friction, on a cylinder that holds them on: "
            "use workbench explore"
        )
    sol = page_model.shape(study).sol
    if sol.problem.kind != "ends":
        return {}
    return {"shape": page_model.round_rows({"s": sol.s, "beta": sol.beta, "dbeta": sol.dbeta}, 9)}
