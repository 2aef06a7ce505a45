"""What the live page computes in the browser, against the workbench: loads, shapes, forces, observables, meshes."""

import math

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from benchmarks import make_page_formulas
from solver import Case, Ends, Solution, solve
from solver.core import build
from solver.observe.observables import observe
from solver.orbits import frames
from solver.orbits.potential import potential
from solver.problem.quantities import QUANTITIES, unit_of
from studies.language.loader import loads
from studies.paper.readings import READINGS
from tests.workbench import small
from tests.workbench.live import STATES, state
from tests.workbench.node import needs_node, run
from workbench.figures import along_rods, colours, drawn_rods, push_scale
from workbench.geometry import solid_body
from workbench.scene import scene_kinds, surfaces, views
from workbench.stored import quantity_variables
from workbench.stored.stored_study import StoredStudy
from workbench.web.live import page_model
from workbench.words import caution_words, labels, unit_habits
from workbench.words.escaping import finite

pytestmark = needs_node
SHAPE = """
const one = rod_case.caseOf(given.state ?? given, {});
const shape = rod_shape.marched(core, one);
"""
MODULES = ("rod_case", "rod_shape")


def case_of(made: dict) -> Case:
    return page_model.study_of(made).case()


TUBE = {"E": 1.07e4, "nu": 0.25, "a": 0.25, "inner_radius": 0.2, "L": 8.0, "R": 0.75, "beta": 0.5, "dbeta": 0.5,
        "dgamma": 0.3, "F3": 3.0}  # fmt: skip
STARTS = [
    *(state(reading=name) for name in READINGS),
    state("dna"), state("dna", side="inside", R=9.0), state(side="inside"), state(E=3e5), state(E=900.0, L=60.0),
    {"units": {"length": "cm", "force": "N"}, "base": TUBE},
    {"units": {"length": "m", "force": "N"}, "base": {
        "E": 2e9, "nu": 0.3, "a": 0.01, "L": 3.0, "R": 0.1, "stiffness": "paper", "beta": -2.0, "dbeta": 4.0,
        "M3": -3.0, "F2": 2.0, "F3": -40.0, "alpha": 0.7}},
    {"units": {"length": "mm", "force": "N"}, "base": {
        "E": 1e3, "nu": 0.3, "a": 1.0, "L": 80.0, "R": 4.0, "side": "inside", "beta": 0.3, "dbeta": 0.05, "M3": 40.0}},
]  # fmt: skip


def test_the_formulas_of_the_page_are_those_that_the_solver_writes_now() -> None:
    assert make_page_formulas.FILE.read_text(encoding="utf-8") == make_page_formulas.text()


def test_the_loads_of_every_reading_are_those_of_the_solver() -> None:
    script = """
    const loads = ({ FZ, MZ, M3, rho, A, C }) => [FZ, MZ, M3, rho, A, C];
    answer(given.map((state) => loads(rod_case.caseOf(state, {}))));"""
    for made, found in zip(STARTS, run(script, STARTS, MODULES), strict=True):
        case = case_of(made)
        wanted = [*case.loads, case.rho, case.rod.bending_stiffness, case.rod.torsional_stiffness]
        np.testing.assert_allclose(found, wanted, rtol=1e-13)


def test_shape_and_push_along_the_rod_are_those_of_the_solver() -> None:
    script = (
        "answer(given.map((state) => { const shape = rod_shape.marched(core, rod_case.caseOf(state, {}));"
        "const names = ['s', 'beta', 'dbeta', 'alpha', 'z', 'push', 'kappa', 'tension'];"
        "return Object.fromEntries(names.map((name) => [name, shape[name]])); }));"
    )
    for made, found in zip(STARTS, run(script, STARTS, MODULES), strict=True):
        sol = solve(case_of(made), 1e-8, stations=np.array(found["s"]))
        assert sol.solved
        for name in set(found) - {"s"}:
            wanted = getattr(sol, "F3" if name == "tension" else name)
            np.testing.assert_allclose(found[name], wanted, atol=1e-7 * max(np.abs(wanted).max(), 1e-6), err_msg=name)


def test_a_rod_with_weight_has_the_fields_and_the_push_of_the_server() -> None:
    heavy = state("pipe", weight=0.242, inclination=1.4, azimuth=0.0, friction=0.2, sliding="forward")
    del heavy["base"]["MZ"]
    rod = page_model.shape(page_model.study_of(heavy))
    found, facts = page_model.stations(rod), page_model.facts(rod)
    script = """
    const rows = Object.entries(given.arrays).map(([name, row]) => [name, Float64Array.from(row)]),
      arrays = Object.fromEntries(rows);
    const shape = rod_shape.interpolated(core, rod_case.caseOf(given.state, {}), arrays, given.facts);
    const found = numbers.observables(shape);
    answer([rod_case.fieldNames(given.state), shape.s, shape.push, found, controls.spanOf("friction")]);
    """
    fields, s, push, numbers, span = run(
        script, {"state": heavy, "arrays": {name: row.tolist() for name, row in found.items()}, "facts": finite(facts)},
        (*MODULES, "numbers", "controls"),
    )  # fmt: skip
    assert fields[-8:] == ["weight", "inclination", "friction", "beta0", "betaL", "FZ", "azimuth", "M3"]
    assert span == [0, 1]
    assert np.allclose(push, np.interp(s, found["s"], found["push"]), atol=1e-12)
    assert numbers["push_max"] == pytest.approx(found["push"].max(), rel=1e-4)  # stations beside the peak
    assert numbers["energy"] is None  # of a rod that slides with friction


OBSERVED = ("bends", "bend_number", "amplitude", "turns_around", "height", "kappa_mean", "kappa_max", "push_mean",
            "pull_mean", "push_min", "push_max", "push_max_at", "push_middle", "attached", "lift_off_at", "F3_size_max",
            "bending_moment_max", "bending_stress_max", "energy", "bending_energy", "twist_energy")  # fmt: skip


def test_the_observables_are_those_of_the_solver() -> None:
    script = "answer(given.map((state) => numbers.observables(rod_shape.marched(core, rod_case.caseOf(state, {})))));"
    states = [*STARTS, state(L=1900.0)]  # the last one has fewer stations than its numbers need
    for made, found in zip(states, run(script, states, (*MODULES, "numbers")), strict=True):
        known = [name for name in OBSERVED if name != "bending_stress_max" or "EI" not in made["base"]]
        wanted = observe(solve(case_of(made), 1e-10), known)
        assert set(known) == {*OBSERVED} & {*found}
        for name in known:
            size = abs(float(wanted[name]))
            if name in ("push_mean", "pull_mean", "push_middle", "push_min", "push_max"):
                size = max(abs(float(wanted["push_min"])), abs(float(wanted["push_max"])))
            # the rods of the page are solved to 1e-8, and known at stations
            assert found[name] == pytest.approx(float(wanted[name]), abs=1e-6 * max(size, 1e-9)), name


def test_the_strain_that_the_page_warns_of_is_that_of_the_workbench() -> None:
    thin = {"E": 2e7, "nu": 0.3, "a": 1e-3, "R": 0.75, "L": 20.0, "beta": 1.2, "dbeta": 0.05, "M3": 0.0}
    states = [*STARTS, {"units": {"length": "cm", "force": "N"}, "base": thin}]
    script = """answer(given.map((state) => {
      const shape = rod_shape.marched(core, rod_case.caseOf(state, {}));
      return numbers.warnings(shape, numbers.observables(shape), state.units, []); }));"""
    counts = set()
    for made, found in zip(states, run(script, states, (*MODULES, "numbers")), strict=True):
        told = caution_words.parts(str(caution_words.of_cases(solve(case_of(made)), units=made["units"])))
        wanted = [f"The rod {caution_words.phrase(part)}." for part in told if part.startswith("strained")]
        assert [words for words in found if "strained" in words] == wanted
        counts.add(len(wanted))
    assert counts == {0, 1}


def test_the_page_tells_lift_off_next_to_the_ends_alone_where_the_solver_does() -> None:
    script = """answer(given.map(({ state, arrays, facts }) => {
      const rows = Object.entries(arrays).map(([name, row]) => [name, Float64Array.from(row)]);
      const shape = rod_shape.interpolated(core, rod_case.caseOf(state, {}), Object.fromEntries(rows), facts);
      return numbers.warnings(shape, numbers.observables(shape), state.units, []); }));"""
    rods = [(made, page_model.shape(page_model.study_of(made))) for made in (state("pipe"), state())]
    given = [{"state": made, **(answer := page_model.answer(rod)), "facts": answer | {"sound": True, "shown": 1}}
             for made, rod in rods]  # fmt: skip
    said = run(script, finite(given), (*MODULES, "numbers"))
    alone = [any("next to its ends alone" in text for text in texts) for texts in said]
    cautions = [caution_words.parts(str(caution_words.of_cases(rod.sol))) for _, rod in rods]
    assert alone == [any(caution_words.AT_ENDS in part for part in parts) for parts in cautions] == [True, False]


def test_the_ribbon_is_as_tall_as_the_push_is_strong_and_arrows_point_as_the_cylinder_pushes() -> None:
    script = f"""{SHAPE}
    const all = [...shape.s.keys()], largest = Math.max(...shape.push.map(Math.abs)),
      corners = (kind) => push_marks.pushMarks(kind, shape, all, 1, largest).corners;
    answer([corners("ribbon"), corners("arrows"), shape.push.map((v) => v / largest), push_marks.tallest(one)]);"""
    ribbon, arrows, share, tall = run(script, state(), (*MODULES, "push_marks"))
    ribbon = np.reshape(ribbon, (-1, 2, 7))  # x, y, z, normal, share of the largest push
    np.testing.assert_allclose(np.diff(np.hypot(*ribbon.T[:2]), axis=0)[0], np.abs(share) * tall, atol=1e-6)
    np.testing.assert_allclose(ribbon[:, 1, 6], share, atol=1e-6)
    rings = np.reshape(arrows, (-1, 5, 8, 7))[..., [0, 1, 2, 6]]  # of each arrow, from the rod outward
    widest = np.linalg.norm(rings[:, :, 0, :3] - rings[:, :, 4, :3], axis=-1).argmax(axis=1)
    pushes = rings[:, 0, 0, 3] > 0
    assert {*pushes} == {True, False}
    np.testing.assert_array_equal(widest, np.where(pushes, 3, 1))  # the ring before the tip


def test_which_rods_pass_through_themselves() -> None:
    states = [*STARTS, state(E=5.35e4), state(L=4.0), state("dna", dgamma=0.0), state("dna", beta=-1.52)]
    script = """
    const solved = (state) => rod_shape.marched(core, rod_case.caseOf(state, {}));
    answer(given.map((state) => self_contact.crossings(solved(state)).length > 0));"""
    found = run(script, states, (*MODULES, "self_contact"))
    wanted = [bool(observe(solve(case_of(made)), ["overlaps"])["overlaps"]) for made in states]
    tight = [
        float(observe(solve(case_of(made)), ["kappa_max"])["kappa_max"]) * float(case_of(made).rod.a) >= 1
        for made in states
    ]
    assert [one or bent for one, bent in zip(found, tight, strict=True)] == wanted
    assert {True, False} == set(wanted)


TIGHT = state(E=900.0, L=8.0)  # six bends of 0.41 of its radius at the least, each in one of eight overlaps
CUT = state(E=5000.0)  # its last bend is tighter than the rod, and in no overlap


@pytest.mark.parametrize(("made", "count"), [(state(), 5), (TIGHT, 8), (CUT, 8)])
def test_a_rod_is_ringed_where_the_stills_ring_it(made: dict, count: int) -> None:
    script = SHAPE + "const crossed = self_contact.crossings(shape);"
    script += "answer([...crossed, ...self_contact.tightBends(shape, crossed)]);"
    found = np.array(run(script, made, (*MODULES, "self_contact")))
    line = StoredStudy(solve(case_of(made), stations=2001).to_dataset()).centreline
    wanted = np.array(solid_body.middles(line, (0.0, line.L)))
    away = np.linalg.norm(found[:, None] - wanted, axis=-1)
    assert len(wanted) == len(found) == count
    assert away.min(axis=0).max() < 0.2 * line.a


def test_a_core_that_is_new_keeps_its_memory_whole() -> None:
    """Rows of densities had less room than the core fills: a first shape ended in a fault."""
    script = """
    const one = rod_case.caseOf(given.state, {}), fresh = await RodCore.load(fs.readFileSync(given.core));
    answer(rod_shape.marched(fresh, one).beta);"""
    given = {"state": TIGHT, "core": str(build.HERE / build.WASM)}
    found = run(script, given, MODULES)
    assert found == run(SHAPE + "answer(shape.beta);", TIGHT, MODULES)


def test_peaks_and_zeros_of_the_push_are_stations_so_that_equal_peaks_are_drawn_equal() -> None:
    script = (
        SHAPE + "const [{ y }] = curves.diagrams(shape, given.units).filter(({ key }) => key === 'push'); answer(y);"
    )
    push = np.array(run(script, state(), (*MODULES, "curves")))
    inner = push[1:-1]
    peaks = inner[(inner > push[:-2]) & (inner > push[2:]) & (inner > 100)]
    highest = peaks[peaks > 170]
    assert len(highest) == 6
    np.testing.assert_allclose(highest, observe(solve(case_of(state())), ["push_max"])["push_max"], rtol=1e-8)
    change = np.flatnonzero(np.diff(np.sign(push)))
    assert len(change) == 18
    # a zero is found on quintics between every third station
    assert np.minimum(np.abs(push[change]), np.abs(push[change + 1])).max() < 1e-5 * highest.max()


def test_beside_an_unstable_equilibrium_the_shape_is_marched_whole() -> None:
    made = state(E=1.07e4)
    made.pop("reading")
    made["base"] = {**small.ROD, "E": 1e4, "nu": 0.3, "beta": math.pi, "dbeta": 1e-9, "M3": 0.0, "F3": 10.0}
    script = SHAPE + (
        "const { end } = core.solve(rod_case.reduced(one), 1e-8, Float64Array.of(1));"
        "answer([end, shape.s, shape.beta, shape.z, shape.condition, shape.error]);"
    )
    end, s, beta, z, condition, error = run(script, made, MODULES)
    assert end == "marched"
    sol = solve(case_of(made), 1e-10, stations=np.array(s))
    assert sol.solved
    np.testing.assert_allclose(beta, sol.beta, atol=max(error, 1e-9))
    np.testing.assert_allclose(z, sol.z, atol=20 * max(error, 1e-9))
    assert condition == pytest.approx(float(sol.condition), rel=0.5)


FOLLOWED = """
    const from = rod_case.caseOf(given.from, {}), one = rod_case.caseOf(given.to, {});
    const shape = rod_shape.moved(core, one, { ...given.seed, one: from });
    answer(shape && [shape.s, shape.beta, shape.dbeta, shape.alpha, shape.z, shape.error]);"""


def follow_in_page(began: Solution, before: dict, to: dict) -> tuple[np.ndarray, ...]:
    """s, beta, dbeta, alpha, z and error of the rod to which the page follows another one."""
    seed = {name: getattr(began, name).tolist() for name in ("s", "beta", "dbeta")}
    return tuple(np.array(row) for row in run(FOLLOWED, {"from": before, "to": to, "seed": seed}, MODULES))


@pytest.mark.parametrize("name, field, value", [("pipe", "FZ", -230.0), ("pipe", "R", 0.12), ("cable", "R", 190.0)])
def test_between_two_ends_the_page_follows_the_equilibrium_as_the_solver_does(name, field, value) -> None:
    began, to = page_model.shape(page_model.study_of(STATES[name])).sol, state(name, **{field: value})
    s, beta, dbeta, alpha, z, error = follow_in_page(began, STATES[name], to)
    there = solve(case_of(to), 1e-10, stations=s, seed=began)
    assert there.solved
    assert error < 1e-12
    for mine, wanted in ((beta, there.beta), (dbeta, there.dbeta), (alpha, there.alpha), (z, there.z)):
        np.testing.assert_allclose(mine, wanted, atol=1e-9 * np.abs(wanted).max())


def test_a_shape_is_followed_over_a_change_of_its_load_by_a_factor_of_five() -> None:
    base = {"E": 9.58e7, "nu": 0.3, "a": 0.0635, "L": 100.0, "R": 0.10795, "side": "inside", "beta0": 0.0, "betaL": 0.0,
            "FZ": -200.0, "MZ": 0.0, "M3": 0.0}  # fmt: skip
    made = {"units": {"length": "m", "force": "kN"}, "base": base}
    began = page_model.shape(page_model.study_of(made)).sol
    s, beta, *_, error = follow_in_page(began, made, made | {"base": base | {"FZ": -1000.0}})
    assert error < 1e-9
    assert np.degrees(np.ptp(beta)) == pytest.approx(1.629, abs=5e-4)
    middle = np.interp(50.0, s, beta) / np.interp(50.0, began.s, began.beta)
    assert middle == pytest.approx(np.sqrt(5), rel=2e-3)  # Lubinski's helix, but for the ends and the second order


def test_a_slider_follows_the_equilibrium_it_began_with() -> None:
    base = {"E": 5e3, "nu": 0.25, "a": 0.25, "L": 12.0, "R": 0.75, "side": "outside", "beta0": 0.5, "betaL": 0.8,
            "FZ": -5.0, "MZ": 1.0, "M3": 2.0}  # fmt: skip
    made = {"units": {"length": "cm", "force": "N"}, "base": base}
    third = page_model.list_equilibria(page_model.study_of(made))[2]
    named = made | {"equilibrium": {name: third[name] for name in ("dbeta0", "energy")}}
    began, wider = page_model.shape(page_model.study_of(named)).sol, made | {"base": base | {"R": 0.76}}
    s, beta, *_ = follow_in_page(began, made, wider)
    assert np.abs(beta - np.interp(s, began.s, began.beta)).max() < 0.2
    assert np.abs(page_model.shape(page_model.study_of(wider)).sol.beta - began.beta).max() > 0.5


def test_a_shape_too_far_from_the_one_before_is_not_followed_silently() -> None:
    script = (
        "const one = rod_case.caseOf(given.to, {}), s = [0, one.L / 2, one.L];"
        "const beta = [one.beta0, one.beta0 + 9, one.betaL], dbeta = [0, 0, 0];"
        "answer(rod_shape.moved(core, one, { s, beta, dbeta, one }));"
    )
    assert run(script, {"to": STATES["cable"]}, MODULES) is None


def test_a_rod_of_many_bends_gets_more_stations_and_a_very_long_one_is_shown_in_part() -> None:
    script = """
    const part = (shape, found) => [shape.s, shape.beta, shape.shown,
      numbers.rowsOf(shape, found).map(([name]) => name),
      numbers.warnings(shape, found, { length: "cm", force: "N" })];
    const shapes = given.map((state) => rod_shape.marched(core, rod_case.caseOf(state, {})));
    answer(shapes.map((shape) => part(shape, numbers.observables(shape))));"""
    many, part = run(script, [state(L=200.0), state(L=2e4)], (*MODULES, "numbers"))
    assert np.abs(np.diff(many[1])).max() < 0.26
    assert many[2] == 1
    assert 0.05 < part[2] < 0.2
    assert part[0][-1] == pytest.approx(2e4 * part[2])
    assert {"bends", "height", "push_max"} < {*many[3]}
    assert part[3] == ["FZ", "MZ", "M3", "bend_number", "lift_off_at"]  # the others of a part are not those of the rod
    examined = ["self-contact" not in " ".join(one[4]) for one in (many, part)]
    assert examined == [True, False]


@pytest.mark.parametrize(
    "made",
    [
        state() | {"let_go": True},
        state("pipe", L=20.0, weight=0.242, inclination=1.4, contact="unilateral", radius0=0.0, radiusL=0.02),
    ],
)
def test_off_the_wall_the_tube_is_about_the_places_of_the_solver_also_from_the_axis(made) -> None:
    """Each corner is a radius from them, and no line along the tube crosses it where its azimuth turns at once."""
    rod = page_model.shape(page_model.study_of(made))
    arrays, facts = page_model.stations(rod), finite(page_model.facts(rod))
    script = """
    const rows = Object.entries(given.arrays).map(([name, row]) => [name, Float64Array.from(row)]),
      arrays = Object.fromEntries(rows),
      facts = { ...given.facts, pointForces: given.facts.point_forces };
    const one = rod_case.caseOf(given.state, {}), shape = rod_shape.interpolated(core, one, arrays, facts);
    const all = Array.from(shape.s, (_, i) => i), marks = push_marks.contactMarks(shape, 1);
    answer([tube.tube(shape, all, 8, 1, 1), marks.corners, shape.gap]);"""
    given = {"state": made, "arrays": {name: row.tolist() for name, row in arrays.items()}, "facts": facts}
    corners, marks, gap = run(script, given, (*MODULES, "tube", "push_marks"))
    a, n = float(rod.sol.case.rod.a), arrays["s"].size
    rings = np.array(corners).reshape(-1, 7)[: 8 * n, :3].reshape(n, 8, 3)
    places, radius = rod.sol.position[::5], rod.sol.radius[::5]  # of which one of five is sent
    np.testing.assert_allclose(rings.mean(axis=1), places, atol=1e-6 * a)  # single precision
    np.testing.assert_allclose(np.linalg.norm(rings - places[:, None], axis=-1), a, rtol=1e-5)
    step = np.linalg.norm(np.diff(rings, axis=0), axis=-1)
    along = np.linalg.norm(np.diff(places, axis=0), axis=-1, keepdims=True)
    assert (step < along + 0.5 * a).all()  # a tube that is twisted between two rings has steps up to 2 a
    np.testing.assert_allclose(gap, rod.sol.gap[::5], atol=1e-12 * rod.sol.case.rho)
    surface = np.hypot(*np.array(marks).reshape(-1, 7)[-8:-4, :2].T).mean(), float(radius[np.argmax(gap)])
    assert surface[0] == pytest.approx(surface[1] - float(rod.sol.case.outward) * a, abs=0.1 * a)  # the line ends there


@pytest.mark.parametrize("name", ["table1", "dna"])
def test_the_tube_is_closed_touches_the_cylinder_and_is_as_near_as_it_says(name) -> None:
    tolerance = 0.003 * case_of(STATES[name]).rho
    script = (
        SHAPE
        + f"""
    const largest = Math.max(...shape.push), chosen = tube.rings(shape, {tolerance}, largest);
    const sides = tube.sidesFor(one.a, {tolerance});
    const corners = tube.tube(shape, chosen, sides, 1, largest), walls = tube.wallTriangles(chosen.length, sides);
    const ends = tube.endTriangles(chosen.length * sides, sides);
    answer([corners, [...walls, ...ends], Array.from(chosen, (i) => shape.s[i]), sides]);"""
    )
    corners, triangles, s, sides = run(script, STATES[name], (*MODULES, "tube"))
    points, normals = np.array(corners).reshape(-1, 7)[:, :3], np.array(corners).reshape(-1, 7)[:, 3:6]
    faces = np.array(triangles).reshape(-1, 3)
    _, at = np.unique(points.round(6), axis=0, return_inverse=True)
    edges = np.sort(at.reshape(-1)[faces[:, [0, 1, 1, 2, 2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    case = case_of(STATES[name])
    a, rho = float(case.rod.a), float(case.rho)
    assert np.hypot(points[:, 0], points[:, 1]).min() == pytest.approx(rho - a, rel=1e-5)
    corner = points[faces]
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    assert (np.einsum("ij,ij->i", across, normals[faces[:, 0]]) > 0).all()  # counterclockwise as seen from outside
    fine = np.linspace(0, s[-1], 4001)
    sol = solve(case, 1e-8, stations=fine)
    centre = frames.position(rho, sol.alpha, sol.z)
    drawn = points[: len(s) * sides].reshape(len(s), sides, 3)
    for j in (0, sides // 4, sides // 2):
        angle = 2 * np.pi * j / sides
        true = centre + a * (
            np.cos(angle) * frames.outward(sol.alpha) + np.sin(angle) * frames.binormal(sol.alpha, sol.beta)
        )
        straight = np.stack([np.interp(fine, s, drawn[:, j, k]) for k in range(3)], axis=-1)
        assert np.sqrt(((true - straight) ** 2).sum(axis=-1)).max() < tolerance


def test_a_lying_pipe_is_seen_from_the_side_of_the_stills() -> None:
    seen = run("answer(camera.LOW_SIDE_DOWN);", None, ("camera",))
    assert seen == pytest.approx(views.LOW_SIDE_DOWN)


def test_the_rings_are_where_the_rod_bends() -> None:
    script = (
        SHAPE + "const at = (row) => Array.from(tube.rings(shape, 0.004, 170), (i) => row[i]);"
        "answer([at(shape.s), at(shape.kappa)]);"
    )
    s, kappa = (np.array(row) for row in run(script, state(), (*MODULES, "tube")))
    gaps, tight = np.diff(s), (kappa[1:] + kappa[:-1]) / 2
    assert np.median(gaps[tight > 2.5]) < 0.5 * np.median(gaps[tight < 0.8])


def test_the_colours_are_those_of_the_one_table() -> None:
    values = np.linspace(-190, 190, 44)
    data = {"code": colours.for_pages(), "values": values.tolist()}
    found = run("answer(given.values.map((v) => colours.pushColour(given.code, v, 172)));", data, ("colours",))
    at, rows = zip(*colours.DIVERGING, strict=True)
    wanted = np.stack([np.interp(values / 172, at, row) for row in np.transpose(rows)], axis=-1)
    assert np.abs(np.array(found) - wanted).max() <= 0.5 + 1e-9
    grey = np.array(found) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(grey[values > 0])[:-2] < 0).all()  # darker with more push, in grey too
    assert (np.diff(grey[values < 0])[2:] > 0).all()


def test_the_scale_of_the_push_has_the_ends_and_the_words_of_the_stills() -> None:
    rods = [(-3.0, 172.3), (0.0, 7.0), (-2e-9, 11.0), (6.9, 7.0), (-90.0, -80.0), (0.0, 0.0), (-1e-300, 3e5)]
    script = """answer(given.rods.map((rod) => {
        const scale = colours.scaleOf(given.code, rod);
        return [scale.low, scale.end, colours.wordsOf(given.code, scale, "N/cm")];
    }));"""
    found = run(script, {"code": colours.for_pages(), "rods": rods}, ("colours",))
    for rod, (low, end, words) in zip(rods, found, strict=True):
        paint = scene_kinds.by_push({"force": "N", "length": "cm"}, rod)
        shown = pytest.approx([paint.foot, paint.high]), paint.label
        assert ([low, end], words) == shown if paint.label else end == 0, rod


def test_the_shadow_on_the_wall_is_that_of_the_stills() -> None:
    script = (
        SHAPE
        + """
    const wall = tube.cylinder(shape, 1), look = given.look, map = light.wallLight(shape, 1, wall, look, false);
    answer([map.width, map.height, wall.low, wall.high, Array.from(map.bytes)]);"""
    )
    look = colours.for_pages()
    width, height, low, high, light = run(script, state() | {"look": look}, (*MODULES, "tube", "light"))
    sol = solve(case_of(state()), stations=4001)
    turn = 2 * np.pi * (np.arange(width) + 0.5) / width
    z = low + (high - low) * (np.arange(height) + 0.5) / height
    grid = np.stack(np.broadcast_arrays(0.75 * np.cos(turn), 0.75 * np.sin(turn), z[:, None]), axis=-1)
    curve = np.stack([np.cos(sol.alpha), np.sin(sol.alpha), sol.z]).T
    wanted = surfaces.light_on_wall(grid.reshape(-1, 3), curve, 0.25)
    assert np.abs(np.array(light) / 255 - wanted).max() < 0.02


def test_the_light_on_the_rod_beside_its_other_stretches_is_that_of_the_pictures() -> None:
    script = f"""{SHAPE}
    const rings = [...shape.s.keys()], sides = 12,
      frames = rings.map((i) => tube.frameAt(shape, i, 1, 0));
    answer([rings.map((i) => shape.s[i]), frames.map((f) => [f.x, f.y, f.z, f.ox, f.oy, f.bx, f.by, f.bz]),
      light.coveredTube(shape, rings, sides, 1)]);"""
    s, frames, covered = run(script, state(), (*MODULES, "tube", "light"))
    x, y, z, ox, oy, bx, by, bz = np.array(frames).T
    around = 2 * np.pi * np.arange(12)[:, None] / 12
    normals = np.stack([np.cos(around) * p + np.sin(around) * q for p, q in ((ox, bx), (oy, by), (0 * ox, bz))])
    light = surfaces.light_on_tube(
        np.array(s), np.stack([x, y, z]).T, normals.T, np.stack([ox, oy, 0 * ox]).T, 0.25, True
    )
    wanted = (1 - light) / colours.DEPTH
    found = np.minimum(np.reshape(covered, wanted.shape), 1)
    assert found.max() > 0.3
    assert np.abs(found - wanted).max() < 0.05


@pytest.mark.parametrize(
    ("ends", "count", "values"),
    [
        ((-4.9, 4.9), 4, [-4, -2, 0, 2, 4]),
        ((-0.05, 0.83), 4, [0, 0.2, 0.4, 0.6, 0.8]),
        ((-4.4, 4.4), 3, [-4, -2, 0, 2, 4]),
    ],
)
def test_an_axis_of_the_page_has_two_numbers_at_least_and_as_many_as_have_room(ends, count, values) -> None:
    found = run("answer(text.ticks(...given))", [*ends, count], modules=("text",))
    np.testing.assert_allclose(found, values, atol=1e-12)
    for span in np.geomspace(1, 10, 40):
        for low in np.linspace(-span, 0.0, 12):
            found = run("answer(text.ticks(...given))", [low, low + span, count], modules=("text",))
            assert 2 <= len(found) <= max(count + 1, 5)


def test_numbers_and_units_are_written_as_in_the_figures() -> None:
    values = [0.0, 10910.0, 0.625, -0.00031416, 123456.0, 3.0000004]
    found = run("answer(given.map((v) => text.number(v)));", values, ("text",))
    assert [one.replace("−", "-") for one in found] == [labels.number(v) for v in values]
    beside = [0.61973, 3.984, 4.3501, 0.0, -12.0], [6.58, 7.197, 0.0], [3.0, 4.0], [2.5e-10, 1.2, 1.25]
    found = [run("answer(text.alike(given));", row, ("text",)) for row in beside]
    assert [[one.replace("−", "-") for one in row] for row in found] == [labels.alike(row) for row in beside]
    plain = ["2.5e−10", "1e6", "9.58", "−3.25e−6"]
    printed = run("answer(given.map((v) => text.powers(v)));", plain, ("text",))
    assert printed == [labels.minus_signs(labels.powers_of_ten(one.replace("−", "-"))) for one in plain]
    units = {"length": "cm", "force": "N"}
    rows = {name: row.dimension for name, row in QUANTITIES.items()}
    told = run(
        "answer(Object.values(given.rows).map((d) => text.unitText(d, given.units)));",
        {"rows": rows, "units": units},
        ("text",),
    )
    for name, unit in zip(rows, told, strict=True):
        assert unit == labels.unit(unit_of(name, units)).replace("rad", "°" if rows[name] == "rad" else "rad"), name


@pytest.mark.parametrize("units", [("ft", "klbf"), ("ft", "lbf"), ("in", "kip"), ("m", "kN"), ("mm", "N"), ("cm", "N")])
def test_pages_labels_and_tables_state_every_quantity_in_one_unit(units: tuple[str, str]) -> None:
    system = dict(zip(("length", "force"), units, strict=True))
    rows = {name: row.dimension for name, row in QUANTITIES.items() if row.dimension != "text"}
    given = {"rows": [*rows.items()], "units": system}
    told = run("answer(given.rows.map(([name, d]) => text.stated(d, given.units, name)));", given, ("text",))
    for name, (unit, size) in zip(rows, told, strict=True):
        array = xr.DataArray(1.0, name=name, attrs=quantity_variables.labels(name, system))
        assert size == pytest.approx(float(labels.in_label_unit(array, 1.0)), rel=1e-12), name
        assert labels.label(array).endswith(f" [{unit}]" if unit else labels.symbol(array)), name
        if unit != "°":
            assert labels.unit(unit_habits.unit_shown(name, system)) == unit, name
            assert size == pytest.approx(unit_habits.size_shown(name, system), rel=1e-12), name


@pytest.mark.parametrize("name", STATES)
def test_the_copied_study_is_the_case_of_the_state(name) -> None:
    text = run("answer(study_text.studyText(given));", STATES[name], ("study_text",))
    study = loads(text)
    assert study.unit_system == STATES[name]["units"]
    for part in ("rod", "cylinder", "given"):
        mine, wanted = getattr(study.case(), part), getattr(case_of(STATES[name]), part)
        assert vars(mine) == vars(wanted)


def test_a_link_holds_the_whole_state() -> None:
    data = {"preset": "dna", "state": state("dna") | {"title": "β – ∞"}}
    assert run("answer(study_text.fromHash(study_text.toHash(given)));", data, ("study_text",)) == data


def test_push_and_pull_are_shaded_as_in_the_figures() -> None:
    ds = solve(case_of(state()), stations=401).to_dataset()
    ax = Figure().add_subplot()
    along_rods.alone(ax, drawn_rods.choose(StoredStudy(ds), ["push"]), "push")
    labels = push_scale.PULLS, push_scale.PUSHES
    bands, areas = [one.get_facecolor()[0] for name in labels for one in ax.collections if one.get_label() == name]
    band, area = run("answer([diagram.BAND, diagram.AREA]);", None, ("diagram",))
    np.testing.assert_allclose(bands, [*np.array(colours.rgb(colours.PULLED)) / 255, band])
    np.testing.assert_allclose(areas, [*np.array(colours.rgb(colours.PUSHED)) / 255, area])


@pytest.mark.parametrize("name", ["dna", "pipe"])
def test_the_curve_of_a_winding_rod_begins_where_its_dot_stands_whichever_way_it_winds(name: str) -> None:
    script = """
    const one = rod_case.caseOf(given.state, {}), rows = Object.entries(given.arrays),
      arrays = Object.fromEntries(rows.map(([name, row]) => [name, Float64Array.from(row)])),
      [view] = curves.diagrams(rod_shape.interpolated(core, one, arrays, given.facts), given.state.units);
    answer([view.y.slice(0, 3), view.jump, view.cursor({ z: 0, alpha: arrays.alpha[0] })]);"""
    answer = page_model.answer(page_model.shape(page_model.study_of(STATES[name])))
    given = {"state": STATES[name], "arrays": answer["arrays"], "facts": answer | {"sound": True, "shown": 1}}
    y, jump, cursor = run(script, finite(given), (*MODULES, "curves"))
    assert np.abs(np.diff(y)).max() < jump / 5
    assert cursor[1] == y[0]


def test_a_letter_of_the_triad_stands_on_no_arm() -> None:
    script = "answer(given.map(([place, arm]) => stage.clearOf(place, arm)));"
    up = [0, -0.9]
    places = run(script, [[[0, -12], up], [[-3, -12], up], [[12, 0], up], [[0, -40], up]], ("stage",))
    assert [abs(x) for x, _ in places] == [9, 9, 12, 0]
    assert places[1][0] < 0  # to the side on which it stood
    assert [y for _, y in places] == [-12, -12, 0, -40]


def test_the_potential_and_the_level_are_the_solvers() -> None:
    script = (
        SHAPE + "const [well] = curves.diagrams(shape, given.units).filter(({ key }) => key === 'well');"
        "answer([well.x, well.y, well.level, well.ranges]);"
    )
    x, y, level, ranges = run(script, state(), (*MODULES, "curves"))
    sol = solve(case_of(state()))
    np.testing.assert_allclose(
        y, potential(sol.problem, np.radians(x)) / float(sol.case.rho) ** 2, rtol=1e-12, atol=1e-12
    )
    assert level == pytest.approx(float(sol.h[0]), rel=1e-9)
    assert len(ranges) == 1  # it passes 180 degrees, and is drawn as one range within one rotation
    np.testing.assert_allclose(ranges[0], np.degrees([sol.beta.min(), sol.beta.max()]), atol=0.5)
    assert x[0] < ranges[0][0] < ranges[0][1] < x[-1] == pytest.approx(x[0] + 360)
    allowed = np.interp(np.concatenate(ranges), x, y)
    assert (allowed <= level + 0.01 * np.ptp(y)).all()


def test_the_state_of_a_held_rod_is_the_ends_problem_of_its_own_shape() -> None:
    script = (
        SHAPE + "const { energy } = numbers.observables(shape);"
        "answer(rod_case.heldState(given, one, shape.beta.at(-1), { dbeta0: shape.dbeta[0], energy }));"
    )
    held = run(script, state(), (*MODULES, "numbers"))
    first = page_model.shape(page_model.study_of(state()))
    study = page_model.study_of(held)
    assert isinstance(study.case().given, Ends)
    found = page_model.shape(study)
    np.testing.assert_allclose(found.sol.beta[::2], first.sol.beta, atol=1e-7)
    rows = page_model.list_equilibria(study)
    assert min(abs(row["dbeta0"] - 0.5) for row in rows) < 1e-7
