"""Closed rods on the cylinder: loops that close in position and direction without axial force and twist."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .observe.observables import observe
from .orbits.loop_orbits import ClosedOrbit, index_of, meets_itself, orbits_of_gain
from .problem.case import Case, Cylinder, Rod, Start, refuse_leaving
from .problem.dimensionless import reduce
from .problem.errors import InputError, check_type, whole_number
from .problem.limits import OUT_OF_RANGE, reason_beyond, units_held
from .problem.quantities import current, former
from .problem.shown import NOTEBOOK, make
from .solution import Solution
from .solve import solve

TOL = 1e-11  # of a closed rod: as small as its solution allows. x10: it closes to a digit less
# units in the last place by which the forces at the start are moved, until the rod closes best. x10: only time
_ULPS = 8


@dataclass(frozen=True, eq=False)
class Loop:
    """One closed rod; `loops` makes it.

    Attributes
    ----------
    solution : Solution
        Its shape, as the solution of a start problem with the loads found. It starts where beta is farthest from
        `about`.
    turns_around, folds : int
        Turns around the axis, and periods of beta.
    about : float
        The angle about which beta oscillates [rad]: pi/2, or -pi/2 for a loop that turns back at each hairpin.
    lam : float
        MZ rho/A, the axial moment that the closed rod carries, dimensionless.
    energy : float
        Bending energy [force length]; there is no twist.
    index : int
        Morse index of the closed rod on the surface, its length held and its section free to turn; 0: stable.
    push_min, push_max : float
        The smallest and the largest push of the cylinder [force/length]. Where push_min is negative, the cylinder
        would have to pull: free to unbind, the rod would lift off there.
    attached : float
        Share of the length where the cylinder pushes.
    overlaps : bool or None
        Whether the rod intersects itself; None if the rod is too long to decide.
    closure : float
        The largest of the errors with which beta, alpha [rad] and z/rho close.

    Examples
    --------
    >>> from solver import Cylinder, Rod, loops
    >>> (first, _) = loops(Rod(E=1.07e4, nu=0.25, a=0.1, L=10.0), Cylinder(R=0.9), turns_around=1, folds=1)
    >>> print(f"lam = {first.lam:.6f}, index {first.index}, self-intersection: {first.overlaps}")
    lam = -0.171987, index 0, self-intersection: False
    """

    solution: Solution
    turns_around: int
    folds: int
    about: float
    lam: float
    energy: float
    index: int
    push_min: float
    push_max: float
    attached: float
    overlaps: bool | None
    closure: float
    wraps = former("wraps")


class Loops(list[Loop]):
    """The loops of one rod, lowest energy first.

    remarks: sentences on loops that exist but were not found, or that do not close to 1e-9 of L/rho; empty if none.
    """

    def __init__(self, found: list[Loop], remarks: tuple[str, ...] = ()) -> None:
        super().__init__(found)
        self.remarks = remarks

    @property
    def complete(self) -> bool:
        """Whether no loop is known to be missing or inaccurate."""
        return not self.remarks

    def to_dataset(self, **units: str) -> Any:
        """The loops as an `xarray.Dataset` over `equilibrium`, which figures, scenes and exports read.

        Parameters
        ----------
        **units : str
            ``length`` and ``force``, the units of the rod; default: cm and N.
        """
        return make(NOTEBOOK, "loops_as_dataset", self, units)


def loops(
    rod: Rod,
    cylinder: Cylinder,
    turns_around: int = 1,
    folds: int = 2,
    stations: int = 401,
    wraps: int | None = None,
) -> Loops:
    """Every closed shape of a rod with FZ = M3 = 0, a number of turns around the axis and a number of folds.

    The rod closes in position and direction: beta(L) = beta(0), beta'(L) = beta'(0), z(L) = z(0), and alpha(L) =
    alpha(0) + 2 pi turns_around. Its angle oscillates `folds` times about pi/2 or -pi/2. By symmetry the section
    returns without a turn, gamma(L) = gamma(0), so the twist closes with M3 = 0: the ends may be glued, or joined by a
    swivel.

    Parameters
    ----------
    rod, cylinder
        One rod and one cylinder. L must exceed 2 pi rho turns_around, the length of the ring.
    turns_around : int
        Turns around the axis, at least 1.
    folds : int
        Periods of beta along the rod, at least 1. With a divisor d in common with `turns_around` the rod covers a
        shorter loop d times.
    stations : int
        Number of stations of each solution.
    wraps : int, optional
        Former name of `turns_around`.

    Returns
    -------
    Loops
        A list of `Loop`, lowest energy first. One loop oscillates about pi/2; near the ring it is a wave with
        lam = 2 - (folds/turns_around)^2. Another one oscillates about -pi/2; it intersects itself. More would be
        found where the azimuth of a period is not monotonic in the amplitude, which was not seen.

    Raises
    ------
    InputError
        For arrays, a number of turns or folds below 1, and a rod that is not longer than the ring.

    Examples
    --------
    >>> from solver import Cylinder, Rod, loops
    >>> found = loops(Rod(E=1.07e4, nu=0.25, a=0.1, L=10.0), Cylinder(R=0.9), turns_around=1, folds=2)
    >>> [one.index for one in found], found[0].push_min < 0
    ([2, 3], True)
    """
    if wraps is not None:
        current("wraps")
        turns_around = wraps
    span = _check(rod, cylinder, turns_around, folds)
    shapes, remarks = [], []
    families = orbits_of_gain(span / folds, 2 * np.pi * turns_around / folds)
    for about, word, orbits in zip((1, -1), ("pi/2", "-pi/2"), families, strict=True):
        closed = [orbit for orbit in orbits if orbit.is_closed]
        family = [_loop(rod, cylinder, turns_around, folds, orbit, about, stations) for orbit in closed]
        worst = max((loop.closure for loop in family), default=0.0)
        if not family:
            remarks.append(
                f"the loop about {word} was not found: it lies nearer to a separatrix than numbers of 64 bits resolve"
            )
        if worst > 100 * TOL * span:
            remarks.append(
                f"the loop about {word} closes only to {worst:.1e}: it lies so near to a separatrix that rounding shows"
            )
        shapes += family
    return Loops(sorted(shapes, key=lambda loop: loop.energy), tuple(remarks))


def _check(rod: Rod, cylinder: Cylinder, turns_around: int, folds: int) -> float:
    """L/rho of a rod that can form the loop."""
    counts: dict[str, Any] = {"turns_around": turns_around, "folds": folds}
    for name, value in counts.items():
        whole_number(name, value, 1, 1_000_000)
    refuse_leaving(check_type("loops", cylinder, Cylinder), "loops")
    case = Case(rod, cylinder, Start(0.0, 0.0, M3=0.0))
    if case.shape:
        raise InputError(f"loops takes one rod and one cylinder, got fields of shape {case.shape}")
    if not units_held(case).all():
        raise InputError(reason_beyond(OUT_OF_RANGE, case))
    span, ring = float(rod.L / case.rho), 2 * np.pi * turns_around
    if not span > ring * (1 + 1e-12):
        times = f"{turns_around} turn{'s' * (turns_around > 1)}"
        raise InputError(
            f"a closed rod of {times} around the axis must be longer than the ring: "
            f"L > 2 pi rho {turns_around} = {ring * case.rho:.12g}, got L = {rod.L:.12g}"
        )
    return span


def _loop(
    rod: Rod, cylinder: Cylinder, turns_around: int, folds: int, orbit: ClosedOrbit, about: int, stations: int
) -> Loop:
    """The loop of an orbit; about: 1, or -1 for the mirror image of the orbit."""
    case = Case(rod, cylinder, _start(rod, cylinder, about * orbit.lowest, about * orbit.lam))
    sol = solve(case, tol=TOL, stations=stations)
    measured = observe(sol, ("bending_energy", "push_min", "push_max", "attached", "kappa_max"))
    seen = {name: float(value) for name, value in measured.items()}
    kept = sol.trajectory
    ends = kept.beta[0, -1] - kept.beta[0, 0], kept.alpha[0, -1] - 2 * np.pi * turns_around, kept.z[0, -1]
    closure = float(np.abs([*ends, kept.dbeta[0, -1]]).max())
    radius, tightest = float(rod.a / case.rho), seen["kappa_max"] * float(case.rho)
    met = None if kept.orbit is None else meets_itself(kept.orbit, radius, tightest)
    numbers = seen["bending_energy"], index_of(orbit.lowest, orbit.lam, folds), seen["push_min"], seen["push_max"]
    lam = about * float(orbit.lam)
    return Loop(sol, int(turns_around), int(folds), about * np.pi / 2, lam, *numbers, seen["attached"], met, closure)


def _start(rod: Rod, cylinder: Cylinder, beta: float, lam: float) -> Start:
    """The start at a turning point whose reduced problem has this lam and phi = 0, to the last bit where it can be."""
    rho = float(Case(rod, cylinder, Start(0.0, 0.0, M3=0.0)).rho)
    s, c = np.sin(beta), np.cos(beta)
    FY = float(rod.bending_stiffness) / rho**2 * (lam - s**3)
    near = np.arange(-_ULPS, _ULPS + 1)
    F2, F3 = (force + near * np.spacing(force) for force in (-FY * c, FY * s))
    tried = Start(float(beta), 0.0, F2=F2[:, None], F3=F3, M3=0.0)
    problem = reduce(Case(rod, cylinder, tried))
    best = int(np.argmin(np.abs(problem.lam - lam) + np.abs(problem.phi)))
    return Start(float(beta), 0.0, F2=float(F2[best // near.size]), F3=float(F3[best % near.size]), M3=0.0)
