"""A study of every kind, small enough to be solved in no time, and others that differ from it."""

from collections.abc import Sequence
from functools import cache
from typing import Any

import xarray as xr

from studies import Study
from studies.language.loader import loads
from tests.workbench import small
from workbench.run import in_memory

PIPE = {"E": 2.06e8, "inner_radius": 0.0543, "nu": 0.3, "a": 0.0635, "L": 20.0, "R": 0.108, "side": "inside"}
SNAP = {"E": 325.95, "nu": 0.25, "a": 0.25, "R": 0.75, "L": 5.0, "beta0": 0.5, "betaL": 0.5}
SEEN = {"observables": ["amplitude", "height", "index"], "outputs": ["beta"], "stations": 21}
KEYS = {"reading": "force-first/tension/paper", "observables": ["bends", "turns_around"], "outputs": ["beta", "z"]}
TWO_RODS = small.axis("E", [325.95, 651.9])


def table_1(tables: str) -> Study:
    return loads(small.text({}, tables, stations=11, **KEYS), "text", "table")


def pipe_study(axes: str) -> Study:
    """A pipe pushed down its hole."""
    return loads(small.text(PIPE | {"beta0": 0.0, "betaL": 0.0}, axes, "m kN", **SEEN), "text", "pushed")


@cache
def well(
    inclination: float = 120.0,
    friction: float | None = 0.25,
    sliding: str = "axial-forward",
    sizes: Sequence[float] = (60.0, 150.0, 210.0),
) -> xr.Dataset:
    """A pipe that is pushed in a hole, under these weights on bit."""
    loads_of = small.axis("wob", [*sizes])
    hole = {"weight": 0.241, "inclination": f"{inclination}deg", "beta0": 0.0, "betaL": 0.0, "L": 200.0}
    rubbed = {"friction": friction, "sliding": sliding} if friction else {}
    seen = {"observables": ["FZ0", "push_max", "kappa_max", "bending_stress_max", "arriving_max"]}
    return in_memory.run(loads(small.text(PIPE | hole | rubbed, loads_of, "m kN", **seen)))


def snapping(count: int, tables: str = "", follow: bool | None = True) -> Study:
    """A rod that snaps through, followed beyond its fold."""
    axes = small.axis("FZ", (2.0, -3.0, count), follow=follow) + tables
    return loads(small.text(SNAP, axes, **SEEN), "text", "snapping")


def sample_study(size: int, seed: int = 3, more: str = "") -> Study:
    fields = 'E = { from = 5e3, to = 4e4, distribution = "log-uniform" }\nR = { from = 0.5, to = 1.5 }\n'
    return table_1(f"[sample]\nsize = {size}\nseed = {seed}\n{fields}{more}")


PLANE = "[base]\nL = 6.0\n" + small.axis("E", (5e3, 4e4, 5), spacing="geometric") + small.axis("R", (0.5, 1.5, 4))


def refinement_study(points: int = 15, watch: str = "bends", **keys: int) -> Study:
    table = small.lines({"watch": [watch], "points": points, **keys})
    return table_1(f"{PLANE}[refine]\n{table}" + small.law("bends", "E", "falls"))


def between_ends(table: str, **keys: Any) -> Study:
    """Rods between two ends whose cases are each solved by the rule."""
    names = {"observables": ["amplitude", "index"], "outputs": ["beta"], "stations": 21}
    return loads(
        small.text({**small.SHORT, "beta0": 0.5, "betaL": 0.8, "FZ": -8.0, **keys}, table, **names), "text", "ends"
    )


EXPRESSIONS = '[expressions]\nshare = "bends/turns_around"\nroom = "1/(F1 - 5*N)"\n'  # which has no value in the middle
STUDIES = {
    "grid": table_1(EXPRESSIONS + small.axis("E", (5e3, 4e4, 3)) + small.axis("F1", (1.0, 9.0, 13))),
    "samples": sample_study(40),
    "refined": refinement_study(),
    "samples at an axis": sample_study(8, more=small.axis("F1", [3.0, 5.0, 8.0])),
    "samples between ends": between_ends(
        "[zip]\nE = [1e4, 1.1e4, 1.3e4]\nbeta0 = [0.3, 0.4, 0.5]\n", E=None, beta0=None
    ),
    "refined between ends": between_ends(
        small.axis("E", [5e3, 1e4, 2e4]) + '[refine]\nwatch = ["amplitude"]\nsteps = { amplitude = 0.1 }\npoints = 9\n',
        FZ=-10.0,
    ),
    "sweep": pipe_study(small.axis("FZ", (-60.0, -40.0, 11))),
    "sweep by a rule": pipe_study(small.axis("FZ", (-60.0, -40.0, 5)) + "[equilibrium]\nindex = 2\n"),
    "sweep of a grid": pipe_study(small.axis("L", [19.0, 20.0, 21.0]) + small.axis("FZ", (-60.0, -50.0, 9))),
    "followed": snapping(11),
    "followed in blocks": snapping(41),
    "followed lines": snapping(41, TWO_RODS),
}
# The others take long, or are another kind with a difference.
QUICK = ("grid", "samples", "refined", "sweep", "followed")
