"""A scene of a study that is not stored: its cases are solved at as many stations as the picture needs.

The rods are solved at a few stations, and the camera is set up; where its pixels need more stations, the rods are
solved again at as many. The result is a dataset like any other, and is drawn like any other.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from solver.problem.errors import InputError
from studies import Study, load
from studies.axes import Axis
from studies.dimensions import SAMPLE
from studies.model import MAX_STATIONS, OUTPUTS

from ..data import schema, selection
from ..run import in_memory
from ..run.plan import plan
from ..scene.kinds import Kind

if TYPE_CHECKING:  # it draws, for which OpenGL must have been asked for
    from ..scene.composition import Picture

FIRST = 21  # stations that are tried first
ROUNDS = 12  # each finds some six times as many stations where the round before missed the bends
MOST_CASES = 10_000


def is_study(file: Path) -> bool:
    """Whether the path means a study, by its name or its TOML file, and not a stored dataset."""
    return file.suffix == ".toml" or not (file.exists() or file.is_symlink() or file.suffix)


def two_stations(file: Path) -> tuple[Study, xr.Dataset]:
    """The study, and its dataset at two stations a case, from which the cases that are drawn are chosen.

    Raises `InputError`, also for more cases than are solved for one picture.
    """
    study = load(file).coarse()
    if study.size > MOST_CASES:
        raise InputError(
            f"{study.name} has {study.size} cases, and at most {MOST_CASES} are solved for a picture: store it with "
            "workbench run, and draw the file"
        )
    ds = in_memory.run(_with_outputs(study, ()).at_stations(2))
    return study, ds.assign_attrs(laws=schema.laws_text(study))  # they fix where an axis is held


def needed_cases(study: Study, ds: xr.Dataset, kind: Kind, at: dict[str, float], shown: Sequence[str]) -> Study:
    """The study with the cases that a scene shows and the outputs that its kind reads.

    ds: as of `two_stations`. shown: the axes of which all cases are shown.
    """
    lean = _with_outputs(study, kind.reads | {"dbeta"})
    if study.follow is not None:
        return lean
    where = selection.case(ds, at)
    axes = {}
    for name, axis in study.axes.items():
        dim = schema.dimension(name)
        held = {} if {name, dim} & {*shown} else {"values": [float(ds[dim].values[where[dim]])]}
        axes[name] = Axis.model_validate(held) if held else axis
    part = lean.model_copy(update={"axes": axes})
    if study.sampled and SAMPLE not in shown:
        part = part.with_sample(where[SAMPLE])
    return part.part_of(plan(study).spine) if study.sweeps else part


def at_needed_stations(study: Study, draw: Callable[[xr.Dataset, bool], "Picture"]) -> tuple["Picture", int]:
    """The picture of the study's dataset at the stations that it needs, and their number.

    draw: takes the dataset, and whether it raises `composition.TooFewStations` rather than draw less well than asked.
    """
    from ..scene.composition import TooFewStations

    stations = FIRST
    for _ in range(ROUNDS):
        try:
            return draw(in_memory.run(study.at_stations(stations)), stations < MAX_STATIONS), stations
        except TooFewStations as error:
            stations = min(max(error.stations, stations + 1), MAX_STATIONS)
    return draw(in_memory.run(study.at_stations(MAX_STATIONS)), False), MAX_STATIONS


def _with_outputs(study: Study, outputs: Any) -> Study:
    return study.model_copy(
        update={"outputs": [name for name in OUTPUTS if name in outputs], "observables": [], "laws": []}
    )
