"""The misprints of eqs. (13), (14) and (16): what is printed breaks a law that what is right keeps, to rounding."""

from pathlib import Path

import numpy as np
import pytest

from solver.orbits.frames import material

ANGLES = np.random.default_rng(13).uniform(-np.pi, np.pi, (100, 3))  # alpha, beta, gamma
RATES = np.random.default_rng(14).uniform(-1, 1, (100, 3))


def frame(alpha: float, beta: float, gamma: float, sign: float = 1.0) -> np.ndarray:
    """Eq. (13): columns e1, e2, e3 in the fixed axes; sign: that of the second term of row 2, column 2."""
    ca, sa, cb, sb, cc, sc = (f(x) for x in (alpha, beta, gamma) for f in (np.cos, np.sin))
    return np.array(
        [
            [ca * cc - cb * sa * sc, -ca * sc - cb * sa * cc, sb * sa],
            [sa * cc + cb * ca * sc, -sa * sc + sign * cb * ca * cc, -sb * ca],
            [sb * sc, sb * cc, cb],
        ]
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_frame_of_eq_13_is_orthonormal_with_a_plus_in_row_2_column_2_and_not_as_printed(sign: float) -> None:
    off = [np.abs(frame(*angles, sign).T @ frame(*angles, sign) - np.eye(3)).max() for angles in ANGLES]
    if sign > 0:
        assert max(off) < 1e-15  # rounding
        assert all(np.linalg.det(frame(*angles)) == pytest.approx(1, abs=1e-15) for angles in ANGLES)
    else:
        assert np.median(off) > 0.1


def test_the_frame_of_eq_13_put_right_is_the_section_s_own() -> None:
    for alpha, beta, gamma in ANGLES:  # the paper counts alpha from the inward normal, half a turn away
        ours = material(*(np.asarray(x) for x in (alpha + np.pi, beta, gamma)))
        np.testing.assert_allclose(frame(alpha, beta, gamma).T, ours, atol=1e-15)


@pytest.mark.parametrize("factor", ["sin beta sin gamma", "as printed"])
def test_the_rotation_of_eq_14_is_that_of_the_frame_with_the_factor_that_row_1_lost(factor: str) -> None:
    off = []
    for angles, rates in zip(ANGLES, RATES, strict=True):
        step = 1e-5
        change = (frame(*(angles + step * rates)) - frame(*(angles - step * rates))) / (2 * step)
        e1, e2, e3 = frame(*angles).T
        found = np.array([change[:, 1] @ e3, change[:, 2] @ e1, change[:, 0] @ e2])  # eq. (5)
        (_, beta, gamma), (da, db, dc) = angles, rates
        lost = np.sin(beta) * np.sin(gamma) if factor != "as printed" else 1.0
        told = [
            da * lost + db * np.cos(gamma),
            da * np.sin(beta) * np.cos(gamma) - db * np.sin(gamma),
            da * np.cos(beta) + dc,
        ]
        off.append(np.abs(found - told).max())
    if factor == "as printed":
        assert np.median(off) > 0.1
    else:
        assert max(off) < 1e-9  # step^2 of a central difference, and rounding over the step


@pytest.mark.parametrize("third", ["zeta", "xi, as printed"])
def test_the_push_of_eq_16_has_no_part_along_the_rod_with_the_derivative_by_zeta_and_not_as_printed(third: str) -> None:
    """On the cylinder g = xi^2 + eta^2 - R^2, of which eq. (15) makes (xi, eta) = -R (cos alpha, sin alpha)."""
    along = []
    for alpha, beta, gamma in ANGLES:
        dxi, deta, dzeta = -2 * np.cos(alpha), -2 * np.sin(alpha), 0.0
        push = np.array([dxi, deta, dzeta if third == "zeta" else dxi]) @ frame(alpha, beta, gamma)
        along.append(abs(push[2]))
    assert max(along) < 1e-15 if third == "zeta" else np.median(along) > 0.1


def test_the_report_and_the_page_list_these_misprints() -> None:
    root = Path(__file__).parents[2]
    page = (root / "docs" / "explanation" / "physics.md").read_text(encoding="utf-8").partition("## 11. Errata")[2]
    report = (root / "workbench" / "paper" / "errata.html").read_text(encoding="utf-8")
    for number in ("(13), row 2, column 2", "(14), row 1", "(16), third"):
        assert f"| {number}" in page
        assert f"eq.&nbsp;{number}" in report
