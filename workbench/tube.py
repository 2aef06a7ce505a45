"""The rod of one stored case as a smooth curve on its cylinder, and the tube about it. NumPy and SciPy only."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from solver import frames
from solver.errors import InputError
from studies.model import MAX_STATIONS

from . import dataset

Array = NDArray[np.float64]

TURN = 0.08  # rad between rings at most, so that the tube looks smooth
STEP = 0.5  # radii of the rod between rings at most, so that the colours change where the push does
MOST_RINGS = 30_000  # some 50 MB of mesh; a longer rod is shown in part
TALLEST = 30.0  # diameters of the cylinder; beyond, the rod would be a hair
COARSE = 0.1  # of its length may a stretch between stations be off; beyond, the stations missed a bend


@dataclass(frozen=True, eq=False)
class Curve:
    """A rod's centreline on the cylinder, at rings close enough to look smooth.

    s, alpha, beta, z, push: (n,); push is the cylinder's push per length, positive where it pushes and
    negative where it would have to pull, NaN where that was not stored. shown: the length drawn, from the
    start, at most L.
    """

    s: Array
    alpha: Array
    beta: Array
    z: Array
    push: Array
    R: float
    a: float
    rho: float
    L: float
    side: str
    overlaps: bool = False  # whether it is known to pass through itself

    @property
    def shown(self) -> float:
        return float(self.s[-1])

    @property
    def whole(self) -> bool:
        """Whether all of the rod is drawn."""
        return self.shown >= self.L * (1 - 1e-9)

    @property
    def lifts(self) -> bool:
        """Whether the cylinder would have to pull somewhere."""
        return bool((self.push < 0).any())

    @property
    def reach(self) -> float:
        """The largest distance from the axis of the rod and the cylinder."""
        return max(self.R, self.rho + self.a)


def read(ds: xr.Dataset, where: Mapping[str, int]) -> Curve | None:
    """The curve of one case, by its indices along the axes; None where the case is not solved.

    Raises `InputError` where the dataset does not hold what is drawn, or its stations are too coarse for it.
    """
    for name in ("alpha", "z", "R", "a", "rho", "L"):
        if name not in ds and f"{name}_along" not in ds:
            raise InputError(f"the dataset stores no {name}, which a scene needs: add it to the study's outputs")
    one = ds.isel(dict(where))
    alpha, z = (np.asarray(dataset.along(one, name).values, dtype=float) for name in ("alpha", "z"))
    s = np.asarray(one["s"].values, dtype=float)
    if not str(one["outcome"].values).startswith("solved") or not np.isfinite([alpha, z]).all():
        return None
    R, a, rho, L = (float(one[name].values) for name in ("R", "a", "rho", "L"))
    azimuth, height = _through(one, s, alpha, z, rho)
    rings = _rings(s, azimuth, height, rho, a)
    around, up = rho * azimuth(rings, 1), height(rings, 1)
    stored = dataset.along(one, "contact").values if _has(one, "contact") else np.full(s.shape, np.nan)
    sign = -1.0 if ds.attrs["side"] == "inside" else 1.0
    push = sign * np.interp(rings, s, stored)
    overlaps = "overlaps" in str(one["caution"].values) if "caution" in one else False
    side = str(ds.attrs["side"])
    return Curve(rings, azimuth(rings), np.arctan2(around, up), height(rings), push, R, a, rho, L, side, overlaps)


def mesh(curve: Curve, sides: int = 24) -> tuple[Array, Array, NDArray[np.int64], NDArray[np.bool_]]:
    """The tube of radius a about the curve, closed at both ends.

    Returns points (m, 3), their normals (m, 3), triangles (k, 3) as indices of points, and for each triangle
    whether the cylinder pushes there (k,).
    """
    centre = frames.position(curve.rho, curve.alpha, curve.z)
    out, across = frames.outward(curve.alpha), frames.binormal(curve.alpha, curve.beta)
    angle = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)[:, None]
    normals = np.cos(angle) * out[:, None] + np.sin(angle) * across[:, None]
    points = centre[:, None] + curve.a * normals
    along = frames.tangent(curve.alpha, curve.beta)
    # the flat ends have points of their own, so that their edges stay sharp
    ends = [np.concatenate([points[i], centre[i][None]]) for i in (0, -1)]
    flat = [np.broadcast_to(way * along[i], (sides + 1, 3)) for i, way in ((0, -1.0), (-1, 1.0))]
    n = curve.s.size
    index = np.arange(n * sides).reshape(n, sides)
    beside = np.roll(index, -1, axis=1)
    one = np.stack([index[:-1], beside[1:], beside[:-1]], axis=-1)
    two = np.stack([index[:-1], index[1:], beside[1:]], axis=-1)
    rim = np.arange(sides)
    fan = np.stack([rim, np.roll(rim, -1), np.full(sides, sides)], axis=-1)
    triangles = [np.stack([one, two], axis=2).reshape(-1, 3), n * sides + fan, n * sides + sides + 1 + fan[:, ::-1]]
    held = np.repeat(~(curve.push[:-1] + curve.push[1:] < 0), 2 * sides)  # not stored counts as held
    return (
        np.concatenate([points.reshape(-1, 3), *ends]),
        np.concatenate([normals.reshape(-1, 3), *flat]),
        np.concatenate(triangles),
        np.concatenate([held, np.repeat(held[[0, -1]], sides)]),
    )


def _has(ds: xr.Dataset, name: str) -> bool:
    return f"{name}_along" in ds or name in ds.data_vars


def _through(one: xr.Dataset, s: Array, alpha: Array, z: Array, rho: float) -> tuple[Any, Any]:
    """alpha(s) and z(s) between the stations, with the tangents known where beta is stored.

    Raises `InputError` where the stations are too coarse: the rod is not stretched, so a curve between two
    stations that is not as long as the arc has missed a bend.
    """
    if _has(one, "beta"):
        beta = np.asarray(dataset.along(one, "beta").values, dtype=float)
        slopes = np.sin(beta) / rho, np.cos(beta)
    else:
        slopes = np.gradient(alpha, s, edge_order=2), np.gradient(z, s, edge_order=2)
    azimuth, height = CubicHermiteSpline(s, alpha, slopes[0]), CubicHermiteSpline(s, z, slopes[1])
    middle = (s[1:] + s[:-1]) / 2
    speed = np.hypot(rho * azimuth(middle, 1), height(middle, 1))
    if np.abs(speed - 1).max() > COARSE:
        raise InputError(
            f"{s.size} stations are too few to draw this rod of length {s[-1]:.4g}, which bends between them: store "
            f"{_needed(one, s)} with workbench run --stations, or with the study's key stations"
        )
    return azimuth, height


def _needed(one: xr.Dataset, s: Array) -> str:
    """So many stations that the rod turns by a radian at most from one to the next, if its curvature is stored."""
    if "kappa_max" not in one or not np.isfinite(one["kappa_max"]):
        return f"several times {s.size}"
    needed = int(np.ceil(float(s[-1] - s[0]) * float(one["kappa_max"]))) + 1
    most = f" (a study stores at most {MAX_STATIONS})" if needed > MAX_STATIONS else ""
    return f"{max(needed, 2 * s.size)}{most}"


def _rings(s: Array, azimuth: Any, height: Any, rho: float, a: float) -> Array:
    """Where the rings go: as near as the tightest bend and the radius ask, no more than can be held."""
    curvature = np.hypot(np.gradient(np.unwrap(np.arctan2(rho * azimuth(s, 1), height(s, 1))), s), azimuth(s, 1))
    step = min(TURN / max(float(curvature.max()), 1e-300), STEP * a)
    length = float(s[-1] - s[0])
    tall = np.abs(height(s) - height(s[0])) > TALLEST * 2 * (rho + a)
    if tall.any():
        length = float(s[int(tall.argmax())] - s[0])
    length = min(length, step * MOST_RINGS)
    return np.linspace(s[0], s[0] + length, max(int(np.ceil(length / step)), 2) + 1)
