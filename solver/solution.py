"""The solution: a shape, and what can be asked of it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from .free.free_rods import FREE_TOLERANCE, answers_beside, trajectory_of
from .free.let_go_descent import descent_of
from .free.starting_curves import curves_of, let_go
from .nodes.pipe_states import azimuths, ends_turn, is_drawn, states
from .numerics.arrays import Array
from .observe.cautions import of_cases
from .observe.solution_derivatives import Sensitivity, sensitivity
from .orbits import frames
from .orbits.shape_arrays import ShapeArrays
from .problem.case_fields import place_along, with_field
from .problem.dimensionless import fields_held, flat, loads_of
from .problem.errors import InputError, check_tolerance, show, whole_number
from .problem.shown import NOTEBOOK, Picture, make, table_of

if TYPE_CHECKING:
    from pathlib import Path


class Solution(ShapeArrays):
    """The shape of a case, or of each case of a grid, at n stations in the units of the case.

    `solve` makes it. Quantities along the rod have the shape (*cases, n), quantities of a case (*cases); each is
    computed when it is first read, and kept. A quantity of an unsolved case may be NaN.

    Attributes
    ----------
    solved, outcome, caution : bool and two str for each case
        Whether it is solved; "solved", perhaps with a remark, or why it is not; what a real rod could not do.
    error, condition : float for each case
        Estimated error along the rod, and the factor by which a change of the start can grow.
    s, beta, alpha, z, position, kappa, push : array, n stations for each case
        The shape and what the cylinder presses with; position has a further axis x, y, z. More are listed below.
    FZ, MZ, M3 : float for each case
        The loads, given or found.
    case : Case
        The case that was solved.
    method : str
        Name of the method.
    tol : float
        Tolerance.
    problem, trajectory, t : StartProblem or EndsProblem, Trajectory, array (B, n)
        For methods: the problem and its answer without units, and the stations, a row for each of B cases.

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

        The unit of E is not known here: the strain is judged as that of steel. `solver.observe.cautions` says which
        texts there are.
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

    def sel(self, **values: Any) -> Self:
        """The solutions of the cases at these values of fields that vary; nothing is solved again.

        Parameters
        ----------
        **values : float, str or list
            Of a field, to nine digits; an angle in rad or as text. An axis of which one value is selected is gone.

        Returns
        -------
        Solution

        Raises
        ------
        InputError
            For a field that does not vary along one axis, and for a value that no case has, with those that are.

        Examples
        --------
        >>> from solver import Case, Cylinder, Rod, Start, solve
        >>> rod = Rod(E=[1e4, 2e4, 4e4], nu=0.25, a=0.25, L=20.0)
        >>> rods = solve(Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)))
        >>> one = rods.sel(E=2e4)
        >>> one.case.rod.E, bool(one.z[-1] == rods.z[1, -1]), rods[1:].case.shape
        (20000.0, True, (2,))
        """
        selected = self
        for name, value in values.items():
            axis, place = place_along(selected.case, name, value)
            selected = selected[(*[slice(None)] * axis, place)]
        return selected

    def let_go(self, tol: float | None = None, seed: "Solution | None" = None) -> "FreeSolution":
        """What the rod becomes beside a cylinder that only pushes, while both ends stay as they are.

        Position, direction and rotation of both ends are held. The shape is a minimum of the energy, which continues
        from this shape; others may exist. A rod that is stable and pressed on everywhere stays as it is.

        Parameters
        ----------
        tol : float, optional
            Tolerance of the places of the rod, as a share of its length; default: 1e-4.
        seed : Solution, optional
            From which shape of as many rods the search begins; default: this shape.

        Returns
        -------
        FreeSolution
            At the stations of this solution, of the case with `contact="unilateral"` and held ends.

        Raises
        ------
        InputError
            With friction, for an invalid tolerance or seed, and where the package unopy is not installed.

        Examples
        --------
        >>> from solver import Case, Cylinder, Ends, Rod, solve
        >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
        >>> ends = Ends(beta0=0.5, betaL=0.8, FZ=-8.66, MZ=1.3, M3=6.1)
        >>> free = solve(Case(rod, Cylinder(R=0.75), ends)).let_go()
        >>> begin, end = free.contacts[0]
        >>> print(f"on the wall from s = {begin:.1f} to {end:.1f}; gap up to {free.gap.max():.2f}")
        on the wall from s = 3.5 to 15.0; gap up to 0.21
        """
        from .methods import FREE

        tol = check_tolerance(FREE_TOLERANCE if tol is None else tol)
        case, shapes = let_go(self, curves_of(self, "the shape that was let go"))
        begun: object = self if seed is None else seed
        if not (isinstance(begun, Solution) and begun.case.size == case.size):
            raise InputError(f"a seed of let_go is a Solution of as many rods, {case.size}; got {show(seed)}")
        curves = shapes if seed is None else curves_of(begun, "the seed")
        unsolved = "there is no shape to be let go", "the seed is not solved"
        pairs = zip(shapes, curves, strict=True)
        ways = [unsolved[shape is not None] if shape is None or curve is None else [curve] for shape, curve in pairs]
        answers = answers_beside(case, ways, self.t, tol)
        return FreeSolution(case, *answers, self.t, FREE, tol)

    def descent(self, count: int, tol: float | None = None) -> "tuple[FreeSolution, Array]":
        """How the rod of one case gets to rest where it is let go: as in a viscous medium, by a descent of the energy.

        The medium drags on each length of the rod alike, and does not resist the rotation of its sections. This is no
        dynamics: a real rod is faster, and may come to rest elsewhere.

        Parameters
        ----------
        count : int
            Number of shapes, from 1. Each moves about as far from the one before; the last is at rest.
        tol : float, optional
            As of `let_go`.

        Returns
        -------
        FreeSolution
            The shapes one after another, of shape (count,). The last one is that of `let_go`, unless its outcome says
            that the rod comes to rest elsewhere.
        array
            The energy above that at rest, (count + 1,) [force length]: first that of this shape. It never rises.

        Raises
        ------
        InputError
            As of `let_go`, for a count that is none, for several cases, and where the rod stays as it is or is not
            solved.
        """
        count = whole_number("count", count, 1, 10_000)
        if self.case.shape:
            raise InputError(f"the descent is that of one case, and these are {self.case.size}: select one with sel")
        free = self.let_go(tol)
        if not free.solved:
            raise InputError(f"this rod is not let go: {free.outcome}")
        (curve,) = curves_of(self, "the shape that was let go")
        answer = free.trajectory.free.answers[0]
        assert curve is not None
        answers, energy = descent_of(free.case, curve, answer, count)
        case = with_field(free.case, "R", np.full(count, self.case.cylinder.R))
        problem, known = trajectory_of(case, answers, np.repeat(self.t, count, axis=0), free.tol)
        energy = (energy - energy[-1]) * (self.case.rod.bending_stiffness / self.case.rho)
        return FreeSolution(case, problem, known, np.repeat(self.t, count, axis=0), free.method, free.tol), energy

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
        xarray.Dataset
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
        return make(NOTEBOOK, "as_dataset", self, units)

    def plot(self, **units: str) -> Picture:
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
        return make(NOTEBOOK, "plot_solution", self, units)

    def scene(self, **units: str) -> Picture:
        """The rod on its cylinder; a notebook shows it inline, and a reader turns it.

        Parameters
        ----------
        **units : str
            ``length`` and ``force``, the units of the case, for labels; default: these words.

        Returns
        -------
        workbench.notebook.NotebookScene
            With a slider for each axis of the case. ``save("rod.html")`` writes it as one offline file.

        Raises
        ------
        InputError
            Where no case has a shape.
        """
        return make(NOTEBOOK, "scene_solution", self, units)

    def export(self, path: Any, *, tolerance: float | None = None, replace: bool = False, **units: str) -> "Path":
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
        return make(NOTEBOOK, "export_solution", self, path, tolerance, replace, units)

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


class FreeSolution(Solution):
    """The shape of a case, or of each case of a grid, beside a cylinder that only pushes.

    `solve` makes it of a case with `contact="unilateral"`, and `Solution.let_go` of any solution. It is a `Solution`
    whose rods may be off the wall: `radius`, `gap` and `tilt` say where, `contacts` and `point_forces` where and how
    the cylinder pushes, and `push` is 0 off the wall. Moments and forces have components along N, B and T, an
    orthonormal frame: the tangent T leans out of the tangent plane of the cylinder by the tilt, the binormal B is in
    that plane, and the normal N = B x T is towards the axis where there is no tilt. A hinge on the wall that its M2
    presses into it lies along it: there `M2` is the moment in the rod, and the wall takes the rest. There is no first
    integral: `h` is NaN.

    Examples
    --------
    A pipe in a hole, centred at both ends, straight on the low side in between:

    >>> from solver import Case, Cylinder, Ends, Rod, solve
    >>> pipe = Rod(EI=1228.0, GJ=945.0, a=0.0635, L=100.0, weight=0.242)  # m, kN
    >>> hole = Cylinder(R=0.108, side="inside", inclination="90deg", contact="unilateral")
    >>> solution = solve(Case(pipe, hole, Ends(beta0=0.0, betaL=0.0, FZ=-150.0, radius0=0.0, radiusL=0.0)))
    >>> begin, end = solution.contacts[0]
    >>> print(f"on the wall from s = {begin:.0f} to {end:.0f}")
    on the wall from s = 10 to 90
    """

    def _along_free(self, name: str) -> Array:
        """Something along the rods in units of A and rho, (*cases, n), vectors (*cases, n, 3)."""
        values = getattr(self.trajectory.free.along, name)
        return values.reshape(*self.case.shape, *values.shape[1:])

    @cached_property
    def loads(self) -> tuple[Any, Any, Any]:
        """FZ [force], MZ and M3 [force length]: those of the case, or found where displacements are held.

        MZ is found at a far end on the axis too: the azimuth of its frame is held, whether it is given or not.
        """
        (FZ, MZ, M3), shape = super().loads, self.case.shape
        on_axis = np.broadcast_to(np.equal(self.case.end_radii[1], 0.0), shape)
        moment = loads_of(self.problem, self.case.rod.bending_stiffness, self.case.rho, shape)[1].reshape(shape)
        return FZ, np.where(on_axis, moment, MZ)[()], M3

    @cached_property
    def _units(self) -> tuple[Array, Array]:
        """A/rho and A/rho^2, (*cases, 1)."""
        moment = self._column(self.case.rod.bending_stiffness) / self._rho
        return moment, moment / self._rho

    def _part(self, name: str, direction: Array) -> Array:
        """The component of a force or a moment in a direction (*cases, n, 3), in units of A and rho."""
        return np.asarray((self._along_free(name) * direction).sum(axis=-1))

    @property
    def radius(self) -> Array:
        return self._along_free("radius") * self._rho

    @property
    def tilt(self) -> Array:
        return self._along_free("turned")[..., 2, :]

    @property
    def gamma(self) -> Array:
        return self._along_free("turned")[..., 3, :]

    @property
    def position(self) -> Array:
        return frames.position(self.radius, self.alpha, self.z)

    @property
    def tangent(self) -> Array:
        return self._along_free("tangent")

    @property
    def normal(self) -> Array:
        return np.cross(frames.binormal(self.alpha, self.beta), self.tangent)

    @property
    def material_frame(self) -> Array:
        d1, d3 = self._along_free("d1"), self.tangent
        return np.stack([d1, np.cross(d3, d1), d3], axis=-2)

    @property
    def kappa(self) -> Array:
        bent = np.cross(self.tangent, self._along_free("moment"))
        return np.linalg.norm(bent, axis=-1) / self._rho

    @property
    def FY(self) -> Array:
        around = np.cross([0.0, 0.0, 1.0], frames.outward(self.alpha))
        return self._part("force", around) * self._units[1]

    @property
    def F1(self) -> Array:
        return self._part("force", self.normal) * self._units[1]

    @property
    def F2(self) -> Array:
        return self._part("force", frames.binormal(self.alpha, self.beta)) * self._units[1]

    @property
    def F3(self) -> Array:
        return self._part("force", self.tangent) * self._units[1]

    @property
    def contact(self) -> Array:
        return self.case.outward * self._along_free("push") * self._units[1] / self._rho

    @property
    def M1(self) -> Array:
        return self._part("moment", self.normal) * self._units[0]

    @property
    def M2(self) -> Array:
        return self._part("moment", frames.binormal(self.alpha, self.beta)) * self._units[0]

    @property
    def h(self) -> Array:
        return np.full(self.s.shape, np.nan)

    @cached_property
    def states(self) -> Any:
        each, rho = np.full(self.case.size, None, dtype=object), flat(self.case.rho, self.case.shape)
        weight, theta = (
            0.0 if field is None else field for field in (self.case.rod.weight, self.case.cylinder.inclination)
        )
        lies = flat((np.asarray(weight) != 0) & (np.asarray(theta) > 0) & (np.asarray(theta) < np.pi), self.case.shape)
        for i in np.flatnonzero(self.trajectory.solved & self.case.varies).tolist():
            answer = self.trajectory.free.answers[i]
            shape = answer.shapes[-1]
            along = shape.at_stations(shape.nodes)
            off, error = np.hypot(*shape.x[:, :2].T), answer.error * shape.rod.span
            alpha = azimuths(shape.nodes, along.turned[0], off, error)
            drawn = is_drawn(along.force[:, 2], along.push)
            turns = ends_turn(bool(lies[i]), "azimuth" in fields_held(self.case))
            each[i] = states(shape.nodes * rho[i], along.turned[1], alpha, drawn, turns)
        return self._each(each)

    @cached_property
    def contacts(self) -> Any:
        return self._of_contacts(lambda on, rho, _: [(on.begin * rho, on.end * rho)])

    @cached_property
    def point_forces(self) -> Any:
        return self._of_contacts(lambda on, rho, unit: [(s * rho, force * unit) for s, force in on.points])

    def _of_contacts(self, read: Callable[[Any, float, float], Iterable[tuple[float, float]]]) -> Any:
        """What is read of the contacts of each solved case, with rho and the unit of forces, (*cases) of tuples."""
        pairs = np.full(self.case.size, None, dtype=object)
        units = (np.broadcast_to(unit, (*self.case.shape, 1)).ravel() for unit in (self._rho, self._units[1]))
        for i, (answer, rho, unit) in enumerate(zip(self.trajectory.free.answers, *units, strict=True)):
            if self.trajectory.solved[i]:
                contacts = answer.shapes[-1].contacts
                pairs[i] = tuple(pair for on in contacts for pair in read(on, float(rho), float(unit)))
        return self._each(pairs)


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
