"""What the live page shows, without the page."""

import copy
import json
from struct import unpack

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, solve
from solver.observe.observables import OBSERVABLES
from solver.problem.errors import InputError
from studies.loader import loads
from workbench.run import block
from workbench.web.live import mesh, page_model, page_shape
from workbench.web.live.presets import PRESETS

BY_NAME = {preset.name: preset for preset in PRESETS}


def state(name: str = "table1", **changes: object) -> dict:
    made = copy.deepcopy(BY_NAME[name].state)
    made["base"] |= changes
    return made


def shape(name: str = "table1", **changes: object) -> page_shape.Shape:
    return page_shape.shape(page_model.study_of(state(name, **changes)))


@pytest.mark.parametrize("name", BY_NAME)
def test_every_preset_is_solved_and_says_its_source_and_units(name) -> None:
    found = shape(name)
    assert found.whole
    units = BY_NAME[name].state["units"]
    assert f"{units['length']} and {units['force']}" in BY_NAME[name].source
    assert page_model.facts(found)["outcome"] == "solved"
    assert json.loads(json.dumps(page_model.numbers(found)))["rows"]


def test_the_pipe_has_the_bending_stiffness_of_its_hollow_section() -> None:
    rod = shape("pipe").sol.case.rod
    hollow = 206e6 * np.pi / 64 * (0.1270**4 - 0.1086**4)  # kN m^2
    assert rod.bending_stiffness == pytest.approx(hollow, rel=2e-3)


def test_the_dna_has_its_stiffnesses_and_the_nucleosomes_left_handed_superhelix() -> None:
    found = shape("dna").sol
    kT = 1.380649e-2 * 298  # pN nm
    assert found.case.rod.bending_stiffness == pytest.approx(50 * kT, rel=2e-3)
    assert 386 < found.case.rod.torsional_stiffness < 448
    assert found.case.rho == pytest.approx(4.18)
    turns = found.alpha[-1] / (2 * np.pi)
    assert turns == pytest.approx(-1.65, abs=0.005)  # round the other way as it rises
    assert found.z[-1] / -turns == pytest.approx(2.39, abs=0.005)  # the digits of the source


def test_a_tight_cable_presses_with_its_tension_over_the_radius() -> None:
    found = shape("cable")
    np.testing.assert_allclose(found.sol.push, 10e3 / 190.0, rtol=1e-3)  # the lay is a degree off the hoop's
    assert found.sol.alpha[-1] / (2 * np.pi) == pytest.approx(5.0, abs=0.01)


def test_the_state_is_a_study_and_its_text_gives_the_same_rod() -> None:
    study = page_model.study_of(state(E=2e4, F3=12.0))
    again = loads(page_model.text(study))
    sol = block.solve_one(again.case(), again.equilibrium, 1e-8, "auto", 201)
    np.testing.assert_array_equal(sol.beta, page_shape.shape(study).sol.beta)


@pytest.mark.parametrize(
    "changes, field, sentence",
    [
        ({"E": -1.0}, "E", "Rod.E must be positive and finite, got -1.0"),
        ({"E": None}, "E", "E must be a number, got nothing"),
        ({"R": "wide"}, "R", "R must be a number, got 'wide'"),
        ({"R": 0.2, "side": "inside"}, "R", "larger than Rod.a = 0.25 for a rod inside"),
        ({"nu": 0.7}, "nu", "Rod.nu must be in"),
        ({"dbeta": 0}, "F1", "F1 cannot determine the twist at dbeta = 0"),
        ({"young": 1.0}, "", "no key 'young' in base"),
        ({"L": float("nan")}, "L", "L must be"),
    ],
)
def test_what_cannot_be_is_refused_with_the_field_and_without_a_line_of_a_file(changes, field, sentence) -> None:
    with pytest.raises(InputError) as refused:
        shape(**changes)
    assert sentence in str(refused.value)
    assert "line" not in str(refused.value).partition(":")[0]
    assert page_model.field_of(str(refused.value)) == field


@pytest.mark.parametrize("odd", [None, 3, [], {"path": "/etc/passwd"}, {"base": 3}, {"units": {}}, {"base": {"E": {}}}])
def test_a_state_of_another_kind_is_refused(odd) -> None:
    with pytest.raises(InputError):
        page_model.study_of(odd)


def test_a_reading_drops_what_it_drops_and_says_so() -> None:
    found = shape()
    assert page_model.facts(found)["meaning"]["dgamma"] == "printed, but dropped by the reading"
    twist = page_shape.shape(page_model.study_of(state() | {"reading": "twist-first/tension/paper"}))
    assert not np.allclose(found.sol.beta, twist.sol.beta)


def test_a_rod_of_many_bends_gets_more_stations_and_a_very_long_one_is_shown_in_part() -> None:
    many = shape(L=200.0)
    assert (np.abs(np.diff(many.sol.beta)) < page_shape.CHORD * 1.01).all()
    assert many.whole
    part = shape(L=2e4)
    assert not part.whole
    assert part.sol.s.size == page_shape.MOST
    assert "Only the first" in page_model.facts(part)["notes"][0]
    with pytest.raises(InputError, match="only a part of this rod is shown"):
        page_model.stored(part)


def test_held_by_both_its_ends_a_rod_keeps_its_shape_and_is_one_of_the_list() -> None:
    first = shape()
    ends = page_model.ends_state(first.study)
    study = page_model.study_of(ends)
    held = page_shape.shape(study)
    # measured 5e-12: the far angle is told to the last bit, and the condition is 10
    np.testing.assert_allclose(held.sol.beta[::2], first.sol.beta, atol=1e-9)
    assert held.sol.dbeta[0] == pytest.approx(0.5, abs=1e-8)
    rows = page_model.list_equilibria(study)
    assert min(abs(row["dbeta0"] - 0.5) for row in rows) < 1e-8
    with pytest.raises(InputError, match="one solution only"):
        page_model.list_equilibria(first.study)


def test_of_more_equilibria_than_can_be_looked_through_the_default_one_is_shown_and_a_list_refused() -> None:
    pipe = shape("pipe")
    middle = np.degrees(abs(pipe.sol.beta[pipe.sol.s.size // 2]))
    A, rho = pipe.sol.case.rod.bending_stiffness, float(pipe.sol.case.rho)
    # Lubinski's helix, F = 2 A sin(beta)^2 / rho^2, to the first order in beta, which is 0.013 rad
    assert middle == pytest.approx(np.degrees(np.sqrt(200.0 * rho**2 / (2 * A))), rel=1e-3)
    named = state("pipe") | {"equilibrium": page_model.facts(pipe)["which"]}
    np.testing.assert_array_equal(page_shape.shape(page_model.study_of(named)).sol.beta, pipe.sol.beta)
    with pytest.raises(InputError, match="some 716 half periods, and the page searches at most 100"):
        page_model.list_equilibria(pipe.study)
    named["equilibrium"] = {"dbeta0": 0.2, "energy": 0.0}
    with pytest.raises(InputError, match="the named equilibrium is not the one selected by default"):
        page_shape.shape(page_model.study_of(named))
    soft = page_model.study_of(state("cable", E=0.5))
    with pytest.raises(InputError, match="some 3223 half periods"):  # four minutes without the limit
        page_shape.shape(soft)


def test_a_shape_is_followed_in_steps_where_one_is_too_far() -> None:
    base = {"E": 9.58e7, "nu": 0.3, "a": 0.0635, "L": 100.0, "R": 0.10795, "side": "inside", "beta0": 0.0, "betaL": 0.0,
            "FZ": -200.0, "M3": 0.0}  # fmt: skip
    made = {"units": {"length": "m", "force": "kN"}, "base": base}
    began = page_shape.shape(page_model.study_of(made))
    pushed = page_model.study_of(made | {"base": base | {"FZ": -1000.0}})
    far = solve(pushed.case(), page_shape.NEAR, "difference", page_shape.BETWEEN, seed=began.sol)
    assert not far.solved  # or this test shows nothing
    there = page_shape.shape(pushed, began.sol).sol
    assert there.method == "difference"
    rows = {row["name"]: row for row in page_model.numbers(page_shape.Shape(pushed, there))["rows"]}
    assert rows["turns"]["text"] == "not known"  # its level stretch has bends of 1e-8
    assert rows["amplitude"]["text"] == "1.629"
    ratio = np.sin(there.beta[200]) / np.sin(began.sol.beta[200])
    assert ratio == pytest.approx(np.sqrt(5), rel=2e-3)  # Lubinski's again; ends and second order


def test_a_slider_follows_the_equilibrium_it_began_with() -> None:
    base = {"E": 5e3, "nu": 0.25, "a": 0.25, "L": 12.0, "R": 0.75, "side": "outside", "beta0": 0.5, "betaL": 0.8,
            "FZ": -5.0, "MZ": 1.0, "M3": 2.0}  # fmt: skip
    made = {"units": {"length": "cm", "force": "N"}, "base": base}
    rows = page_model.list_equilibria(page_model.study_of(made))
    third = {name: rows[2][name] for name in ("dbeta0", "energy")}
    began = page_shape.shape(page_model.study_of(made | {"equilibrium": third}))
    moved = page_model.study_of(made | {"base": base | {"R": 0.76}})
    followed = page_shape.shape(moved, began.sol)
    lowest = page_shape.shape(moved)
    assert np.abs(followed.sol.beta - began.sol.beta).max() < 0.2
    assert np.abs(lowest.sol.beta - began.sol.beta).max() > 0.5


def test_the_curves_are_the_solvers_and_the_level_bounds_the_angle() -> None:
    found = shape()
    start = Start(np.pi / 6, 0.5, F1=5.0, F3=10.0)
    sol = solve(Case(Rod(1.07e4, 0.25, 0.25, 20.0, "paper"), Cylinder(0.75), start))
    drawn = page_model.curves(found)
    np.testing.assert_allclose(np.radians(drawn["beta"]), sol.beta, atol=1e-9)
    np.testing.assert_allclose(drawn["across"], 1.0 * sol.alpha, atol=1e-9)
    np.testing.assert_allclose(drawn["push"], sol.push, rtol=1e-9)
    inside = np.interp(drawn["beta"], drawn["angle"], drawn["potential"], period=360)
    assert (inside <= drawn["level"] + 0.01).all()  # beta'^2 = h - G; G is read off a curve of one degree


def test_every_observable_is_a_row_with_unit_and_words() -> None:
    rows = {row["name"]: row for row in page_model.numbers(shape())["rows"]}
    assert set(rows) == set(OBSERVABLES)
    assert (rows["kappa_max"]["unit"], rows["amplitude"]["unit"]) == ("1/cm", "°")
    assert rows["turns"]["text"] == "6"
    assert float(rows["amplitude"]["text"]) == pytest.approx(np.degrees(rows["amplitude"]["value"]), rel=1e-3)


def test_the_warnings_are_those_of_the_shape() -> None:
    assert "The rod passes through itself." in page_model.numbers(shape())["warnings"]
    assert page_model.numbers(shape("cable"))["warnings"] == []


@pytest.mark.parametrize("name", BY_NAME)
def test_the_mesh_is_a_closed_tube_that_touches_the_cylinder(name) -> None:
    found = shape(name)
    drawn = mesh.rod(found.sol)
    triangles = drawn.polygons.reshape(-1, 4)
    assert (triangles[:, 0] == 3).all()
    corners = drawn.points.astype(float)[triangles[:, 1:]]
    case = found.sol.case
    _, at = np.unique(drawn.points, axis=0, return_inverse=True)  # lids have points of their own
    edges = np.sort(at.reshape(-1)[triangles[:, [1, 2, 2, 3, 3, 1]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    away = np.hypot(drawn.points[:, 0], drawn.points[:, 1])
    touching = away.min() if case.cylinder.side == "outside" else away.max()
    assert touching == pytest.approx(case.cylinder.R, rel=1e-5)  # single precision
    if drawn.squeeze == 1:
        volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
        # twenty sides have 1.6 % less than the circle; chords at 0.35 rad cost another 1 %
        assert volume == pytest.approx(np.pi * case.rod.a**2 * case.rod.L, rel=0.03)


@pytest.mark.parametrize("name", BY_NAME)
def test_the_light_tube_is_closed_too_and_off_by_no_more_than_it_says(name) -> None:
    found = shape(name)
    drawn = mesh.rod(found.sol)
    n, sides = found.sol.s.size, mesh.sides_of(found.sol.s.size)
    triangles = drawn.coarse.reshape(-1, 4)[:, 1:]
    assert len(triangles) < 0.51 * drawn.polygons.size / 4  # every other side
    _, at = np.unique(drawn.points, axis=0, return_inverse=True)
    edges = np.sort(at.reshape(-1)[triangles[:, [0, 1, 1, 2, 2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    rings = np.unique(triangles[triangles < n * sides] // sides)
    centre = drawn.points[: n * sides].reshape(n, sides, 3).mean(axis=1)
    straight = np.stack([np.interp(np.arange(n), rings, centre[rings, i]) for i in range(3)], axis=-1)
    size = max(np.ptp(centre[:, 2]), 2 * np.hypot(centre[:, 0], centre[:, 1]).max())
    off = np.sqrt(((straight - centre) ** 2).sum(axis=-1)).max()
    assert off < 1.1 * mesh.COARSE * size / mesh.HIGH  # a quadratic and single precision


def test_a_tall_scene_is_compressed_along_the_axis_and_says_by_how_much() -> None:
    found = shape("pipe")
    drawn = mesh.rod(found.sol)
    tall = np.ptp(drawn.points[:, 2])
    assert drawn.squeeze == pytest.approx(9 * 2 * 0.10795 / found.sol.z[-1], rel=1e-6)
    assert tall == pytest.approx(9 * 2 * 0.10795, rel=0.05)


def test_the_colours_are_where_the_cylinder_pushes_and_where_it_pulls() -> None:
    found = shape()
    drawn = mesh.rod(found.sol)
    n, sides = found.sol.s.size, mesh.sides_of(found.sol.s.size)
    rings = drawn.colours[: n * sides].reshape(n, sides, 3)
    assert len(np.unique(drawn.colours, axis=0)) == 2
    np.testing.assert_array_equal(rings[:, 0, 0] > 100, found.sol.push < 0)  # orange has much red


def test_what_is_packed_is_unpacked_whole() -> None:
    packed = pytest.importorskip(
        "workbench.web.live.server", reason="pip install '.[explore]'", exc_type=ImportError
    ).packed
    arrays = {"a": np.arange(5, dtype=np.uint8), "b": np.linspace(0, 1, 7, dtype=np.float32)}
    data = packed({"x": float("nan"), "y": "β"}, arrays)
    (length,) = unpack("<I", data[:4])
    head = json.loads(data[4 : 4 + length])
    assert (head["x"], head["y"]) == (None, "β")
    for name, kind, count, at in head["arrays"]:
        assert (4 + length + at) % 4 == 0  # as a browser's typed arrays need it
        np.testing.assert_array_equal(np.frombuffer(data, kind, count, 4 + length + at), arrays[name])
