"""The regions into which fold curves divide a rectangle of two fields, and the equilibria in each."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .equilibria import Equilibria, equilibria
from .folds.fold_curves import FoldCurves, fold_curves
from .folds.plane_regions import regions_of
from .numerics.arrays import Array, Integers
from .problem.case import Case
from .problem.errors import InputError

PIXELS = 240  # of the raster along each field
MOST_POINTS = 100_000


@dataclass(frozen=True, eq=False)
class Region:
    """A region of equal numbers; `region_map` makes it.

    Attributes
    ----------
    values : array (2,)
        The point of the raster that is farthest from its border.
    area : float
        Its share of the rectangle.
    equilibria : Equilibria
        All equilibria there, lowest energy first.
    """

    values: Array
    area: float
    equilibria: Equilibria

    @property
    def count(self) -> int:
        return len(self.equilibria)

    @property
    def stable(self) -> int:
        return sum(one.index == 0 for one in self.equilibria)


@dataclass(frozen=True, eq=False)
class RegionMap:
    """Fold curves with the regions between them; `region_map` makes it.

    Attributes
    ----------
    folds : FoldCurves
    regions : list of Region
        The largest first.
    labels : array (n, n)
        The number of the region at each point of the raster, the second field along rows; -1: in no region, as the
        piece of the rectangle is smaller than a few points of the raster.
    ticks : array (2, n)
        The values of the two fields along the raster.
    remark : str
        That of the fold curves, and regions whose equilibria do not agree with the curves.
    """

    folds: FoldCurves
    regions: list[Region]
    labels: Integers
    ticks: Array
    remark: str

    def checked(self, points: int = 200, seed: int = 0) -> list[str]:
        """A sentence for each of some random points at which `equilibria` does not find the numbers of the map.

        Raises `InputError` for a number of points that is not from 1 to 100000.
        """
        if not 1 <= points <= MOST_POINTS:
            raise InputError(f"points must be from 1 to {MOST_POINTS}, got {points}")
        folds, wrong = self.folds, []
        for values in np.random.default_rng(seed).uniform(folds.low, folds.high, (points, 2)):
            found = equilibria(folds.case_at(values), stations=2)
            expected = folds.indices_at(values)
            counts = len(found), sum(one.index == 0 for one in found)
            wanted = sum(expected.values()), expected[0]
            if counts != wanted:
                where = ", ".join(f"{name} = {value:.6g}" for name, value in zip(folds.names, values, strict=True))
                wrong.append(f"at {where}: {counts[0]} equilibria, {counts[1]} stable; the map has {wanted}")
        return wrong


def region_map(case: Case, *, lattice: int = 9, stations: int = 101, **ranges: Any) -> RegionMap:
    """The number of equilibria, and of stable ones, over two fields under dead loads.

    Parameters
    ----------
    case, lattice, **ranges
        As of `fold_curves`.
    stations : int
        Number of stations of the solutions in each region.

    Returns
    -------
    RegionMap

    Raises
    ------
    InputError
        As `fold_curves`.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, region_map
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=3.0)
    >>> case = Case(rod, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8))
    >>> found = region_map(case, FZ=(-60, -20), L=(1.5, 3), lattice=3)
    >>> [(one.count, one.stable) for one in found.regions]
    [(1, 1), (3, 2)]
    """
    folds = fold_curves(case, lattice=lattice, **ranges)
    labels, inner = regions_of(folds.searched.pieces, PIXELS)
    ticks = folds.low[:, None] + (folds.high - folds.low)[:, None] * ((np.arange(PIXELS) + 0.5) / PIXELS)
    regions, wrong = [], 0
    for number, (row, column) in enumerate(inner):
        values = np.array([ticks[0, column], ticks[1, row]])
        found = equilibria(folds.case_at(values), stations=stations)
        regions.append(Region(values, float(np.mean(labels == number)), found))
        expected = folds.indices_at(values)
        wrong += (len(found), regions[-1].stable) != (sum(expected.values()), expected[0])
    remarks = [folds.remark, f"in {wrong} of {len(regions)} regions the equilibria do not fit the curves"]
    return RegionMap(folds, regions, labels, ticks, "; ".join(filter(None, remarks if wrong else remarks[:1])))
