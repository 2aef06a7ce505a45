"""Published numbers and claims, each with its source; docs/explanation/claims.md lists the verdicts.

"Read in" names the text that was read. "Derived" marks a limit that was derived here, not quoted. Lubinski's pitch and
Mitchell's push are in `test_limits` and `test_selection`, the separatrix of a twisted rod in `test_limits`.
"""

from math import pi

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, solve
from tests.cases import helix_moment, in_units_of_rho
from tests.laws.test_loops import about, closed

NM_OF_BASE_PAIR = 0.34  # the rise per base pair of DNA [nm], as read below


# Vazquez-Montejo, McDargh, Deserno, Guven, Cylindrical confinement of semiflexible polymers (2015), arXiv:1503.01023:
# the abstract was read. Their n is our number of folds, their p our number of wraps; E0 = pi A/rho. The text that was
# read lost p = 1 and p = 2, n = 1 in the sentences on exterior states; they are filled in here.


@pytest.mark.parametrize(
    ("wraps", "folds"), [(1, 1), pytest.param(1, 2, marks=pytest.mark.slow), pytest.param(2, 1, marks=pytest.mark.slow)]
)
def test_short_loops_have_the_energy_of_their_wraps_and_long_ones_that_of_their_folds(wraps: int, folds: int) -> None:
    short = about(closed(2 * pi * wraps * 1.0001, wraps, folds), 1)
    long, longer = (about(closed(L, wraps, folds), 1) for L in (200.0, 400.0))
    assert short.energy == pytest.approx(pi * wraps, rel=1e-3)
    assert long.energy == pytest.approx(pi * folds, rel=0.02)
    assert abs(longer.energy - pi * folds) < abs(long.energy - pi * folds)
    assert abs(longer.lam) < abs(long.lam) < 0.01  # "in long loops the axial torque vanishes"


@pytest.mark.parametrize("L", [6.5, 50.0])
def test_the_ground_state_of_a_loop_has_one_fold(L: float) -> None:
    energies = [about(closed(L, 1, folds), 1).energy for folds in (1, 2, 3)]
    assert energies == sorted(energies)


@pytest.mark.parametrize("L", [6.5, 12.0, 40.0])
@pytest.mark.parametrize("folds", [2, 3])
def test_a_loop_of_several_folds_is_unstable_at_every_length(L: float, folds: int) -> None:
    """They: initially unstable, but "above a critical length each n-fold state becomes stable". The second is not so.

    By Sturm's theorem changes that come back after several periods, not after one, have 2 (folds - 1) negative
    eigenvalues. `test_loops.test_a_loop_of_two_folds_unfolds_into_one` minimises the energy from such a change.
    """
    assert about(closed(L, 1, folds), 1).index >= 2 * (folds - 1)


@pytest.mark.parametrize("L", [6.5, 40.0])
def test_a_loop_of_one_wrap_is_pulled_somewhere_outside(L: float) -> None:
    """They: exterior bound states with p = 1 are all unstable if free to unbind, as the contact force reverses."""
    for folds in (1, 2):
        assert about(closed(L, 1, folds), 1).push_min < 0


def test_a_short_loop_of_two_wraps_constricts_the_cylinder_and_a_longer_one_unbinds_in_part() -> None:
    """They: a short exterior loop of two wraps is a stable constriction, "partially unbinding as the length grows"."""
    short, longer = (about(closed(L, 2, 1), 1) for L in (13.0, 20.0))
    assert short.index == 0
    assert short.attached == pytest.approx(1, abs=1e-12)
    assert short.push_min > 0.5  # of A/rho^3; 0.75 at the ring
    assert longer.push_min < 0


# DNA on a histone


def dna(pitch: float = 2.39, rho: float = 4.18) -> Case:
    """147 base pairs in a helix, held by the axial moment alone; A = 207 pN nm^2 (50 nm times kT = 4.14 pN nm)."""
    beta = float(np.arctan2(2 * pi * rho, pitch))
    A, a = 207.0, 1.0
    FY = A / rho**2 * (helix_moment(beta, 0.0, 0.0) - np.sin(beta) ** 3)
    rod = Rod(EI=A, GJ=A, a=a, L=147 * NM_OF_BASE_PAIR)
    return Case(rod, Cylinder(R=rho - a), Start(beta, 0.0, F2=-FY * np.cos(beta), F3=FY * np.sin(beta), M3=0.0))


def test_dna_on_a_histone_makes_more_turns_than_are_often_quoted() -> None:
    """147 base pairs of 0.34 nm on a helix of radius 4.18 nm and pitch 2.39 nm make 1.90 turns.

    Read: 1.84 turns (Mohammad-Rafiee and Golestanian, arXiv:q-bio/0701014) and 1.67 turns (tutorials). Not read: the
    radius and the pitch, which go with the second number. The same length on 1.67 turns would need a rise of 0.30 nm.
    """
    sol = solve(dna(), stations=3)
    turns = float(sol.alpha[-1]) / (2 * pi)
    assert turns == pytest.approx(1.895, abs=1e-3)
    assert turns == pytest.approx(1.84, rel=0.04)
    assert turns / 1.67 - 1 == pytest.approx(0.135, abs=0.005)
    assert float(sol.z[-1]) / turns == pytest.approx(2.39, rel=1e-9)


def test_the_loads_that_hold_dna_on_a_histone() -> None:
    """Derived: without axial force and twist a helix needs lam = 2 sin^3(beta); its push is A sin^4(beta)/rho^3."""
    case = dna()
    sol = solve(case, stations=3)
    s, rho, A = float(np.sin(sol.beta[0])), 4.18, 207.0
    assert float(sol.FZ) == pytest.approx(0, abs=1e-12)
    assert float(sol.MZ) == pytest.approx(2 * A / rho * s**3, rel=1e-9)
    assert float(sol.MZ) == pytest.approx(97.8, abs=0.1)  # pN nm
    assert float(sol.push[0]) == pytest.approx(A * s**4 / rho**3, rel=1e-9)
    assert float(sol.push[0]) == pytest.approx(2.79, abs=0.01)  # pN/nm: with this moment it constricts the histone


# Pipes in boreholes: weight and inclination are not in the model


def test_the_helical_load_of_a_heavy_pipe_is_where_the_wall_pushes_with_twice_the_weight() -> None:
    """Ghalambor and Guo (2005), eqs. 24 and 25, read: sinusoidal 2 (EI w/r)^(1/2), helical 2.828 (EI w/r)^(1/2).

    They are from Chen, Lin and Cheatham. Derived here: a weightless buckled pipe under the second load is pushed with 2
    w, exactly so as its angle becomes small.
    """
    beta = np.deg2rad(0.5)
    sol = solve(in_units_of_rho(0, 0, -2 * np.sin(beta) ** 2 * np.cos(beta), 10.0, beta, 0.0, side="inside"))
    force = -float(sol.FZ)
    weight = force**2 * 1.0 / (2.828**2 * float(sol.case.rod.bending_stiffness))  # at which this force is helical
    assert float(sol.push[0]) == pytest.approx(2 * weight, rel=1e-3)


# Thompson, Silveira, van der Heijden and Wiercigroch, Proc. R. Soc. A 468, 1591 (2012): the abstract was read; it has
# no number. The limits are derived.


@pytest.mark.parametrize(("tension", "twist"), [(1.0, 3.0), (1.0, 1.0), (-1.0, 0.5), (0.0, 2.0)])
def test_a_slender_helix_pushes_by_the_polynomial_of_greenhill(tension: float, twist: float) -> None:
    """f = k^2 rho (A k^2 - M3 k + FZ) as rho becomes small: no contact where k is a root, so M3^2 >= 4 A FZ."""
    k, rho = 0.8, 1e-3
    beta = float(np.arctan(k * rho))
    mu, phi = twist * rho, tension * rho**2
    sol = solve(in_units_of_rho(helix_moment(beta, mu, phi), mu, phi, 10.0, beta, 0.0), stations=3)
    expected = k**2 * (k**2 - twist * k + tension)
    A = float(sol.case.rod.bending_stiffness)
    assert float(sol.contact[0]) / A / rho**4 == pytest.approx(expected, rel=1e-5, abs=1e-5)  # beta^2 is 6e-7


def test_one_twist_per_wave_keeps_the_same_side_of_the_rod_on_the_wall() -> None:
    """The section turns once a wave where M3 = C k: then gamma is constant, to first order exactly sin cos/rho."""
    beta = 0.02
    rho_units = in_units_of_rho(0, 0, 0, 10.0, beta, 0.0)
    ratio = float(rho_units.rod.torsional_stiffness / rho_units.rod.bending_stiffness)
    mu = ratio * np.sin(beta) * np.cos(beta)
    sol = solve(in_units_of_rho(helix_moment(beta, mu, -0.1), mu, -0.1, 30.0, beta, 0.0), stations=5)
    np.testing.assert_allclose(sol.gamma, sol.gamma[0], atol=1e-12)


# Dayan, Durban and Givli, J. Appl. Mech. 89, 111002 (2022): a clamped fibre in a rigid cylinder. The abstract was read,
# which has no number. The limits are derived, with dead loads and the angle held at 0 at both ends.


@pytest.mark.parametrize("waves", [1, 2])
def test_the_force_of_a_buckled_fibre_rises_with_its_shortening(waves: int) -> None:
    """F = Fc + (Fc/2 + 6 A/rho^2) shortening/L, Fc = waves^2 pi^2 A/L^2: 1/2 of the elastica, 6 of the cylinder."""
    L = 5.0
    critical = (waves * pi / L) ** 2
    forces = []
    for amplitude in (0.02, 0.04):
        low, high = critical, critical + 10 * amplitude**2
        for _ in range(60):
            phi = (low + high) / 2
            orbit = solve(in_units_of_rho(0, 0, -phi, L, amplitude, 0.0), tol=1e-12, stations=2).trajectory.orbit
            low, high = (phi, high) if orbit.period[0] > 2 * L / waves else (low, phi)
        start = solve(in_units_of_rho(0, 0, -phi, L, amplitude, 0.0), tol=1e-12, stations=[0.0, L / waves])
        shortening = 1 - float(start.z[-1]) * waves / L  # crest to crest, as node to node
        forces.append((phi - critical) / shortening)
    limit = (4 * forces[0] - forces[1]) / 3  # the next term is of the square of the amplitude
    assert limit == pytest.approx(critical / 2 + 6, rel=1e-3)  # the one after it, of its fourth power
