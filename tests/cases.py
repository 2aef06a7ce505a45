"""Named cases, each with its source; where the answer is known in closed form, with that answer.

`in_units_of_rho` makes a case of the dimensionless numbers: A = 1 and rho = 1 (within rounding), so that lengths,
forces and moments of the case are those numbers. Closed forms use special functions only, never a march.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from scipy.special import ellipj, ellipkinc, ellipkm1, elliprf

from solver import Case, Cylinder, Ends, Rod, Start

NOWHERE = ("neutral_at", "reach", "arriving_max")  # observables that no rod without weight and friction has
Shape = tuple[Any, Any, Any]  # beta [rad], alpha [rad], z [length] at given s


@dataclass(frozen=True)
class Named:
    """A case, where it comes from, and (where known) beta, alpha, z at any s (n,) in closed form."""

    name: str
    source: str
    case: Case
    exact: Callable[[Any], Shape] | None = None

    @property
    def L(self) -> float:
        return float(self.case.rod.L)


# making cases


def rod_of_unit_stiffness(L: Any, a: float = 0.25, nu: float = 0.25) -> Rod:
    """A = 1 within rounding."""
    return Rod(E=4 / (np.pi * a**4), nu=nu, a=a, L=L)


def cylinder_of(rho: float, a: float, side: str) -> Cylinder:
    """R such that the centreline is at rho."""
    return Cylinder(rho - a if side == "outside" else rho + a, side)


def start_of(rod: Rod, rho: Any, l: Any, m: Any, p: Any, beta: Any, dbeta: Any, **more: Any) -> Start:
    """The section force and twist rate at s = 0 that give MZ = A l, M3 = A m, FZ = A p."""
    A, s, c = rod.bending_stiffness, np.sin(beta), np.cos(beta)
    FY, FZ = A / rho * (l - m * c - s**3 / rho), A * p
    dgamma = m * (1 + rod.nu) - s * c / rho
    return Start(beta, dbeta, F2=FZ * s - FY * c, F3=FZ * c + FY * s, dgamma=dgamma, **more)


def in_units_of_rho(
    lam: Any, mu: Any, phi: Any, span: Any, beta0: Any, dbeta0: Any, side: str = "outside", **more: Any
) -> Case:
    """A start problem from its dimensionless numbers."""
    rod = rod_of_unit_stiffness(span)
    return Case(rod, cylinder_of(1.0, 0.25, side), start_of(rod, 1.0, lam, mu, phi, beta0, dbeta0, **more))


def ends_in_units_of_rho(lam: Any, mu: Any, phi: Any, span: Any, beta0: Any, betaL: Any, side: str = "outside") -> Case:
    """An ends problem from its dimensionless numbers."""
    rod = rod_of_unit_stiffness(span)
    A = rod.bending_stiffness
    return Case(rod, cylinder_of(1.0, 0.25, side), Ends(beta0, betaL, FZ=A * phi, MZ=A * lam, M3=A * mu))


# closed forms, in units of rho


def catenary(t: Any, beta0: float = np.pi / 6) -> Shape:
    """lam = mu = phi = eta = 0: beta_t = sin^2(beta), so cot(beta) falls by t."""
    u0 = 1 / np.tan(beta0)
    u = u0 - np.asarray(t)
    return np.arctan2(1, u), np.arcsinh(u0) - np.arcsinh(u), np.hypot(1, u0) - np.hypot(1, u)


def elliptic(t: Any, k: float = 0.25) -> Shape:
    """lam = mu = phi = 0, eta = -k^2, from rest at sin^2(beta) = k; cot(beta) = sqrt((1 - k)/k) cn.

    alpha and z are elliptic integrals of the first kind: alpha in Carlson's form, z with parameter 1/2.
    """
    m, n = (1 - k) / 2, 1 - k
    tau = np.sqrt(2 * k) * np.asarray(t, dtype=float)
    sn, cn, dn, _ = ellipj(tau, m)
    K = quarter_of_elliptic(k)
    halves = np.round(tau / (2 * K))
    sign = np.where(halves % 2 == 0, 1, -1)  # sn counted from the nearest half period
    whole = elliprf(0, 1 - m, 1 - n)
    part = sign * sn * elliprf(cn**2, dn**2, 1 - n * sn**2)
    alpha = (2 * halves * whole + part) / np.sqrt(2)
    z = ellipkinc(np.arcsin(np.sqrt(n) * sn), 0.5) / np.sqrt(2 * k)
    return np.arctan2(1, np.sqrt((1 - k) / k) * cn), alpha, z


def quarter_of_elliptic(k: float = 0.25) -> float:
    """K(m) with m = (1 - k)/2: a quarter period is K/sqrt(2 k)."""
    return float(ellipkm1((1 + k) / 2))


def helix(beta0: float) -> Callable[[Any], Shape]:
    """H(beta0) = 0 and no slope: the angle stays."""

    def exact(t: Any) -> Shape:
        t = np.asarray(t, dtype=float)
        return np.full_like(t, beta0), np.sin(beta0) * t, np.cos(beta0) * t

    return exact


def helix_moment(beta: float, mu: float, phi: float) -> float:
    """lam with H(beta) = 0."""
    s, c = np.sin(beta), np.cos(beta)
    return float((mu * np.cos(2 * beta) + (phi + 2 * c * s * s) * s) / c)


def pendulum_quarter(kp: float) -> float:
    """K of modulus k, by its complement kp, times sqrt|p|."""
    return float(ellipkm1(kp**2))


# the exact cases


def _catenary() -> Named:
    b = np.pi / 6
    return Named("catenary", "7, row 1", in_units_of_rho(0, 0, 0, 20.0, b, np.sin(b) ** 2), catenary)


def _elliptic(k: float, span: float) -> Named:
    case = in_units_of_rho(0, 0, 0, span, np.arcsin(np.sqrt(k)), 0.0)
    return Named(f"elliptic k={k:g} L={span:g}", "7, row 2", case, lambda t: elliptic(t, k))


def _helix(name: str, beta: float, mu: float, phi: float, span: float = 20.0, side: str = "outside") -> Named:
    case = in_units_of_rho(helix_moment(beta, mu, phi), mu, phi, span, beta, 0.0, side)
    return Named(f"helix {name}", "7, row 3", case, helix(beta))


def _lubinski(degrees: float) -> Named:
    b = np.deg2rad(degrees)
    case = in_units_of_rho(0, 0, -2 * np.sin(b) ** 2 * np.cos(b), 20.0, b, 0.0, "inside")
    return Named(f"buckled pipe {degrees:g} deg", "7, row 4", case, helix(b))


def large_cylinder(kp: float, rho: float = 1e8, periods: float = 1.2) -> Case:
    """A rod in tension A on a nearly flat surface, at rest 2 asin(kp) from the pull: a planar elastica with loops.

    The saddle is at beta = 0, where a float holds the smallest gap; the swing is about beta = pi.
    """
    b, a = 2 * np.arcsin(kp), 0.25
    rod = rod_of_unit_stiffness(4 * periods * pendulum_quarter(kp), a)
    A = rod.bending_stiffness
    start = Start(b, 0.0, F2=A * np.sin(b), F3=A * np.cos(b), dgamma=-(np.sin(b) * np.cos(b)) / rho)
    return Case(rod, cylinder_of(rho, a, "outside"), start)


EXACT: dict[str, Named] = {
    named.name: named
    for named in (
        _catenary(),
        _elliptic(0.25, 20.0),
        _elliptic(0.25, 300.0),
        _elliptic(0.01, 60.0),
        _elliptic(0.9, 60.0),
        _helix("at a centre", 1.1, 0.9, -0.4),
        _helix("at a centre, inside", 0.7, 0.5, -0.9, side="inside"),
        _helix("at a saddle", 1.1, 0.4, 0.2),
        _helix("at a steep saddle", 0.4, -0.3, 0.1),
        _helix("straight, in tension", 0.0, 0.0, 0.2),
        _helix("straight, in compression", 0.0, 0.0, -0.2),
        _lubinski(1),
        _lubinski(10),
        _lubinski(30),
        _lubinski(70),
    )
}

# (case, s, what, figures): numbers as printed in section 7, each to all digits that a float holds
FIGURES = (
    ("catenary", 20.0, "beta", 3.08690655094805337),
    ("catenary", 20.0, "alpha", 4.91600148673304332),
    ("catenary", 20.0, "z", -16.2952990600658099),
    ("elliptic k=0.25 L=20", 1.0, "beta", 0.64150783932762322),
    ("elliptic k=0.25 L=20", 5.0, "beta", 2.6179490048622924),
    ("elliptic k=0.25 L=20", 20.0, "beta", 0.524317117841891221),
    ("elliptic k=0.25 L=20", 20.0, "alpha", 13.9907069662832906),
    ("elliptic k=0.25 L=20", 20.0, "z", 0.0705173405892741653),
)
ELLIPTIC_PERIOD = 9.95928116439593122
PENDULUM_PERIODS = {1e-3: 33.176205854462, 1e-6: 60.807219676351, 1e-9: 88.438240792265}
LUBINSKI = {1: 0.99954, 10: 0.95511, 30: 0.64952}
MITCHELL = {1: 1.00030, 10: 1.03109, 30: 1.33333}


# Table 1 and its twelve readings

READINGS = tuple(product(("force-first", "twist-first", "shear"), ("tension", "compression"), ("paper", "solid")))


def table_1(twist: str, load: str, stiffness: str, side: str = "outside", L: float = 20.0) -> Case:
    """Table 1 under one reading, in cm and N; it prints gamma0' and F10, of which one is too many, and no F20."""
    given: dict[str, Any] = {"F1": 5.0} if twist == "force-first" else {"dgamma": 0.5}
    if twist == "shear":
        given["F2"] = 5.0
    start = Start(np.pi / 6, 0.5, F3=10.0 if load == "tension" else -10.0, gamma=-0.1, **given)
    return Case(Rod(1.07e4, 0.25, 0.25, L, stiffness), Cylinder(0.75, side), start)


TABLE_1: dict[str, Named] = {
    "/".join(reading): Named("/".join(reading), "Table 1", table_1(*reading)) for reading in READINGS
}


# orbits of every kind, without a closed form


def _general(name: str, source: str, *numbers: float, **more: Any) -> Named:
    return Named(name, source, in_units_of_rho(*numbers, **more))


GENERAL: dict[str, Named] = {
    named.name: named
    for named in (
        _general("compressed, symmetric", "lam = mu = 0", 0, 0, -0.7, 20, 0.3, 0.2),
        _general("compressed, through the axis", "lam = mu = 0", 0, 0, -0.3, 30, 0.0, 0.4),
        _general("pulled, symmetric", "lam = mu = 0", 0, 0, 0.4, 20, 1.2, 0.0),
        _general("about the hoop", "mu = phi = 0", 0.2, 0, 0, 20, 1.3, 0.1),
        _general("many equilibria", "section 5", -0.3655, 0.7464, -0.7506, 20, np.pi / 6, 1.0),
        _general("going round", "rotation", 0.3, 0.2, 0.1, 20, 0.5, 2.5),
        _general("going round backwards", "rotation", 0.3, 0.2, 0.1, 20, 0.5, -2.5),
        _general("from a far angle", "beta0 several turns up", 0.3, 0.2, 0.1, 15, 20.0, -0.4, alpha=1.0),
        _general("strongly twisted", "mu large", 2.0, 6.0, -3.0, 15, 0.8, 0.3),
        _general("inside, twisted", "a pipe", 0.1, 0.5, -1.5, 20, 0.2, -0.1, side="inside"),
        _general("nearly straight", "small angle", 0, 0, -1.0, 20, 1e-5, 0.0),
        _general("long", "L = 150", 0.2, 0.1, -0.5, 150, 0.7, 0.3),
    )
}

GAPS = (1e-2, 1e-4, 1e-6, 1e-9)


def turning_before_saddle(gap: float, twist: float = 0.0) -> Case:
    """At rest `gap` from the saddle at beta = 0 (lam = mu, phi = 1): librates, lingering there once a period."""
    return in_units_of_rho(twist, twist, 1.0, 25.0 if gap < 1e-5 else 20.0, gap, 0.0)


def passing_saddle(gap: float, twist: float = 0.0) -> Case:
    """Crosses that saddle at the speed `gap`: goes round, lingering there once a turn."""
    return in_units_of_rho(twist, twist, 1.0, 25.0 if gap < 1e-5 else 20.0, 0.0, gap)


MU_C = (2 * np.sqrt(2) - 1) / 4  # phi = 1/4: the separatrix through 0 touches the level at 135 degrees


def by_the_touching_separatrix(factor: float, beta0: float = 0.5) -> Case:
    """lam = mu = factor MU_C, phi = 1/4, eta = 2 phi but for rounding, moving up from beta0."""
    mu, phi = factor * MU_C, 0.25
    s, c = np.sin(beta0), np.cos(beta0)
    G = (2 * mu * (1 - c) - s**3) * s + 2 * phi * c
    return in_units_of_rho(mu, mu, phi, 20.0, beta0, np.sqrt(2 * phi - G))


NEAR_SEPARATRIX: dict[str, Named] = {
    named.name: named
    for named in (
        *(Named(f"turning {gap:g} before a saddle", "gap", turning_before_saddle(gap)) for gap in GAPS),
        *(Named(f"passing a saddle at {gap:g}", "gap", passing_saddle(gap)) for gap in GAPS),
        Named("turning 1e-6 before a twisted saddle", "gap", turning_before_saddle(1e-6, 0.3)),
        Named("passing a twisted saddle at 1e-6", "gap", passing_saddle(1e-6, 0.3)),
        Named("just turning at 135 degrees", "7, last row", by_the_touching_separatrix(1 + 1e-5)),
        Named("just passing 135 degrees", "7, last row", by_the_touching_separatrix(1 - 1e-5)),
    )
}

# every start problem, whatever is known about it
START: dict[str, Named] = {**EXACT, **TABLE_1, **GENERAL, **NEAR_SEPARATRIX}


def random_rods(count: int, seed: int, reach: float = 30.0) -> Case:
    """Loads of all sizes, from slack to taut, on rods of a part of a bend to a few dozen."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-2, 1, count)
    lam, mu, phi = rng.normal(size=(3, count)) * size
    swift = np.sqrt(np.abs(lam) + np.abs(mu) + np.abs(phi) + 1)
    span = rng.uniform(0.3, reach, count) / swift
    return in_units_of_rho(lam, mu, phi, span, rng.uniform(-3.1, 3.1, count), rng.normal(size=count) * swift)
