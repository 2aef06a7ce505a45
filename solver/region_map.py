"""The regions into which fold curves divide a rectangle of two fields, and the equilibria in each."""

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from .branches.fold_curves import FoldCurves, curves_of
from .branches.fold_lattice import search_curves
from .branches.parameter_plane import parameter_plane
from .branches.whole_curve import CurvePieces
from .equilibria import MOST_LISTED, Equilibria, equilibria
from .numerics.arrays import Array, Booleans, Integers
from .problem.case import Case, check_case
from .problem.dimensionless import fields_held
from .problem.errors import LARGEST_SEED, whole_number
from .trace_fold import search_from_middle

PIXELS = 240  # of the raster along each field. x10: a hundred times the memory


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
        return sum(equilibrium.index == 0 for equilibrium in self.equilibria)


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

    def check(self, points: int = 200, seed: int = 0) -> list[str]:
        """A sentence for each of some random points at which `equilibria` does not find the numbers of the map.

        Raises `InputError` unless points is a whole number from 1 to 100000 and seed one from 0 on.
        """
        points, seed = whole_number("points", points, 1, 100_000), whole_number("seed", seed, 0, LARGEST_SEED)
        folds, wrong = self.folds, []
        for values in np.random.default_rng(seed).uniform(folds.low, folds.high, (points, 2)):
            listed = equilibria(folds.case_at(values), stations=2, within=folds.within)
            expected = folds.indices_at(values)
            counts = len(listed), sum(equilibrium.index == 0 for equilibrium in listed)
            of_map = sum(expected.values()), expected[0]
            if counts != of_map:
                where = ", ".join(f"{name} = {value:.6g}" for name, value in zip(folds.names, values, strict=True))
                wrong.append(f"at {where}: {counts[0]} equilibria, {counts[1]} stable; the map has {of_map}")
        return wrong


def points_of_lattice(case: Case) -> int:
    """The points of the lattice along each field, by default."""
    return 3 if case.varies or fields_held(case) else 9


def fold_curves(case: Case, *, lattice: int | None = None, **ranges: Any) -> FoldCurves:
    """Fold and pitchfork curves that cross a rectangle of two fields: all under dead loads, else those that are found.

    Under dead loads, on a lattice of points all equilibria are counted by their Morse index. Between two neighbours
    whose numbers differ a point of a curve is found, and the curve is traced from it both ways, until the curves
    explain every difference. A closed curve that lies between the lines of the lattice is not found, nor are two curves
    that cross the same lines next to each other and undo each other's change, unless one of thirty further points lies
    between; a finer lattice finds them.

    Of a rod with held ends or weight the equilibria that `equilibria` finds at the middle are followed along the lines
    of the lattice, with those that branches meet, and every fold on the way is traced; with weight also pitchforks, and
    what splits off there. What does not hang together with them is not found, and the remark is never empty.

    Parameters
    ----------
    case : Case
        A single ends problem.
    lattice : int, optional
        Points of the lattice along each field, 2 to 101. Default: 9, of a rod with held ends or weight 3.
    **ranges
        Two numeric fields of rod, cylinder or ends with their ranges, such as ``FZ=(-10, 10)`` and ``betaL=("-90deg",
        "90deg")``.

    Returns
    -------
    FoldCurves

    Raises
    ------
    InputError
        For a start problem, a grid of cases, an unknown field, a range that is not two finite numbers, the first lower,
        values in it that no case has, and friction.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, fold_curves
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=3.0)
    >>> case = Case(rod, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8))
    >>> (curve,) = fold_curves(case, FZ=(-60, -20), L=(1.5, 3), lattice=3).curves
    >>> curve.kind, curve.lower, curve.cusps.round(6).tolist()
    ('fold', 0, [[-55.891532, 2.293935]])
    """
    plane = parameter_plane(check_case("fold_curves", case), ranges)
    lattice = points_of_lattice(case) if lattice is None else lattice
    lattice = whole_number("lattice", lattice, 2, 101)
    if plane.varies or fields_held(case):
        return search_from_middle(plane, lattice)
    return curves_of(search_curves(plane, lattice))


def region_map(case: Case, *, lattice: int | None = None, stations: int = 101, **ranges: Any) -> RegionMap:
    """The number of equilibria, and of stable ones, over two fields; with held ends or weight of those that are found.

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
    check_case("region_map", case)
    stations = whole_number("stations", stations, 2, MOST_LISTED)
    folds = fold_curves(case, lattice=lattice, **ranges)
    labels, inner = regions_of(folds.searched.pieces, PIXELS)
    ticks = folds.low[:, None] + (folds.high - folds.low)[:, None] * ((np.arange(PIXELS) + 0.5) / PIXELS)
    regions, more, fewer = [], 0, 0
    for number, (row, column) in enumerate(inner):
        values = np.array([ticks[0, column], ticks[1, row]])
        listed = equilibria(folds.case_at(values), stations=stations, within=folds.within)
        regions.append(Region(values, float(np.mean(labels == number)), listed))
        expected, counts = folds.indices_at(values), Counter(equilibrium.index for equilibrium in listed)
        more, fewer = more + bool(counts - expected), fewer + bool(expected - counts and not counts - expected)
    many = len(regions)
    beyond = ", which may lie beyond these reactions" if folds.within else ""
    said = [
        folds.remark,
        f"in {more} of {many} regions the search finds equilibria that the curves do not tell of" if more else "",
        f"in {fewer} of {many} regions the search does not find all that the curves tell of{beyond}" if fewer else "",
    ]
    return RegionMap(folds, regions, labels, ticks, "; ".join(filter(None, said)))


# points of the raster of a region; fewer are where curves cross within a pixel. x10: thin regions are not named
_LEAST = 6


def regions_of(pieces: CurvePieces, n: int) -> tuple[Integers, list[tuple[int, int]]]:
    """The number of the region of each point of the raster (n, n), the largest region 0, and -1 in pieces of the
    square that are too small; and row and column of the point of each region that is farthest from its border."""
    import scipy.ndimage
    import scipy.sparse

    across, up = _cut(pieces, n, 0), _cut(pieces, n, 1)
    number = np.arange(n * n).reshape(n, n)
    right, above = ~across[:, : n - 1], ~up.T[: n - 1]
    first = np.concatenate([number[:, :-1][right], number[:-1][above]])
    second = np.concatenate([number[:, 1:][right], number[1:][above]])
    graph = scipy.sparse.coo_array((np.ones(first.size, dtype=np.int8), (first, second)), shape=(n * n, n * n))
    total, parts = scipy.sparse.csgraph.connected_components(graph, directed=False)
    size = np.bincount(parts, minlength=total)
    order = np.argsort(-size, kind="stable")
    rank = np.full(total, -1, dtype=np.int64)
    large = order[size[order] >= _LEAST]
    rank[large] = np.arange(large.size)
    labels = rank[parts].reshape(n, n)
    inner = []
    for region in range(large.size):
        away = scipy.ndimage.distance_transform_edt(np.pad(labels == region, 1))[1:-1, 1:-1]
        row, column = np.unravel_index(int(np.argmax(away)), away.shape)
        inner.append((int(row), int(column)))
    return labels, inner


def _cut(pieces: CurvePieces, n: int, axis: int) -> Booleans:
    """Whether a curve passes between two neighbouring points of the raster along an axis: of each line of points (n),
    and each gap (n, the last of which is beyond the border)."""
    cut = np.zeros((n, n), dtype=bool)
    first, last = pieces.first * n - 0.5, pieces.last * n - 0.5
    a, b = first[:, 1 - axis], last[:, 1 - axis]
    low, high = np.ceil(np.minimum(a, b)).astype(int), np.ceil(np.maximum(a, b)).astype(int)
    count = high - low
    piece = np.repeat(np.arange(count.size), count)
    line = np.repeat(low, count) + np.arange(piece.size) - np.repeat(np.cumsum(count) - count, count)
    share = (line - a[piece]) / (b[piece] - a[piece])
    place = first[piece, axis] + share * (last[piece, axis] - first[piece, axis])
    gap = np.floor(place).astype(int)
    inside = (line >= 0) & (line < n) & (gap >= 0) & (gap < n - 1)
    cut[line[inside], gap[inside]] = True
    return cut
