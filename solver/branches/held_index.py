"""The Morse index and the energy of an equilibrium under the ends that are meant.

Under the loads of an equilibrium the second variation is that of eta'' + H' eta = 0 with eta = 0 where the angle is
given and eta' = 0 where a moment is. Let eta be the solution that meets the condition at the start. Its phase, the
angle of (eta', eta) in the plane, counts the negative directions when it is compared with the condition at the far end.
beta_t solves the same equation, and its phase is known from the turning points that the rod passes; the phases of two
solutions never differ by more than half a turn. So the index is exact where the rod rests at both ends too.

Where a displacement is held instead of its load, directions are excluded: the index falls by the number of negative
eigenvalues of the block of the compliance d(z, alpha, gamma)/d(phi, lam, mu), at these ends, that belongs to the held
displacements.
"""

import numpy as np

from ..numerics.arrays import DOUBTFUL, NEGLIGIBLE, Array
from ..orbits.path_orbits import energies, orbit_of
from ..orbits.periodic_orbit import helix_half_waves
from ..orbits.potential import load_size, potential, slope_rate
from .given_numbers import ANGLES, Given, OrbitState
from .orbit_rates import NUMBERS, OrbitRates

_RESTS = 1e-7  # beta_t at both ends of a rod that rests at both, in units of the loads. x10: slow starts have no index


def held_index(rates: OrbitRates, ratio: Array, names: tuple[str, ...], leaving: Array, turns: Array) -> Array:
    """The index of B equilibria that are no helices under held ends, (B,) of floats; NaN where it is not decided.

    names: the five given numbers (`problem.dimensionless.HeldProblem.numbers`). leaving, turns: (B,), of their paths.
    """
    ends, compliance = _compliance_of(rates, ratio, names)
    index = dead_index(rates, leaving, turns, ends) - negative(compliance)
    return np.where(index < 0, np.nan, index)  # a rod next to a saddle for so long has no digit of its compliance


def _compliance_of(rates: OrbitRates, ratio: Array, names: tuple[str, ...]) -> tuple[tuple[str, ...], Array]:
    """The two given numbers of the ends, and the block of the compliance of the k held displacements, (B, k, k)."""
    ends = tuple(name for name in names if name.endswith(ANGLES))
    held = [k for k, name in enumerate(("z", "alpha", "turn")) if name in names]  # in the order of `compliance`
    if not held:
        return ends, np.empty((len(rates.values), 0, 0))
    return ends, rates.compliance(ratio, ends)[:, held][:, :, held]


def dead_index(rates: OrbitRates, leaving: Array, turns: Array, ends: tuple[str, ...] = ANGLES) -> Array:
    """The Morse index under dead loads, with two given numbers of the ends."""
    passed = half_turns(rates, leaving, turns, ends)
    index = np.maximum(np.ceil(passed), 0.0)
    with np.errstate(invalid="ignore"):
        # where the phase is nearer to the condition at the far end, in half turns, the index is not decided
        return np.where(np.abs(passed - np.round(passed)) > NEGLIGIBLE, index, np.nan)


def half_turns(rates: OrbitRates, leaving: Array, turns: Array, ends: tuple[str, ...]) -> Array:
    """By how many half turns the phase passes the condition at the far end, (B,): a whole number at a fold under dead
    loads."""
    unit = np.sqrt(1 + load_size(rates.problem))  # of beta_t
    beta0, betaL, v0, vL = (rates.rows[:, NUMBERS.index(name), :2] for name in (*ANGLES, "dbeta0", "dbetaL"))
    arriving = np.where(turns % 2 == 0, leaving, -leaving)
    with np.errstate(all="ignore"):
        start = v0 if ends[0] == "dbeta0" else beta0
        start = start / np.abs(start).max(axis=1, keepdims=True)
        mix = np.stack([start[:, 1], -start[:, 0]], axis=1)  # of the flow and the level: meets the condition
        mix /= np.maximum(np.abs(beta0 * mix), np.abs(v0 * mix) / unit[:, None]).max(axis=1, keepdims=True)
        at_ends = (beta0, v0 / unit[:, None]), (betaL, vL / unit[:, None])
        begun, ended = _phases(*at_ends, mix, (leaving, arriving), turns)
        half = 0.5 if ends[0] == "dbeta0" else 0.0
        whole = np.round(begun / np.pi - half)
        return np.asarray(ended / np.pi - whole - (0.5 if ends[1] == "dbetaL" else 1.0))


def _phases(
    start: tuple[Array, Array], far: tuple[Array, Array], mix: Array, ways: tuple[Array, Array], turns: Array
) -> tuple[Array, Array]:
    """The phases at the two ends, (B,), of what `mix` (B, 2) makes of the flow and of the level.

    start, far: what these add to beta and to beta_t in some unit, (B, 2) each. ways: of beta_t at the two ends.
    """
    phases = []
    for (value, rate), way, passed in zip((start, far), ways, (0 * turns, turns), strict=True):
        v, H = np.abs(value[:, 0]), rate[:, 0] * way
        eta, slope = (mix * value).sum(axis=1) * way, (mix * rate).sum(axis=1) * way
        across, along = eta * H - slope * v, eta * v + slope * H
        phases.append((np.arctan2(v, H) + np.pi * passed, across, along))
    side = np.where(phases[0][1] != 0, np.sign(phases[0][1]), np.sign(phases[0][2]))
    end_phases = []
    for phase, across, along in phases:
        apart = np.arctan2(side * across, side * along)
        end_phases.append(phase + np.clip(np.where(apart < -np.pi / 2, apart + 2 * np.pi, apart), 0, np.pi))
    return end_phases[0], end_phases[1]


def negative(matrix: Array) -> Array:
    """The number of negative eigenvalues of symmetric matrices (B, n, n), (B,); NaN where one is zero to rounding."""
    out = np.full(matrix.shape[0], np.nan)
    for b in np.flatnonzero(np.isfinite(matrix).all(axis=(1, 2))):
        values = _eigenvalues_in_scale(matrix[b])
        if np.abs(values).min(initial=np.inf) > DOUBTFUL * np.abs(values).max(initial=0):
            out[b] = np.count_nonzero(values < 0)
    return out


def _eigenvalues_in_scale(matrix: Array) -> Array:
    """The eigenvalues of a symmetric matrix (n, n) whose rows and columns are scaled, (n,)."""
    scale = 1 / np.sqrt(np.maximum(np.abs(matrix).max(axis=1, initial=0), 1e-300))
    scaled = matrix * scale * scale[:, None]
    return np.linalg.eigvalsh((scaled + scaled.T) / 2)


def index_of(state: OrbitState, wanted: Given) -> float:
    """The Morse index under the held ends; NaN where it is not decided."""
    if state.known_index is not None:
        return float(state.known_index)
    ratio, path = np.array([wanted.ratio]), state.path
    if not path.helix:
        each = np.array([path.leaving]), np.array([path.turns])
        return float(held_index(state.rates, ratio, wanted.names, *each)[0])
    ends, compliance = _compliance_of(state.rates, ratio, wanted.names)
    return _helix_index(state, ends) - float(negative(compliance)[0])


def held_energy(state: OrbitState, wanted: Given) -> float:
    """The bending and twist energy less the work of the loads and end moments that are given, in units of A/rho.

    A reaction does no work when neighbouring shapes with the same held ends are compared.
    """
    problem, number = state.problem, {name: float(state.rates.value(name)[0]) for name in NUMBERS}
    energy, mu = state.known_energy, number["mu"]
    if energy is None:
        level = number["dbeta0"] ** 2 + potential(problem, problem.beta0)
        energy = float(energies(orbit_of(problem, state.path), level)[0])
    twist = wanted.ratio * mu**2 * wanted.span / 2
    energy += twist - mu * number["swirl"] if "turn" in wanted.names else -twist
    works = (("phi", "z"), ("lam", "alpha"))
    energy += sum(number[load] * number[held] for load, held in works if held in wanted.names)
    moments = (("dbeta0", "beta0", 1), ("dbetaL", "betaL", -1))
    return energy + sum(sign * wanted.number(given, 0.0) * number[angle] for given, angle, sign in moments)


def lower_index(state: OrbitState, wanted: Given) -> int:
    """The lower Morse index of the two equilibria that meet at a fold under the held ends; 0 where it is not decided.

    Under dead loads the phase meets the condition at the far end there. With held displacements an eigenvalue of the
    compliance passes through zero, and so one direction more is excluded on one side.
    """
    ends, compliance = _compliance_of(state.rates, np.array([wanted.ratio]), wanted.names)
    passed = float(half_turns(state.rates, np.array([state.path.leaving]), np.array([state.path.turns]), ends)[0])
    if not (np.isfinite(passed) and np.isfinite(compliance).all()):
        return 0
    if not compliance.size:
        return max(int(np.round(passed)), 0)
    values = _eigenvalues_in_scale(compliance[0])
    excluded = np.count_nonzero(np.delete(values, np.abs(values).argmin()) < 0) + 1
    return max(int(np.ceil(passed)) - int(excluded), 0)


def _helix_index(state: OrbitState, ends: tuple[str, ...]) -> float:
    """The index of a helix under dead loads: the waves of constant length between its ends that are too long."""
    rate = float(slope_rate(state.problem, state.problem.beta0)[0])
    hinges = sum(name.startswith("d") for name in ends)
    if rate <= 0:
        return 0.0 if rate < 0 or hinges < 2 else np.nan
    waves = float(helix_half_waves(state.problem)[0]) + hinges / 2 - 1
    return np.nan if abs(waves - np.round(waves)) < NEGLIGIBLE else max(float(np.ceil(waves)), 0.0)


def dead_index_of(state: OrbitState) -> float:
    """The Morse index under dead loads between its own end angles; NaN where it is not decided."""
    if state.path.helix:
        return _helix_index(state, ANGLES)
    rates, pace = state.rates, np.sqrt(1 + load_size(state.problem))
    if (np.maximum(np.abs(rates.value("dbeta0")), np.abs(rates.value("dbetaL"))) < _RESTS * pace).all():
        return np.nan  # beta_t itself is a direction of no stiffness
    return float(dead_index(state.rates, np.array([state.path.leaving]), np.array([state.path.turns]))[0])
