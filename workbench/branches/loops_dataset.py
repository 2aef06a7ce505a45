"""The dataset of closed rods, which the figures, scenes and exports of equilibria read."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver.loops import Loop
from solver.problem.errors import InputError
from studies import Study
from studies.language.case_input import field_values
from studies.language.loader import loads
from studies.language.readings import TABLE_UNITS

from ..store import dataset, schema, writing
from ..words import cautions
from .ends_study import study_text
from .equilibria_dataset import EQUILIBRIUM, attributes, of_solutions

NUMBERS = {  # of each loop: units and long names of those that are no quantity of a case
    "wraps": "wraps",
    "folds": ("1", "folds", "periods of beta along the closed rod"),
    "about": ("rad", "about", "angle about which beta oscillates"),
    "lam": ("1", "λ", "axial moment, MZ rho/A"),
    "energy": "bending_energy",
    "index": "index",
    "push_min": "push_min",
    "push_max": "push_max",
    "attached": "attached",
}
LABELS = ("units", "symbol", "long_name")
STABILITY = "closed rods, the section free to turn, all on the surface"


def study_of(one: Loop, units: Mapping[str, str] | None = None) -> Study:
    """A study whose one case is the start problem of a loop; units: default: cm and N."""
    title = f"A closed rod of {one.wraps} wrap{'s' * (one.wraps > 1)} and {one.folds} fold{'s' * (one.folds > 1)}"
    text = study_text(title, {**TABLE_UNITS, **dict(units or {})}, field_values(one.solution.case))
    return loads(text, "loops")


def dataset_of(found: Sequence[Loop], units: Mapping[str, str] | None = None) -> xr.Dataset:
    """Closed rods of one rod and cylinder as a dataset over `equilibrium`, in the order given.

    Returns
    -------
    The arrays of `ALONG` over (equilibrium, u), u = s/L, `NUMBERS`, MZ, outcome and caution over (equilibrium), and
    the numbers of the rod and the cylinder.

    Raises
    ------
    InputError
        For no loop, and for an unknown unit.
    """
    if not found:
        raise InputError("no loop was found: a dataset holds at least one")
    study, case = study_of(found[0], units), found[0].solution.case
    words = study.unit_system
    solutions = [loop.solution for loop in found]
    data: dict[str, Any] = {}
    for name, row in NUMBERS.items():
        labels = schema.labels(row, words) if isinstance(row, str) else dict(zip(LABELS, row, strict=True))
        data[name] = xr.Variable(EQUILIBRIUM, np.array([getattr(loop, name) for loop in found]), labels)
    data |= dataset.variables({"MZ": [float(sol.MZ) for sol in solutions]}, EQUILIBRIUM, words)
    data |= dataset.variables({"FZ": 0.0, "M3": 0.0}, (), words)
    scalars = {**dict(case.rod.given()), "R": case.cylinder.R, "rho": case.rho}
    data |= dataset.variables({name: float(value) for name, value in scalars.items()}, (), words)
    ds = of_solutions(solutions, data, [caution(loop) for loop in found], float(case.rod.L), words)
    ds["equilibrium"].attrs["long_name"] = "number of the loop"
    more = {"title": "Closed rods on a cylinder", "stability": STABILITY}
    return ds.assign_attrs(attributes(study, case, "") | more | {"caution": cautions.sentence(ds)})


def write_cases(found: Sequence[Loop], units: Mapping[str, str], folder: Path) -> None:
    """Write each loop as a TOML study of one case. Raises `InputError` if the folder cannot be written."""
    writing.check_folder(folder)
    for k, loop in enumerate(found, 1):
        (folder / f"loop_{k:0{len(str(len(found)))}d}.toml").write_text(study_of(loop, units).text, encoding="utf-8")


def caution(one: Loop) -> str:
    """The keys of `cautions` of a closed rod, whose ends are neighbours and not in self-contact."""
    met = np.nan if one.overlaps is None else float(one.overlaps)
    return str(cautions.of_cases(one.solution, {"overlaps": np.array(met)}))
