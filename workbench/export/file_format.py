"""What an export is made of: the rod, the options, and what a format declares of itself."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from solver.problem.errors import InputError, check_known, choices
from solver.problem.units import LENGTHS

from ..figures.colours import PULLED, PUSHED, linear
from ..geometry.centreline import Array, Centreline
from ..stored.stored_study import StoredStudy


def metres(unit: str) -> float:
    """A unit of length in metres. Raises `InputError` for one that is not known."""
    if unit == "length":  # of a solution whose units Python was not told
        raise InputError(f"a file of this format states its unit of length: give length=, one of {choices(LENGTHS)}")
    check_known("unit of length", unit, LENGTHS)
    return LENGTHS[unit]


@dataclass(frozen=True)
class ExportOptions:
    """What a user chooses.

    Attributes
    ----------
    at
        Values of axes, as stored.
    tolerance
        The greatest distance of the file from the rod [length]; default: that of the format.
    centreline
        STEP without the solid.
    overlap
        The solid also of a rod that passes through itself.
    triangles
        The most triangles of a mesh; default: as many as the tolerance takes.
    color
        Of the rod, ``#rrggbb``, in place of the two colours of a push and of lift-off.
    """

    at: Mapping[str, float] = field(default_factory=dict)
    tolerance: float | None = None
    centreline: bool = False
    overlap: bool = False
    triangles: int | None = None
    color: str | None = None


@dataclass(frozen=True, eq=False)
class ExportedRod:
    """The rod of one case, by its indices along the axes; tolerance: the one to keep [length], 0 for tables."""

    stored: StoredStudy
    where: dict[str, int]
    line: Centreline
    title: str
    options: ExportOptions
    tolerance: float = 0.0

    @property
    def unit(self) -> str:
        """The unit of length of the dataset."""
        return self.stored.units["length"]

    def shades(self, push: Array) -> Array:
        """The colour at each push, (n, 3), as the light it stands for: the chosen one, else that of the sign."""
        if self.options.color is not None:
            return np.tile(linear(self.options.color), (push.size, 1))
        return np.where(push[:, None] < 0, linear(PULLED), linear(PUSHED))


@dataclass(frozen=True)
class Format:
    """A file format.

    Attributes
    ----------
    write
        Writes a rod to a path, and returns numbers about the file by name.
    series
        Whether `write` takes the rods along one axis, a `pvd.Series`, in place of a rod.
    body
        What the file holds. Of a rod that passes through itself a solid is refused, of a surface a warning is given; a
        curve is not tested.
    tolerance
        The default tolerance of a rod [length]; None: the stations are written as they are.
    curve_share
        The share of the tolerance that the curve between stations may miss.
    cubic
        Whether the file holds the cubics between the stations, `Centreline.cubic`, in place of that curve.
    unit
        The unit of length in the file; default: the dataset's.
    has_centreline
        Whether it can hold the centreline alone.
    coloured
        Whether it shows the push, for which the stations must be enough too.
    triangle_bytes
        By suffix, about how many bytes a triangle takes in a file of a mesh; default: no mesh.
    """

    write: Callable[[Path, Any], dict[str, Any]]
    body: Literal["solid", "surface", "curve"] = "curve"
    tolerance: Callable[[Centreline], float] | None = None
    curve_share: float = 0.1
    cubic: bool = False
    unit: str = ""
    has_centreline: bool = False
    coloured: bool = False
    triangle_bytes: Mapping[str, int] = field(default_factory=dict)
    series: bool = False
