"""Shapes of least energy between held ends: a search that descends from simple shapes, the natural arch first.

Newton's rule on a mesh, turned towards less energy where the energy curves downwards, descends from each shape; from a
saddle it goes on to both sides. Between clamped ends the beta of a stable rod turns at most once more than
displacements are held, so shapes of few waves suffice. Where a minimum is rough, as where a long rod turns, its mesh is
refined.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from ..branches.given_numbers import FREE, Given
from ..numerics.arrays import ALIKE, FAINT, NEGLIGIBLE, ROUGHLY, Array
from ..numerics.roots import CLOSE
from ..orbits.potential import TAU
from .bordered_bands import Bordered, times
from .discrete_energy import LONGEST, DiscreteEnergy, EnergyMesh

# panels at first: 60 find the minima of 6 in four times the time; width of the first one beside an end, in that over
# which a layer decays. x10: the layer is not resolved until its panel is halved
_PANELS, _LAYER = 6, 3.0
# of a panel, and the most panels: a layer of 1/512 of a panel. x10: only minima that do not settle take longer
_HALVINGS, _MOST_PANELS = 9, 64
# steps of a descent; cuts of a step; rounds to meet the constraints after one. x10: only failures take longer
_ROUNDS, _CUTS, _MEETING = 80, 14, 6
# rad: a step beside a saddle; the push off it; saddles on a way. x10: minima are pushed off too, by half a turn
_SADDLE, _PUSH, _PUSHES = 0.03, 0.3, 3
# of the metric, first and then four times as much; to the direction that curves down. x10: shorter steps than needed;
# only time
_SHIFT, _ITERATIONS = 1e-3, 8
_WIDEST = 2.2  # rad: of a wave; beyond, a rod turns back. x10: whole turns that are no wave
_WILDEST = 1e50  # pace: the fourth power of a larger one is soon beyond the range of floats. x10: as good


@dataclass(frozen=True, eq=False)
class EnergyMinimum:
    """A shape of least energy between held ends, on a mesh.

    energy: held energy, in units of A/rho. beta: at the nodes (n,). reactions: to its constraints.
    fine: whether the mesh was refined to it.
    """

    land: DiscreteEnergy
    energy: float
    beta: Array
    reactions: Array
    fine: bool = False

    @property
    def numbers(self) -> dict[str, float]:
        """Its loads and end angles."""
        ends = {"beta0": float(self.beta[0]), "betaL": float(self.beta[-1])}
        return self.land.loads(self.beta, self.reactions) | ends

    def is_same(self, other: "EnergyMinimum") -> bool:
        """Whether another minimum on the mesh is this one."""
        apart = abs(self.energy - other.energy)
        # minima whose energies differ by less, as of mirror images, and whose angles differ by less [rad], are one
        return apart < ALIKE * (1 + abs(self.energy)) and float(np.abs(self.beta - other.beta).max()) < ROUGHLY


def is_turned_round(given: Given, beta: Array) -> bool:
    """Whether a dead force pushes, and some of beta (n,) is more than a quarter turn beyond the angles given at the
    ends, or between two hinges beyond that of a held azimuth.

    That lets the force do more work: a long pushed rod has the least energy so, and is not what a user means. Nothing
    keeps a rod between two hinges whose azimuth is free.
    """
    ends = [given.number(name, 0.0) for name in FREE[:2] if name in given.names]
    if not ends and "alpha" in given.names:
        ends = _angles(given, ends)[0][:1]
    if not ends or given.number("phi", 0.0) >= 0:
        return False
    return max(float(beta.max()) - max(ends), min(ends) - float(beta.min())) > np.pi / 2


def energy_minima(given: Given, helices: Sequence[float] = ()) -> list[EnergyMinimum]:
    """The minima that are found. helices: angles of helices that have these ends, from which it is descended too.

    None are sought where the numbers would leave the range of floats.
    """
    pace = max(_pace(given), taut_pace(given)[0])
    if not pace < _WILDEST:
        return []
    mesh = EnergyMesh.with_layers(_PANELS, _LAYER / (pace * given.span))
    land = DiscreteEnergy(given, mesh, pace)
    shapes = simple_shapes(given, mesh.nodes, pace) + [np.full(mesh.nodes.size, beta) for beta in helices]
    minima = list[EnergyMinimum]()
    for shape in shapes:
        minima += [minimum for minimum in _descents(land, shape, _PUSHES) if not any(map(minimum.is_same, minima))]
    return minima


def refinement(minimum: EnergyMinimum) -> EnergyMinimum | None:
    """The minimum on a mesh that is fine enough for it; None where a finer mesh has none there."""
    for _ in range(_HALVINGS):
        land = minimum.land
        mesh = land.mesh.finer(minimum.beta)
        if mesh is land.mesh:
            return replace(minimum, fine=True)
        if mesh.breaks.size > _MOST_PANELS:
            return None
        finer = DiscreteEnergy(land.given, mesh, land.pace)
        below = next(_descents(finer, land.mesh.read(minimum.beta, mesh.nodes), 0), None)
        if below is None:
            return None
        minimum = below
    return None


def _descents(land: DiscreteEnergy, shape: Array, pushes: int) -> Iterator[EnergyMinimum]:
    """The minima below a shape: one, or those on both sides of a saddle that the way meets."""
    beta, power = land.meet(land.shape(shape), 2 * _MEETING), 0
    for _ in range(_ROUNDS):
        if beta is None or (slopes := land.slopes(beta)) is None:
            return
        energy = land.energy(beta)
        if not (np.isfinite(energy) and np.isfinite(slopes.curved.band).all()):
            return
        curved, power = _upward_curvature(land, slopes.curved, power)
        is_valley = power < 0
        step = curved.solve(-slopes.slope)
        size = float(np.abs(step).max())
        if is_valley and size < CLOSE:
            yield EnergyMinimum(land, energy, beta, slopes.reactions)
            return
        if not is_valley and size < _SADDLE:
            push = _PUSH * _downwards(land, curved)
            for way in (push, -push) if pushes else ():
                yield from _descents(land, land.move(beta, step + way), pushes - 1)
            return
        beta = _lower(land, beta, energy, step * min(1.0, LONGEST / size))


def _lower(land: DiscreteEnergy, beta: Array, energy: float, step: Array) -> Array | None:
    """The shape after a step, or after a part of it, that has no more energy; None where there is none."""
    for _ in range(_CUTS):
        new = land.meet(land.move(beta, step), _MEETING)
        if new is not None and land.energy(new) <= energy + FAINT * (1 + abs(energy)):
            return new
        step = step / 3
    return None


def _upward_curvature(land: DiscreteEnergy, curved: Bordered, power: int) -> tuple[Bordered, int]:
    """The curvature of the energy with the least power of 4 of `_SHIFT` times the metric added with which it curves
    upwards, and this power; -1 where it needs none.

    power: from where it is sought, as the next shape of a descent needs about the same.
    """

    @cache
    def curvature_with(power: int) -> Bordered:
        return curved.plus((-NEGLIGIBLE if power < 0 else _SHIFT * 4.0**power) * land.metric)

    if curvature_with(-1).negative == 0:
        return curvature_with(-1), -1
    power = max(power, 0)
    while curvature_with(power).negative != 0:
        power += 1
    while power > 0 and curvature_with(power - 1).negative == 0:
        power -= 1
    return curvature_with(power), power


def _downwards(land: DiscreteEnergy, shifted: Bordered) -> Array:
    """The direction in which the energy curves down the most, of size 1; shifted: of `_upward_curvature`."""
    lowest = np.cos(np.arange(shifted.band.shape[1]) ** 2)  # has a share of every direction
    for _ in range(_ITERATIONS):
        lowest = shifted.solve(times(land.metric, lowest))
        lowest /= np.abs(lowest).max()
    return lowest


def _pace(given: Given) -> float:
    """About the beta_t that the given loads make."""
    mu = given.number("mu", given.number("turn", 0.0) / (given.ratio * given.span))
    loads = abs(given.number("phi", 0.0)) + abs(given.number("lam", 0.0)) + 2 * abs(mu)
    return float(np.hypot(np.sqrt(1 + loads), TAU / given.span))


def taut_pace(given: Given) -> tuple[float, float]:
    """The pace k of a rod whose ends are nearly as far apart as it is long, 0 where no rod reaches; the chord's angle.

    Under a tension k^2 the angle decays like exp(-k t) from that of each clamped end to that of the chord; an end at an
    angle d to it shortens the rod along it by (4/k) sin(d/4)^2.
    """
    height, azimuth = given.number("z", 0.0), given.number("alpha", 0.0)
    short, chord = given.span - float(np.hypot(height, azimuth)), float(np.arctan2(azimuth, height))
    angles = np.array([given.number(name, 0.0) for name in FREE[:2] if name in given.names])
    bent = np.remainder(angles - chord + np.pi, TAU) - np.pi
    return 4 * float((np.sin(bent / 4) ** 2).sum()) / short if short > 0 else 0.0, chord


def simple_shapes(given: Given, u: Array, pace: float) -> list[Array]:
    """Shapes at shares u of the length (n,): angles that a rod with these ends may have, each with waves about it, and
    layers at clamped ends."""
    span = given.span
    ends = [given.number(name, np.nan) for name in FREE[:2]]
    angles, slack = _angles(given, [end for end in ends if np.isfinite(end)])
    size = float(np.clip(2 * np.sqrt(slack), 0.1, _WIDEST))
    pace = max(pace, TAU / span)
    decays = np.exp(-pace * span * u), np.exp(-pace * span * (1 - u))
    waves = [np.sin(k * np.pi * u) for k in (1, 2, 3)]
    if not np.isfinite(ends).all():
        waves = [np.sin((k - 0.5) * np.pi * (1 - u if np.isfinite(ends[1]) else u)) for k in (1, 2, 3)]
    if not np.isfinite(ends).any():
        waves = [np.cos(k * np.pi * u) for k in (1, 2, 3)]
    shapes = []
    for i, angle in enumerate(angles):
        layers = [(end - angle) * decay for end, decay in zip(ends, decays, strict=True) if np.isfinite(end)]
        plain = np.asarray(angle + sum(layers) + 0 * u)
        shapes += [plain, *(plain + sign * size * wave for wave in waves[: 3 if i == 0 else 1] for sign in (1, -1))]
    return shapes


def _angles(given: Given, ends: list[float]) -> tuple[list[float], float]:
    """Angles of a rod along which it lies, the likeliest first, and the share of the length by which it is slack."""
    z, alpha = (given.number(name, np.nan) / given.span for name in ("z", "alpha"))
    mean = float(np.mean(ends)) if ends else 0.0
    back = [mean + np.pi, mean - np.pi] if given.number("phi", 0.0) < 0 else []
    if np.isfinite(z) and np.isfinite(alpha):
        return [float(np.arctan2(alpha, z))], max(1 - float(np.hypot(z, alpha)), 0.0)
    if np.isfinite(z):
        helix = float(np.arccos(np.clip(z, -1, 1)))
        return [0.0 if z > 0 else np.pi, helix, -helix], max(1 - abs(z), 0.0)
    if np.isfinite(alpha):
        return [float(np.arcsin(np.clip(alpha, -1, 1))), *back], 0.2
    return [mean, *back], 0.2
