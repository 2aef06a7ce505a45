"""The cases of a dataset solved again at as many stations as a picture or a file of them needs."""

from collections.abc import Callable, Collection, Mapping
from functools import partial
from typing import TypeVar

from studies.language.study import MAX_STATIONS

from ..geometry.centreline import TooFewStations
from . import schema
from .stored_study import StoredStudy

ROUNDS = 12  # each finds some six times as many stations where the round before missed the bends
Solve = Callable[[int], StoredStudy]  # the cases at a number of stations
Drawn = TypeVar("Drawn")
SHAPE = ("beta", "dbeta", "alpha", "z", "radius", "gamma", "contact")


def is_whole(stored: StoredStudy) -> bool:
    """Whether a study gives the cases of a dataset, on all axes that it has."""
    return bool(stored.attrs.get("study")) and stored.axes == schema.axes_left(stored.ds, stored.study)


def solver_of(stored: StoredStudy, where: Mapping[str, int], reads: Collection[str]) -> Solve | None:
    """What solves the cases of a dataset at a number of stations; None where no study gives them.

    where: indices along axes, which remain with one value. reads: arrays along the rod that are needed besides those
    that give its shape.
    """
    if not is_whole(stored) or stored.study.refine is not None:
        return None
    part = stored.select({name: [i] for name, i in where.items()})
    off_wall = ["contact"] * (stored.loads_vary or stored.leaves) + ["radius"] * stored.leaves
    needed = {*reads, "dbeta", *off_wall}
    return partial(part.solve, names=[name for name in SHAPE if name in stored or name in needed])


def at_needed_stations(
    stored: StoredStudy, solve: Solve | None, draw: Callable[[StoredStudy, bool], Drawn]
) -> tuple[Drawn, int]:
    """What is drawn of a dataset, or of its cases solved at the stations that it needs, and the number of stations.

    solve: solves the cases at a number of stations; None where they cannot be solved again. draw: takes the dataset,
    and whether it raises `TooFewStations` rather than draw less well than asked. Raises `InputError` as they do.
    """
    for _ in range(ROUNDS):
        stations = stored.sizes["u"]
        try:
            return draw(stored, solve is not None and stations < MAX_STATIONS), stations
        except TooFewStations as error:
            if solve is None or stations >= MAX_STATIONS:
                raise
            stored = solve(min(max(error.stations, stations + 1), MAX_STATIONS))
    return draw(stored, False), stored.sizes["u"]
