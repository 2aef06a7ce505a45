"""README's rod let go: this solver beside PyElastica, and beside trust-constr of SciPy on the same discrete rod.

Run from the checkout: `.venv/bin/python -m benchmarks.let_go` (two minutes; the extra contact, and PyElastica where it
is installed). Prints seconds of processor time, errors and ratios; nothing is asserted: machines differ.
"""

import contextlib
import importlib
import importlib.util
import io
import itertools
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import NonlinearConstraint, minimize
from scipy.sparse import coo_array

from solver import Case, Cylinder, Ends, Rod, solve
from solver.free.discrete_rod import DiscreteRod
from solver.free.free_problem import problems_of
from solver.free.minimum import minimise
from solver.free.program import Program, Sizes
from solver.free.starting_curves import curves_of, let_go

ROD = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
ENDS = Ends(beta0=0.5, betaL=0.8, FZ=-8.66, MZ=1.3, M3=6.1)
EDGES, ELEMENTS = 48, (50, 100, 200)
WALL, DAMPING, STEP = 1e6, 1.0, 0.2  # N/cm^2; 1/s; of the time of a wave through an element
FIRM = 1.0, 16.0  # times its own, how much its rod resists stretching and shearing, which ours does not do at all
CHUNK, LONGEST = 0.5, 12.0  # s
SETTLED = 5e-5  # of the length, the error of our answer: from where PyElastica ends, when it is there


def readme_rod(stations: int) -> Any:
    """README's rod on the cylinder."""
    return solve(Case(ROD, Cylinder(R=0.75), ENDS), stations=stations)


def same_rod() -> tuple[DiscreteRod, np.ndarray, Sizes]:
    """The discrete rod, the guess and the sizes with which the solver begins."""
    before = readme_rod(401)
    (curve,) = curves_of(before, "the rod that is let go")
    assert curve is not None
    (beside,) = problems_of(let_go(before, [curve])[0])
    rod = beside.rod_on(curve, 1.0, EDGES)
    return rod, curve.on(rod), beside.sizes(curve)


def trust_constr(rod: DiscreteRod, guess: np.ndarray, sizes: Sizes) -> Any:
    """The result of trust-constr, which is given all exact derivatives as sparse matrices."""
    program = Program(rod, sizes, rod.with_known(guess))
    (rows, columns, _), (above, beside, _) = program.slopes, program.bends
    low, high = (bound / program.unit_of for bound in rod.bounds)
    n = rod.size

    def hessian(z: np.ndarray, share: float, multipliers: np.ndarray) -> Any:
        lower = coo_array((program.hessian(z, share, multipliers), (above, beside)), shape=(n, n)).tocsr()
        return lower + lower.T - coo_array((lower.diagonal(), (np.arange(n),) * 2), shape=(n, n)).tocsr()

    conditions = NonlinearConstraint(
        program.conditions, low, high, hess=lambda z, v: hessian(z, 0.0, -v),
        jac=lambda z: coo_array((program.jacobian(z), (rows, columns)), shape=(low.size, n)).tocsr(),
    )  # fmt: skip
    return minimize(
        program.energy, np.zeros(n), jac=program.gradient, method="trust-constr", constraints=conditions,
        hess=lambda z: hessian(z, 1.0, np.zeros(low.size)), options={"gtol": 1e-6, "xtol": 1e-10, "maxiter": 3000},
    )  # fmt: skip


def relax_elastica(elements: int, firm: float) -> list[tuple[float, float]]:
    """Seconds of PyElastica after each stretch of time, and its largest distance from a fine shape over the length.

    The rod starts as it is held on, with its first and last node and element fixed: the elements as they end, for their
    middles are half an element from the ends that are held. The wall pushes by a stiff spring. A damper takes the
    energy away.
    """
    ea: Any = importlib.import_module("elastica")

    class System(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Damping):  # type: ignore[misc]
        pass

    class Wall(ea.NoForces):  # type: ignore[misc]
        def apply_forces(self, system: Any, time: Any = 0.0) -> None:
            radius = np.hypot(*system.position_collection[:2])
            push = WALL * system.rest_lengths[0] * np.maximum(rho - radius, 0) / radius
            system.external_forces[:2] += push * system.position_collection[:2]

    before = readme_rod(2 * elements + 1)
    fine = before.let_go(tol=3e-6)
    rho, L, E = float(before.case.rho), float(ROD.L), float(ROD.E)
    x, frames = before.position[::2].T, np.moveaxis(before.material_frame[1::2], 0, -1)
    frames[..., [0, -1]] = np.moveaxis(fine.material_frame[[1, -2]], 0, -1)
    rod = ea.CosseratRod.straight_rod(
        elements, np.zeros(3), np.array([0.0, 0, 1]), np.array([1.0, 0, 0]), L, float(ROD.a), 1.0,
        youngs_modulus=E, shear_modulus=E / 2 / (1 + float(ROD.nu)),
    )  # fmt: skip
    rod.position_collection[:], rod.director_collection[:] = x, frames
    rod.shear_matrix[:] *= firm
    system, step = System(), STEP * L / elements / np.sqrt(E * firm)
    system.append(rod)
    system.constrain(rod).using(ea.FixedConstraint, constrained_position_idx=(0, -1), constrained_director_idx=(0, -1))
    system.add_forcing_to(rod).using(Wall)
    system.dampen(rod).using(ea.AnalyticalLinearDamper, damping_constant=DAMPING, time_step=step)
    system.finalize()
    stepper, seconds, passed = ea.PositionVerlet(), [], 0.0
    ea.integrate(stepper, system, step, 1, progress_bar=False)  # compiles
    while passed < LONGEST:
        begin = time.process_time()
        ea.integrate(stepper, system, CHUNK, int(CHUNK / step), progress_bar=False)
        passed += CHUNK
        far = float(np.linalg.norm(rod.position_collection - fine.position[::2].T, axis=0).max()) / L
        seconds.append((time.process_time() - begin, far))
    spent = np.cumsum([each for each, _ in seconds])
    return [(float(at), far) for at, (_, far) in zip(spent, seconds, strict=True)]


def main() -> None:
    rod, guess, sizes = same_rod()
    seconds, minimum = median_time(lambda: minimise(rod, guess, sizes), 5)
    theirs, result = median_time(lambda: trust_constr(rod, guess, sizes), 1)
    print(f"{EDGES} edges: trust-constr {theirs:.3g} s, {result.nit} steps; ours {seconds:.3g} s; "
          f"ratio {theirs / seconds:.3g}")  # fmt: skip
    print(f"energy {result.fun * sizes.energy:.7g} and {rod.energy(minimum.y):.7g}")
    before = readme_rod(201)
    seconds, after = median_time(before.let_go, 5)
    print(f"let go: {seconds:.3g} s, error {float(after.error):.1e} of the length")
    if importlib.util.find_spec("elastica") is None:
        print("PyElastica is not installed")
        return
    for firm, elements in itertools.product(FIRM, ELEMENTS):
        with contextlib.redirect_stdout(io.StringIO()):  # it prints the time of each stretch
            relaxed = relax_elastica(elements, firm)
        last = relaxed[-1][1]
        away = [i for i, (_, far) in enumerate(relaxed) if abs(far - last) > SETTLED]
        settled = relaxed[away[-1] + 1 if away else 0][0]
        print(f"PyElastica, {elements} elements, {firm:g} times as firm: {settled:.3g} s, error {last:.1e}; "
              f"ratio {settled / seconds:.3g}")  # fmt: skip


def median_time(work: Callable[[], Any], rounds: int) -> tuple[float, Any]:
    """The median of the seconds, and the last answer."""
    seconds, answer = [], None
    for _ in range(rounds):
        begin = time.process_time()
        answer = work()
        seconds.append(time.process_time() - begin)
    return statistics.median(seconds), answer


if __name__ == "__main__":
    main()
