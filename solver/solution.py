"""The solution: a shape, and what can be asked of it."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from .numerics.arrays import Array
from .observe.cautions import of_cases
from .problem.shown import make, table_of
from .sensitivity.solution_derivatives import Sensitivity, sensitivity
from .shape import Shape

SHOWN = "workbench.notebook"  # loaded by name when a solution is shown: the solver works without the workbench


class Solution(Shape):
    """The shape of a case, or of each case of a grid, at n stations in the units of the case.

    `solve` makes it. Quantities along the rod have the shape (*cases, n), quantities of a case (*cases); each is
    computed when it is first read, and kept. A quantity of an unsolved case may be NaN.

    Attributes
    ----------
    case : Case
        The case that was solved.
    problem : StartProblem or EndsProblem
        The dimensionless problem of the case.
    trajectory : Trajectory
        The answer of the method, in units of rho.
    t : array, (B, n)
        Stations in units of rho, a row for each of the B cases.
    method : str
        Name of the method.
    tol : float
        Tolerance.

    Examples
    --------
    >>> from solver import Case, Cylinder, Rod, Start, solve
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    >>> solution = solve(Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)))
    >>> solution.outcome, bool(solution.solved), solution.beta.shape
    ('solved', True, (201,))
    >>> print(f"height {solution.z[-1]:.4f}, largest push {solution.push.max():.3f}")
    height 8.8017, largest push 390.157
    """

    @property
    def caution(self) -> Any:
        """What a real rod could not do, (*cases) of str, such as "overlaps"; "" where nothing was found.

        `solver.observe.cautions` says which texts there are.
        """
        return of_cases(self)[()]

    @cached_property
    def alternatives(self) -> "tuple[Alternative, ...]":
        """Other equilibria with the same held ends, the nearest to the seed first.

        They are looked for when this is first read (about a second): across the nearest fold, by deflation from the
        seed, and where the branch of the seed turns back and meets these ends again. There may be more. Empty for
        several cases, without a seed and under dead loads.
        """
        find = self.trajectory.alternatives
        if find is None or self.case.shape or not self.solved:
            return ()
        return tuple(
            Alternative(away, Solution(self.case, problem, shape, self.t, self.method, self.tol))
            for away, problem, shape in find(self.t)
        )

    def sensitivity(self, fields: Iterable[str], observables: Iterable[str] = ()) -> Sensitivity:
        """The derivatives with respect to fields of the case, along the rod and of observables.

        They are exact derivatives of the solution, computed from its orbit and not from differences. Of an ends problem
        they are those along its branch: what the case gives of each pair (beta(0) or M10, FZ or height, ...) is held,
        and beta'(0) and the rest follow. With weight or friction the linear equations of the shape say how its states
        answer a field, and what is read of it is differenced along that line: about nine digits.

        Parameters
        ----------
        fields : iterable of str
            Names of numeric fields of the case: ``E``, ``nu``, ``a``, ``L``, ``R``; of a start problem ``beta0``,
            ``dbeta0``, ``F2``, ``F3`` and whichever of ``F1``, ``dgamma``, ``M3`` is given; of an ends problem
            whichever is given of ``beta0`` and ``M10``, ``betaL`` and ``M1L``, ``FZ`` and ``height``, ``MZ`` and
            ``azimuth``, ``M3`` and ``rotation``; ``alpha0`` and ``gamma0``.
        observables : iterable of str
            Names of observables, as of `observe`. The derivative of a whole number is 0.

        Returns
        -------
        Sensitivity
            Its `beta`, `dbeta`, `alpha`, `z`, `gamma` have the shape (*cases, F, n), its `observables[name]` (*cases,
            F). The stations keep their place s/L when a field changes: the derivative with respect to L at a constant s
            is ``beta - s/L * solution.dbeta``, and likewise for the others.

        Raises
        ------
        InputError
            For an unknown or repeated field, and an unknown observable.

        Examples
        --------
        >>> from solver import Case, Cylinder, Rod, Start, solve
        >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
        >>> solution = solve(Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)))
        >>> found = solution.sensitivity(["E", "F1"], ["height"])
        >>> found.beta.shape, found.outcome
        ((2, 201), 'solved')
        >>> print(f"d height/d F1 = {found.observables['height'][1]:.4f}")
        d height/d F1 = 0.1809
        """
        return sensitivity(self, fields, observables)

    def to_dataset(self, **units: str) -> Any:
        """The solution as a dataset with labels and units, which figures, scenes and exports read.

        Parameters
        ----------
        **units : str
            ``length`` and ``force``, the units of the case, for labels; default: these words.

        Returns
        -------
        xr.Dataset
            beta, dbeta, alpha, z and contact over (axes, u), u = s/L; the numbers, outcome and caution of each case.

        Raises
        ------
        InputError
            For another unit than these two.

        Examples
        --------
        >>> from solver import Case, Cylinder, Rod, Start, solve
        >>> rod = Rod(E=[1e4, 2e4], nu=0.25, a=0.25, L=20.0)
        >>> solution = solve(Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)))
        >>> ds = solution.to_dataset(length="cm", force="N")
        >>> dict(ds.beta.sizes), ds.z.units
        ({'E': 2, 'u': 201}, 'cm')
        """
        return make(SHOWN, "dataset_of", self, units)

    def plot(self, **units: str) -> Any:
        """Draw the solution; a notebook shows it inline.

        Parameters
        ----------
        **units : str
            ``length`` and ``force``, the units of the case, for labels; default: these words.

        Returns
        -------
        workbench.notebook.Plot
            One case: its angle, push and developed curve; several cases: their developed curves. ``save("rod.pdf")``
            writes it, ``figure`` is the Matplotlib figure.
        """
        return make(SHOWN, "plot_solution", self, units)

    def scene(self, **units: str) -> Any:
        """The rod on its cylinder; a notebook shows it inline, and a reader turns it.

        Parameters
        ----------
        **units : str
            ``length`` and ``force``, the units of the case, for labels; default: these words.

        Returns
        -------
        workbench.notebook.Scene
            With a slider for each axis of the case. ``save("rod.html")`` writes it as one offline file.

        Raises
        ------
        InputError
            Where no case has a shape.
        """
        return make(SHOWN, "scene_solution", self, units)

    def export(self, path: Any, *, tolerance: float | None = None, replace: bool = False, **units: str) -> Any:
        """Write the rod to a file of another program; the suffix chooses the format.

        Parameters
        ----------
        path : str or Path
            CAD (.step), surfaces (.stl, .obj, .glb), curves (.usda, .vtp) or a table (.csv). Of several cases along one
            axis each is a file, and the name holds a number: ``rod_{:03d}.stl``; or one file holds them (.pvd).
        tolerance : float, optional
            The greatest distance of the file from the rod [length]; default: that of the format.
        replace : bool, optional
            Replace a file that exists.
        **units : str
            ``length`` and ``force``, the units of the case, such as "mm" and "N".

        Returns
        -------
        pathlib.Path

        Raises
        ------
        InputError
            An invalid name or unit, an existing file, too few stations, a solid that the rod cannot be, or several rods
            and a name for one.

        Warns
        -----
        UserWarning
            Of rods that are left out, and of what a real rod could not do.
        """
        return make(SHOWN, "export_solution", self, path, tolerance, replace, units)

    def __repr__(self) -> str:
        """The outcome and three numbers; of several cases how many are solved, and their ranges."""
        solved, shape = np.atleast_1d(self.solved).ravel(), self.case.shape
        if not shape:
            words = str(self.outcome)
        else:
            words = f"{np.count_nonzero(solved)} of {solved.size} cases solved, shape {shape}"
        numbers = {"height": self.z[..., -1], "beta(L)": self.beta[..., -1], "push_max": self.push.max(axis=-1)}
        said = [f"{name} {_range(np.ravel(value)[solved])}" for name, value in numbers.items()] if solved.any() else []
        return f"<Solution by {self.method}: {'; '.join([words, ', '.join(said)] if said else [words])}>"

    def _repr_html_(self) -> str | None:
        """A table for a notebook; None, which shows the `repr`, where the workbench cannot be imported."""
        return table_of("solution", self)


@dataclass(frozen=True, eq=False)
class Alternative:
    """Another equilibrium with the same held ends.

    Attributes
    ----------
    away : float
        The largest difference of beta from the seed, at equal s/L [rad].
    solution : Solution
        Its shape.
    """

    away: float
    solution: Solution


def _range(values: Array) -> str:
    """The number, or the least and the greatest of several."""
    low, high = f"{values.min():.6g}", f"{values.max():.6g}"
    return low if low == high else f"{low} to {high}"
