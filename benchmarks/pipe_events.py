"""The loads at which a long horizontal pipe changes its state, from the solver's own branches.

A period of a long sinusoid, and of a long helix, is cut at its points of inflection: a half wave between hinges whose
azimuths are held, 0 and 0, or 0 and pi. Of the wave numbers k, a long pipe takes that of least energy per length: the
energy of a half wave of length L is stationary where E/L = dE/dL, and dE/dL is minus the constant
F3 + A kappa^2/2 - w height of the rod. Forces F are in units of sqrt(A w/rho), lengths in (A rho/w)^(1/4), energies
per length in w rho above that of the straight pipe, pushes in w. The pipe is slender: w rho^3/A = 1e-14, so that the
terms that a slender pipe neglects are 1e-7. There is no torque and no friction.

Run ``python -m benchmarks.pipe_events`` for the table and docs/figures/pipe_events.png.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq, minimize_scalar

from solver import Case, Cylinder, Ends, Rod, Solution, observe, solve
from workbench.figures import canvas, colours, fonts
from workbench.figures.sheet import sheet

WEIGHT = 1e-14  # w rho^3/A
LENGTH, FORCE = WEIGHT**-0.25, WEIGHT**0.5
SINUSOID, HELIX = 0.0, np.pi  # azimuth over half a wave
BETWEEN = {SINUSOID: (0.9, 1.1), HELIX: (1.0, 1.4)}  # wave numbers of least energy of F from 2 to 3.6
STEP = 0.005  # of the wave number, on the way to the fold
PICTURE = Path(__file__).parents[1] / "docs" / "figures" / "pipe_events.png"


@dataclass
class HalfWave:
    """One branch of half waves. azimuth: over half a wave. seed: the last shape that was accepted."""

    azimuth: float
    seed: Solution | None = field(default=None)

    def shape(self, force: float, k: float) -> Solution:
        """The half wave of wave number k under a compression."""
        rod = Rod(EI=1.0, GJ=1.0, a=0.1, L=np.pi / k * LENGTH, weight=WEIGHT)
        ends = Ends(M10=0.0, M1L=0.0, FZ=-force * FORCE, azimuth=self.azimuth)
        return solve(Case(rod, Cylinder(R=1.1, side="inside", inclination="90deg"), ends), stations=9, seed=self.seed)

    def tilt(self, force: float, k: float) -> float:
        """E/L - dE/dL: 0 at a wave number whose energy per length is stationary."""
        sol = self.shape(force, k)
        if not sol.solved or np.ptp(sol.alpha) < 0.1:
            raise ArithmeticError(f"no half wave at F = {force}, k = {k}: {sol.outcome}")
        constant = sol.F3[0] + sol.kappa[0] ** 2 / 2 + WEIGHT * np.cos(sol.alpha[0])
        return float((constant + force * FORCE) / WEIGHT - 1 + energy(sol, force))

    def best(self, force: float) -> Solution:
        """The half wave of the wave number of least energy per length."""
        return self.shape(force, brentq(lambda k: self.tilt(force, k), *BETWEEN[self.azimuth], xtol=1e-10))

    def force_at(self, k: float, near: float) -> float:
        """The compression at which a wave number is that of stationary energy."""
        return float(brentq(lambda force: self.tilt(force, k), near - 0.05, near + 0.05, xtol=1e-11))


def energy(sol: Solution, force: float) -> float:
    """The energy per length above that of the straight pipe; the held azimuth does no work."""
    whole = float(observe(sol, ["energy"])["energy"]) + float(sol.MZ) * sol.alpha[-1]
    return (whole / float(sol.case.rod.L) - force * FORCE) / WEIGHT + 1


def push_min(sol: Solution) -> float:
    """The smallest push of the wall."""
    return float(observe(sol, ["push_min"])["push_min"]) / WEIGHT


def wave_number(sol: Solution) -> float:
    """The wave number of a half wave."""
    return float(np.pi * LENGTH / sol.case.rod.L)


def buckling_load() -> float:
    """The least compression at which a straight half wave of any length buckles."""
    from solver.nodes.buckling import tension_of_buckling
    from solver.nodes.loaded_rod import rods_of

    def load(k: float) -> float:
        straight = Case(
            Rod(EI=1.0, GJ=1.0, a=0.1, L=np.pi / k * LENGTH, weight=WEIGHT),
            Cylinder(R=1.1, side="inside", inclination="90deg"), Ends(M10=0.0, M1L=0.0, FZ=0.0, azimuth=0.0),
        )  # fmt: skip
        tension = tension_of_buckling(rods_of(straight)[0])
        assert tension is not None
        return -tension / FORCE

    return float(minimize_scalar(load, bounds=(0.5, 2.0), method="bounded", options={"xatol": 1e-4}).fun)


def fold() -> tuple[float, list[tuple[float, float]]]:
    """The largest compression with a sinusoid of stationary energy, and the (k, F) on the way there."""
    branch = HalfWave(SINUSOID)
    start = branch.best(3.5)
    path = [(wave_number(start), 3.5)]
    branch.seed, slope = start, -20.0  # of F over k, there
    while len(path) < 3 or path[-1][1] > path[-2][1]:
        (k, force) = path[-1]
        path.append((k - STEP, branch.force_at(k - STEP, force - slope * STEP)))
        branch.seed = branch.shape(path[-1][1], path[-1][0])
        slope = (path[-1][1] - path[-2][1]) / (path[-1][0] - path[-2][0])
    near = path[-2][1]
    last = minimize_scalar(lambda k: -branch.force_at(k, near), bracket=[k for k, _ in path[-3:]], tol=1e-6)
    return -float(last.fun), path


def events() -> dict[str, float]:
    """The six compressions, by what happens there."""
    sinusoid, helix = HalfWave(SINUSOID), HalfWave(HELIX)

    def where(value: Callable[[float], float], low: float, high: float) -> float:
        return float(brentq(value, low, high, xtol=1e-9))

    return {
        "the straight pipe becomes unstable": buckling_load(),
        "above it the helix is pressed on the wall everywhere": where(lambda F: push_min(helix.best(F)), 2.6, 2.9),
        "helix and straight pipe have equal energy": where(lambda F: energy(helix.best(F), F), 2.6, 2.9),
        "helix and sinusoid have equal energy": where(
            lambda F: energy(helix.best(F), F) - energy(sinusoid.best(F), F), 2.6, 3.2
        ),
        "above it the sinusoid would lift off": where(lambda F: push_min(sinusoid.best(F)), 3.2, 3.6),
        "the sinusoid ends in a fold, if the wall could pull": fold()[0],
    }


def draw(found: dict[str, float], path: Path = PICTURE) -> None:
    """Draw the energies of the three states over the compression, with the events."""
    loads = list(found.values())
    _, way = fold()
    branch, rising = HalfWave(SINUSOID), [(loads[0], 0.0, 1.0)]
    below = [(None, F) for F in np.linspace(2.06, loads[4], 30)]
    for k, force in [*below, *(pair for pair in way if pair[1] > loads[4])]:
        sol = branch.best(force) if k is None else branch.shape(force, k)
        branch.seed = sol if force > 3.5 else None
        rising.append((force, energy(sol, force), push_min(sol)))
    wound = [
        (F, energy(sol, F), push_min(sol)) for F in np.linspace(2.6, 3.6, 41) for sol in (HalfWave(HELIX).best(F),)
    ]
    heights = [0.0, *(float(np.interp(F, *np.array(wound).T[:2])) for F in loads[1:4]),
               float(np.interp(loads[4], *np.array(rising).T[:2]))]  # fmt: skip

    def diagram(figure: Figure) -> None:
        axes = figure.add_subplot()
        straight, sinusoidal, helical = colours.STATES.values()
        axes.plot([1.8, loads[0]], [0, 0], color=straight, lw=2.5)
        axes.plot([loads[0], 3.9], [0, 0], color=straight, lw=0.8)
        for rows, colour in ((rising, sinusoidal), (wound, helical)):
            force, height, push = np.array(rows).T
            axes.plot(force, height, color=colour, lw=0.8)
            axes.plot(np.where(push >= -1e-5, force, np.nan), height, color=colour, lw=2.5)
        for number, (force, height) in enumerate(zip(loads, heights, strict=False), 1):
            axes.plot(force, height, "o", color=colours.INK, ms=4)
            axes.annotate(f"{number}, F = {force:.3f}", (force, height), (6, 6), textcoords="offset points",
                          size=fonts.small())  # fmt: skip
        for text, place, colour in (("straight", (1.83, 0.015), straight),
                                    ("sinusoid", (3.12, -0.09), sinusoidal),
                                    ("helix", (3.44, -0.46), helical),
                                    ("thick: stable and pressed on the wall", (1.83, -0.56),
                                     colours.SOFT)):  # fmt: skip
            axes.text(*place, text, color=colour)
        axes.set(xlim=(1.8, 3.9), ylim=(-0.6, 0.18), xlabel="compression F, in √(EI w/ρ)",
                 ylabel="energy per length, in w ρ,\nabove that of the straight pipe")  # fmt: skip

    page = sheet("paper", titled=False)
    canvas.save(canvas.figure((page.width, 3.6), diagram, sheet=page), path)


if __name__ == "__main__":
    table = events()
    for words, compression in table.items():
        print(f"{compression:.6f}  {words}")
    draw(table)
