"""The variables of a stored study: dimensions, units and attributes, of small studies that are run for this page."""

from pathlib import Path

import xarray as xr

from solver.observe.observables import OBSERVABLES
from studies.language.loader import loads
from studies.language.study import OUTPUTS
from workbench.run import in_memory

HEAD = """
title = "{title}"
units = {{ length = "cm", force = "N" }}
observables = {observables}
outputs = {outputs}
stations = 41
"""
ROD = "E = 1.07e4\nnu = 0.25\na = 0.25\nL = 5.0\nR = 0.75\n"
START = "[base]\n" + ROD.replace("E = 1.07e4\n", "") + "beta = 0.5\ndbeta = 0.5\nF1 = 5.0\nF3 = 10.0\n"
STUDIES = {  # what is described -> the study after its head; each shows only what those before it lack
    "A start problem": START + "[axes.E]\nvalues = [1e4, 2e4]\n",
    "More with axes over ends problems": f"[base]\n{ROD}beta0 = 0.5\nbetaL = 0.5\n[axes.FZ]\nvalues = [-9.0, -8.0]\n",
    "More with held ends": f"[base]\n{ROD}beta0 = 0.5\nM1L = 0.0\n[axes.height]\nvalues = [4.1, 4.0]\n",
    "More with samples": START + "[sample]\nsize = 2\n[sample.E]\nfrom = 1e4\nto = 2e4\n",
    "More with refinement": START
    + '[axes.E]\nvalues = [1e4, 2e4]\n[refine]\nwatch = ["bends"]\ntolerance = 0.5\nbudget = 4\n',
}


def write(folder: Path) -> None:
    """Write the page."""
    lines = ["# Reference: variables of a file", "", "Made from small studies in cm and N that were run for this page."]
    lines += ["[The stored file](file-format.md) says what they mean.", ""]
    seen: set[str] = set()
    for heading, study in STUDIES.items():
        ds = run(heading, study)
        lines += [f"## {heading}", "", f"Dimensions: {', '.join(f'`{n}` ({k})' for n, k in ds.sizes.items())}.", ""]
        lines += table(ds.drop_vars([name for name in map(str, ds.variables) if name in seen]))
        lines += _attributes(ds, [name for name in map(str, ds.attrs) if f"@{name}" not in seen])
        seen |= {*map(str, ds.variables), *(f"@{name}" for name in ds.attrs)}
    (folder / "reference" / "variables.md").write_text("\n".join(lines), encoding="utf-8")


def run(title: str, study: str) -> xr.Dataset:
    """The dataset of a small study; the first has every output and observable."""
    whole = title == next(iter(STUDIES))
    outputs = list(OUTPUTS) if whole else ["beta"]
    observables = list(OBSERVABLES) if whole else ["bends"]
    return in_memory.run(loads(HEAD.format(title=title, outputs=outputs, observables=observables) + study))


def table(ds: xr.Dataset) -> list[str]:
    """A row for each variable of a dataset."""
    lines = ["| variable | dimensions | unit | symbol | meaning |", "|---|---|---|---|---|"]
    for name in map(str, ds.variables):
        array = ds[name]
        unit = "text" if array.dtype.kind in "UOT" else str(array.attrs.get("units", ""))
        said = [str(array.attrs.get(key, "")) for key in ("symbol", "long_name")]
        cells = [f"`{name}`", ", ".join(map(str, array.dims)), unit, *said]
        lines.append("| " + " | ".join(_cell(cell) for cell in cells) + " |")
    return [*lines, ""]


def _attributes(ds: xr.Dataset, names: list[str]) -> list[str]:
    if not names:
        return []
    lines = ["| attribute | here |", "|---|---|"]
    for name in names:
        text = " ".join(str(ds.attrs[name]).split())
        short = text if len(text) < 80 else f"{text[:76]} ..."
        lines.append(f"| `{name}` | {f'`{_cell(short)}`' if short else 'empty'} |")
    return [*lines, ""]


def _cell(text: str) -> str:
    return text.replace("|", r"\|")
