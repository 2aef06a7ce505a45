"""Fits: the derivatives, values that are known, intervals that hold, and what the data cannot tell."""

from math import pi

import numpy as np
import pytest
from scipy.optimize import brentq, curve_fit

from solver import Case, Cylinder, Ends, Rod, Start, fit, observe, solve
from solver.fits.data import check_data
from solver.fits.model import Model
from solver.fits.parameters import check_parameters
from tests.slow import slow

TRUE = {"E": 1.07e4, "M3": 18.0}
S = np.linspace(0.4, 20.0, 50)


def rod(E=1.07e4, M3=18.0, R=0.75, L=20.0, side="outside", **start):
    given = {"beta": "30deg", "dbeta": 0.5, "F3": 10.0} | ({"M3": M3} if M3 is not None else {}) | start
    return Case(Rod(E=E, nu=0.25, a=0.25, L=L, stiffness="paper"), Cylinder(R=R, side=side), Start(**given))


def between(FZ=-8.66, **given):
    return Case(
        Rod(1.07e4, 0.25, 0.25, 20.0), Cylinder(0.75), Ends(0.5, 0.8, FZ=FZ, **({"MZ": 1.3, "M3": 6.1} | given))
    )


def points_of(case, s=S, noise=0.0, seed=0, with_s=True):
    sol, rng = solve(case, tol=1e-12, stations=s), np.random.default_rng(seed)
    found = {name: getattr(sol, name) + noise * rng.standard_normal(s.size) for name in ("alpha", "z")}
    return found | ({"s": s} if with_s else {})


def height(F1):
    return float(observe(solve(rod(M3=None, F1=F1), tol=1e-11), ["height"])["height"])


# derivatives


@pytest.mark.parametrize(
    ("with_s", "sigma"),
    ((True, None), (False, None), (False, {"alpha": 0.02, "z": 0.05, "height": 0.1, "push_max": 3.0})),
)
def test_the_derivatives_of_the_residuals_are_those_of_differences(with_s, sigma) -> None:
    case = rod(M3=17.0)
    fields = ["E", "nu", "a", "L", "R", "alpha0", "beta0", "dbeta0", "F2", "F3", "M3"]
    points = points_of(rod(), S[:40], 0.03, with_s=with_s)
    data = check_data(case, {"height": 7.0, "push_max": 150.0}, points, sigma, False)
    parameters = check_parameters(case, fields)
    model, x = Model(case, parameters, data, "nearest", 1e-12), np.array([one.start for one in parameters])
    found, h = model.jacobian(x), 1e-5
    for k, name in enumerate(fields):
        near, far = (
            (model.residuals(x + d * np.eye(x.size)[k]) - model.residuals(x - d * np.eye(x.size)[k])) / (2 * d)
            for d in (h, 2 * h)
        )
        expected = (4 * near - far) / 3
        size = max(np.abs(expected).max(), 1e-3)
        np.testing.assert_allclose(found[:, k], expected, atol=1e-7 * size, err_msg=name)  # rounding over h


def test_the_derivative_of_a_point_with_s_by_the_length_keeps_its_s() -> None:
    case, s = rod(), np.array([3.0, 11.0])
    data = check_data(case, None, points_of(case, s), None, False)
    model = Model(case, check_parameters(case, ["L"]), data, "nearest", 1e-12)
    assert np.abs(model.jacobian(np.array([np.log(20.0)]))).max() < 1e-9  # a start problem does not know its length


def test_the_distance_to_a_point_is_the_least_of_the_whole_curve() -> None:
    case, points = rod(), points_of(rod(), S, 0.2, with_s=False)
    data = check_data(case, None, points, None, False)
    found = Model(case, check_parameters(case, ["E"]), data, "nearest", 1e-12).evaluation(np.log([1.07e4]))
    fine = solve(case, stations=200_001)
    pairs = zip(points["alpha"], points["z"], strict=True)
    nearest = np.array([np.hypot(fine.alpha - a, fine.z - z).min() for a, z in pairs])  # rho is 1
    least, half = np.abs(found.residuals), 20 / 200_000 / 2
    assert (least <= nearest + 1e-12).all()
    assert (nearest <= np.hypot(least, half) + half**2).all()  # a station is at most half a step from the foot


# values that are known


@pytest.mark.parametrize("with_s", (True, False))
def test_a_fit_to_points_of_a_known_rod_recovers_it(with_s) -> None:
    found = fit(rod(E=1e4, M3=17.0), ["E", "M3"], points=points_of(rod(), with_s=with_s), starts=0)
    assert found.solved
    for name, value in TRUE.items():
        assert found.values[name] == pytest.approx(value, rel=1e-8)


def test_a_fit_to_targets_of_a_known_rod_recovers_it() -> None:
    seen = observe(solve(rod(), tol=1e-11), ["height", "push_max"])
    found = fit(rod(E=1.05e4, M3=17.8), ["E", "M3"], {name: float(v) for name, v in seen.items()}, starts=0)
    assert found.solved
    assert found.reached
    for name, value in TRUE.items():
        assert found.values[name] == pytest.approx(value, rel=1e-8)


def test_a_fit_between_two_ends_recovers_the_loads_on_its_branch() -> None:
    points = points_of(between())
    found = fit(between(FZ=-8.5, M3=6.0), ["FZ", "M3"], points=points, starts=0)
    assert found.solved
    assert found.values["FZ"] == pytest.approx(-8.66, rel=1e-8)
    assert found.values["M3"] == pytest.approx(6.1, rel=1e-8)


def test_every_value_that_reaches_a_target_is_found() -> None:
    F1 = np.linspace(1.0, 9.0, 801)
    off = observe(solve(rod(M3=None, F1=F1)), ["height"])["height"] - 8.0
    crossings = [
        brentq(lambda v: height(v) - 8.0, a, b)
        for a, b, u, v in zip(F1, F1[1:], off, off[1:], strict=False)
        if u * v < 0
    ]
    found = fit(rod(M3=None, F1=5.0), {"F1": (1.0, 9.0)}, {"height": 8.0})
    reached = [found.values["F1"], *(one.values["F1"] for one in found.minima if one.as_good)]
    assert len(crossings) > 1
    np.testing.assert_allclose(sorted(reached), crossings, rtol=1e-6)
    assert any("not unique" in remark for remark in found.remarks)


@pytest.mark.parametrize("highest", (8.0, 9.0))  # at which the first search ends; which it reaches
def test_rounding_of_a_target_leaves_the_order_of_the_values_that_reach_it(highest) -> None:
    targets = [9.0 + ulps * np.spacing(9.0) for ulps in range(-2, 3)]
    for target in targets:
        found = fit(rod(M3=None, F1=5.0), {"F1": (1.0, highest)}, {"height": target})
        reached = [found.values["F1"], *(one.values["F1"] for one in found.minima if one.as_good)]
        nearest_first = [3.022233, 2.728621]
        assert reached == pytest.approx(([8.880371] if highest == 9.0 else []) + nearest_first, rel=1e-6)


def test_of_mirrored_values_that_are_as_good_the_positive_one_is_first() -> None:
    case = Case(Rod(1e4, 0.25, 0.25, 20.0), Cylinder(0.75), Start(0.0, 0.0, F3=-1.0, M3=0.0))
    found = fit(case, "beta0", {"height": 15.0})
    assert found.values["beta0"] > 0
    assert found.minima[0].values["beta0"] == pytest.approx(-found.values["beta0"])


def test_the_order_of_points_and_whole_turns_do_not_matter() -> None:
    points, other = points_of(rod(), noise=0.03), np.random.default_rng(1).permutation(S.size)
    turns = np.random.default_rng(2).integers(6, 13, S.size)  # beyond all that the rod goes round
    turned = {"s": S[other], "alpha": points["alpha"][other] + 2 * pi * turns, "z": points["z"][other]}
    one = fit(rod(E=1e4), ["E", "M3"], points=points, starts=0)
    two = fit(rod(E=1e4), ["E", "M3"], points=turned, wrapped=True, starts=0)
    assert two.values == pytest.approx(one.values, rel=1e-9)
    np.testing.assert_allclose(two.residuals[:50], one.residuals[:50][other], atol=1e-9)
    np.testing.assert_allclose(two.feet[0], S[other])
    del turned["s"], points["s"]
    one, two = (
        fit(rod(E=1e4), ["E", "M3"], points=some, wrapped=some is turned, starts=0) for some in (points, turned)
    )
    assert two.values == pytest.approx(one.values, rel=1e-6)  # the ends of the searches differ by rounding


# intervals


def test_covariance_is_that_of_curve_fit() -> None:
    points = points_of(rod(), noise=0.03)
    found = fit(rod(E=1e4, M3=17.0), ["E", "M3"], points=points, starts=0)

    def model(_, E, M3):
        sol = solve(rod(E=E, M3=M3), tol=1e-11, stations=S)
        return np.concatenate([sol.alpha, sol.z])

    both = np.concatenate([points["alpha"], points["z"]])  # rho is 1
    values, covariance = curve_fit(model, None, both, p0=[1e4, 17.0], x_scale=[1e4, 17.0], method="trf", xtol=1e-12)
    np.testing.assert_allclose(list(found.values.values()), values, rtol=1e-6)
    np.testing.assert_allclose(found.covariance, covariance, rtol=1e-3)  # its derivatives are differences


def test_the_share_of_a_datum_is_that_of_its_error_in_the_variance() -> None:
    points = points_of(rod(), S[::10], noise=0.01)
    found = fit(rod(), ["E", "M3"], points=points, starts=0)
    h, moved = 1e-4, []
    for name in ("alpha", "z"):
        for i in range(5):
            ends = []
            for sign in (1, -1):
                other = {**points, name: points[name] + sign * h * (np.arange(5) == i)}
                ends.append(np.log(fit(rod(), ["E", "M3"], points=other, starts=0).values["E"]))
            moved.append((ends[0] - ends[1]) / (2 * h))
    shares = np.array(moved) ** 2 / np.sum(np.square(moved))
    assert found.shares["E"].sum() == pytest.approx(1)
    assert found.groups == ("alpha",) * 5 + ("z",) * 5
    np.testing.assert_allclose(found.shares["E"], shares, atol=0.02)  # Gauss-Newton: residuals of 1 %


@pytest.mark.parametrize(("repetitions", "off"), [(20, 0.15), slow(400, 0.02)])
def test_the_intervals_hold_in_95_percent_of_repetitions(repetitions, off) -> None:
    held = np.zeros(2)
    for seed in range(repetitions):
        points = points_of(rod(), noise=0.03, seed=seed)
        found = fit(rod(E=1e4, M3=17.0), list(TRUE), points=points, starts=0)
        held += [found.intervals[name][0] <= value <= found.intervals[name][1] for name, value in TRUE.items()]
    # fewer than 16 of 20: chance 0.3 %
    np.testing.assert_allclose(held / repetitions, 0.95, rtol=0, atol=off + 1e-12)


def test_sigma_gives_intervals_without_residuals_and_judges_them() -> None:
    points = points_of(rod(), noise=0.03)
    known = fit(rod(), ["E", "M3"], points=points, sigma={"alpha": 0.03, "z": 0.03}, starts=0)
    halved = fit(rod(), ["E", "M3"], points=points, sigma={"alpha": 0.015, "z": 0.015}, starts=0)
    one, two = (np.diff(np.log(found.intervals["E"]))[0] for found in (known, halved))
    assert one / two == pytest.approx(2, rel=1e-6)
    assert known.probability > 0.01 > halved.probability
    assert known.solved
    assert halved.outcome.startswith("misfit: the residuals are larger than sigma allows (chance ")
    both = fit(rod(), ["E", "M3", "F3"], points=points, sigma={"alpha": 0.015, "z": 0.015}, starts=0)
    assert both.outcome.startswith("undetermined: ")
    assert any("larger than sigma allows" in remark for remark in both.remarks)
    mild = fit(rod(), ["E", "M3"], points=points, sigma={"alpha": 0.024, "z": 0.024}, starts=0)
    assert 1e-6 < mild.probability < 0.01
    assert mild.solved
    assert any("larger than sigma allows" in remark for remark in mild.remarks)
    target = fit(rod(), "M3", {"height": 7.8}, sigma={"height": 0.1}, starts=0)
    low, high = target.intervals["M3"]
    rate = 0.1 / abs(solve(rod(M3=target.values["M3"])).sensitivity(["M3"], ["height"]).observables["height"][0])
    assert high - low == pytest.approx(2 * 1.959964 * rate, rel=1e-5)


def test_without_sigma_as_many_data_as_fields_have_no_interval() -> None:
    found = fit(rod(), "M3", {"height": 7.8}, starts=0)
    assert found.solved
    assert np.isnan(found.intervals["M3"]).all()
    assert found.rule.startswith("no intervals: no sigma is given")


# what the data cannot tell


def test_the_modulus_and_all_forces_cannot_be_told_apart() -> None:
    found = fit(rod(), ["E", "F3", "M3", "R"], points=points_of(rod(), noise=0.01), starts=0)
    assert found.outcome == (
        "undetermined: the data cannot tell E and F3 and M3 apart: no datum changes when these change together, E, F3 "
        "and M3 by +1 % each"
    )
    (way,) = found.directions
    assert way == pytest.approx({"E": 1, "F3": found.values["F3"], "M3": found.values["M3"]}, rel=1e-5)
    assert found.intervals["E"] == (0.0, np.inf)
    assert found.intervals["M3"] == (-np.inf, np.inf)
    assert np.isfinite(found.intervals["R"]).all()
    assert found.condition == np.inf


def test_no_rounding_decides_what_the_data_do_not_determine() -> None:
    """The order of the points changes the last digits of a search, and nothing else."""
    points, guess, fields = points_of(rod(), noise=0.03), rod(E=1.03e4, M3=17.0), ["E", "F3", "M3", "R"]
    orders = [np.random.default_rng(seed).permutation(S.size) for seed in range(4)]
    every = [fit(guess, fields, points={name: v[o] for name, v in points.items()}, starts=0) for o in orders]
    for found in every:
        assert found.outcome.startswith("undetermined")
        assert found.values == pytest.approx(every[0].values, rel=1e-8)
        assert abs(np.log(found.values["E"] / 1.03e4)) < 0.02  # R and the ratios of E, F3 and M3 alone move it


def test_a_fit_that_begins_at_its_own_result_stays_there_though_the_data_do_not_determine_it() -> None:
    points, fields = points_of(rod(), noise=0.03), ["E", "F3", "M3", "R"]
    found = fit(rod(E=1.03e4, M3=17.0), fields, points=points, starts=0)
    again = fit(found.case, fields, points=points, starts=0)
    assert again.outcome.startswith("undetermined")
    assert again.values == pytest.approx(found.values, rel=1e-4)


def test_a_field_without_effect_is_named_and_stays() -> None:
    guess = rod(E=4.1e3, M3=12.6, gamma=-0.1)  # from which the first search ends at another minimum
    found = fit(guess, ["E", "M3", "gamma0"], points=points_of(rod(), noise=0.01))
    assert found.outcome == "undetermined: the data do not depend on gamma0"
    assert found.values["E"] == pytest.approx(1.07e4, rel=0.02)
    assert found.values["gamma0"] == pytest.approx(-0.1)
    assert np.isfinite(found.intervals["E"]).all()
    assert found.intervals["gamma0"] == (-np.inf, np.inf)


def test_fields_that_are_hard_to_tell_apart_are_named() -> None:
    found = fit(rod(), ["F2", "F3", "M3"], points=points_of(rod(), S[:4], 1e-4), starts=0)
    assert any(remark.startswith("the data hardly tell") for remark in found.remarks)
    assert np.isfinite(found.condition)


# what has no value


def test_the_nearest_value_that_is_reached_is_told() -> None:
    F1 = np.linspace(1.0, 9.0, 2001)
    nearest = observe(solve(rod(M3=None, F1=F1)), ["height"])["height"].max()
    found = fit(rod(M3=None, F1=5.0), {"F1": (1.0, 9.0)}, {"height": 100.0})
    assert not found.reached
    assert not found.solved
    assert found.computed[0] == pytest.approx(nearest, rel=1e-5)
    assert found.outcome == (
        f"failed: the search found no F1 from 1 to 9 that reaches height = 100; the nearest reached is height = "
        f"{found.computed[0]:.6g}, at F1 = {found.values['F1']:.6g}"
    )


def test_a_search_steps_back_from_values_without_a_rod() -> None:
    case = rod(R=0.5, side="inside", M3=1.0)  # no room at R = 0.25
    found = fit(case, "R", {"kappa_mean": 12.0}, starts=0)
    assert found.solved
    assert observe(solve(found.case), ["kappa_mean"])["kappa_mean"] == pytest.approx(12.0)
    assert any("of the values tried the data cannot be computed" in remark for remark in found.remarks)


def test_a_value_between_starts_of_different_sign_is_found() -> None:
    case = rod(R=0.8, side="inside", M3=1.0)  # from which the first search ends beside R = 0.3497
    assert not fit(case, "R", {"turns_around": 6.0}, starts=0).reached
    found = fit(case, "R", {"turns_around": 6.0}, starts=16)
    assert found.solved
    assert observe(solve(found.case), ["turns_around"])["turns_around"] == pytest.approx(6.0)


def test_a_rod_that_is_too_short_for_a_point_is_not_tried() -> None:
    points = points_of(rod(), S[:40])
    found = fit(rod(L=18.0), {"L": (10.0, 30.0)}, {"height": 8.0}, points)
    assert found.values["L"] >= S[39]


def test_no_value_at_all_is_an_outcome() -> None:
    found = fit(rod(R=0.5, side="inside", M3=1.0), {"R": (0.1, 0.2)}, {"height": 8.0})
    assert found.outcome.startswith("failed: at none of the values tried")
    assert np.isnan(found.values["R"])


def test_a_field_that_ends_at_its_bound_has_no_interval() -> None:
    found = fit(rod(E=9e3), {"E": (8e3, 1e4), "M3": None}, points=points_of(rod(), noise=0.01), starts=0)
    assert found.values["E"] == pytest.approx(1e4, rel=1e-6)
    assert np.isnan(found.intervals["E"]).all()
    assert np.isfinite(found.intervals["M3"]).all()
    assert any(remark.startswith("E ends at its bound, 10000") for remark in found.remarks)


# what was wrong once


def test_a_target_of_zero_with_sigma_is_reached() -> None:
    wanted = {"beta": (-pi / 3, pi / 3)}, {"turns_around": 0.0}
    found = fit(rod(M3=None, F1=5.0), *wanted, sigma={"turns_around": 0.1})
    assert found.outcome == "solved"
    assert found.computed[0] == pytest.approx(0.0, abs=1e-9)
    assert found.values["beta0"] == pytest.approx(fit(rod(M3=None, F1=5.0), *wanted).values["beta0"], rel=1e-6)


def test_with_sigma_the_likelihood_tells_which_minima_the_data_exclude() -> None:
    given = rod(M3=None, F1=5.0), {"F1": (1.0, 9.0)}, {"height": 9.0}
    rough, sharp = (fit(*given, sigma={"height": sigma}) for sigma in (10.0, 1e-9))
    assert len(rough.minima) == 2
    assert all(one.as_good for one in rough.minima)
    at_both = [one for one in sharp.minima if abs(height(one.values["F1"]) - 9.0) < 1e-9]
    assert at_both
    assert all(one.as_good for one in at_both)


@pytest.mark.filterwarnings("error")
def test_a_field_without_effect_alone_ends_where_it_begins() -> None:
    found = fit(rod(), "gamma0", {"height": 9.0}, sigma={"height": 0.1})
    assert found.outcome.startswith(
        "failed: the search found no gamma0 (starts from -1 to 1) that reaches height = 9; the ne"
    )
    assert found.values["gamma0"] == 0.0
    assert found.solves < 100


@pytest.mark.filterwarnings("error")
def test_residuals_beyond_the_range_of_floats_are_no_value() -> None:
    found = fit(rod(), "E", points={"alpha": [1e308], "z": [1e308]}, starts=2)
    assert found.outcome.startswith("failed: at none of the values tried the data can be computed, most often: the sq")
    assert not fit(rod(), "E", {"height": 1e300}, starts=2).reached


def test_a_field_without_effect_by_symmetry_alone_is_searched() -> None:
    case = Case(Rod(1e4, 0.25, 0.25, 20.0), Cylinder(0.75), Start(0.0, 0.0, F3=-1.0, M3=0.0))  # a straight rod
    found = fit(case, "beta0", {"height": 15.0})
    assert found.outcome == "solved"
    assert found.computed[0] == pytest.approx(15.0)
    (mirrored,) = [one for one in found.minima if one.values["beta0"] == pytest.approx(-found.values["beta0"])]
    assert mirrored.as_good
    assert all(one.values["beta0"] for one in found.minima)


def test_an_undetermined_direction_names_the_change_of_an_angle_in_rad() -> None:
    case = rod(dbeta=0.0)
    height = float(observe(solve(case), ["height"])["height"])
    found = fit(case, ["beta0", "M3"], {"height": height}, starts=0)
    beta0, M3 = solve(case).sensitivity(["beta0", "M3"], ["height"]).observables["height"]
    assert found.outcome.endswith(f"change together, beta0 by {-0.18 * M3 / beta0:+.4g} rad, M3 by +1 %")


@pytest.mark.parametrize("with_s", (True, False))
def test_points_in_wrong_units_are_a_remark(with_s) -> None:
    points = points_of(rod(), noise=0.03, with_s=with_s)
    wrong = [{**points, "z": 10 * points["z"]}, {**points, "alpha": np.degrees(points["alpha"])}]
    for some in wrong:
        found = fit(rod(), "M3", points=some, starts=0)
        _, alpha, z = found.feet
        off = np.sqrt(np.mean((some["alpha"] - alpha) ** 2 + (some["z"] - z) ** 2))  # rho is 1
        said = f"the rod misses the points by {off:.3g} rho (root mean square): check the units of alpha (rad, or 17deg"
        assert any(remark.startswith(said) for remark in found.remarks)
    for sigma in (None, {"alpha": 0.03, "z": 0.03}):
        assert not any("misses" in remark for remark in fit(rod(), "M3", points=points, sigma=sigma, starts=0).remarks)
    rough = points_of(rod(), noise=2.0, with_s=True)
    known = fit(rod(), "M3", points=rough, sigma={"alpha": 2.0, "z": 2.0}, starts=0)
    assert not any("misses" in remark for remark in known.remarks)


def test_a_search_that_begins_at_residuals_of_zero_ends_there() -> None:
    case = rod(dbeta=0.0)
    height = float(observe(solve(case), ["height"])["height"])
    found = fit(case, ["beta0", "M3"], {"height": height}, starts=0)
    assert found.cost < 1e-20
    assert found.values == pytest.approx({"beta0": np.pi / 6, "M3": 18.0}, rel=1e-12)
    assert not any("cannot be computed" in remark for remark in found.remarks)
