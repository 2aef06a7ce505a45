"""The loads at which a long horizontal pipe changes its state, and a string about its neutral point, from `solve`."""

import numpy as np
import pytest

from benchmarks.pipe_events import HELIX, SINUSOID, HalfWave, energy, events, push_min, wave_number
from solver import Case, Cylinder, Ends, Rod, solve


@pytest.mark.slow
def test_the_six_events_of_a_long_horizontal_pipe() -> None:
    expected = [2.0, 2.744687, 2.790434, 2.901122, 3.541672, 5.2613]
    digits = [1e-6] * 5 + [5e-5]
    for found, value, within in zip(events().values(), expected, digits, strict=True):
        assert found == pytest.approx(value, abs=within)


def test_helix_and_sinusoid_of_a_long_pipe_have_equal_energy_at_one_load() -> None:
    sinusoid, helix = HalfWave(SINUSOID).best(2.901122), HalfWave(HELIX).best(2.901122)
    assert energy(sinusoid, 2.901122) == pytest.approx(energy(helix, 2.901122), abs=2e-6)
    assert [wave_number(sinusoid), wave_number(helix)] == pytest.approx([0.97200, 1.18620], abs=1e-4)
    assert np.abs(HalfWave(SINUSOID).shape(2.901122, wave_number(sinusoid)).alpha).max() == pytest.approx(
        0.8688, abs=1e-4
    )
    assert min(push_min(sinusoid), push_min(helix)) > 0
    assert sinusoid.held_index == helix.held_index == 0


def test_a_long_string_passes_its_neutral_point_as_painleve_says() -> None:
    """Hastings and McLeod's solution of u'' = x u + 2 u^3 has u(0) = 0.3670615515."""
    weight, below, above = 1e-12, 14.0, 10.0  # w rho^3/A, and lengths in (A/w)^(1/3)
    size = weight ** (1 / 3)
    rod = Rod(EI=1.0, GJ=1.0, a=0.1, L=(below + above) / size, weight=weight)
    ends = Ends(M10=0.0, betaL=0.0, FZ=above * size**2)
    sol = solve(
        Case(rod, Cylinder(R=1.1, side="inside", inclination=0.0), ends), stations=np.array([0.0, below / size])
    )
    assert sol.solved
    assert abs(sol.beta[1]) / size == pytest.approx(0.3670615515, rel=1e-6)
