"""Long rods in lines: the developed curve of a pipe of 300 m in a hole of 0.2 m, all of it, at one scale."""

import numpy as np
import pytest
import xarray as xr

from solver import solve
from studies import load
from studies.language.loader import loads
from tests.workbench import small, stored_figures
from workbench.figures import drawn_numbers, one_rod, unrolled, waves
from workbench.figures.drawn_rods import DrawnRod
from workbench.figures.fonts import SMALL
from workbench.figures.sheet import sheet
from workbench.geometry import varying_lines
from workbench.run import in_memory
from workbench.stored.stored_study import StoredStudy

PIPE = {"E": 2.06e8, "nu": 0.3, "a": 0.06, "R": 0.11, "side": "inside", "beta0": 0.0, "betaL": 0.0, "FZ": -2000}
OUTPUTS = ["beta", "alpha", "z", "contact"]
KEYS = {"units": "m kN", "observables": ["turns_around"], "outputs": OUTPUTS, "stations": 4001}
ROOM = (8.0, 4.0)


@pytest.fixture(scope="module")
def pipe() -> xr.Dataset:
    return in_memory.run(loads(small.text({**PIPE, "L": 300}, **KEYS)))


def helix(length: float, pitch: float, rho: float = 0.05) -> DrawnRod:
    s = np.linspace(0, length, 2001)
    beta = np.arctan2(2 * np.pi * rho, pitch)
    arrays = {"s": s, "z": s * np.cos(beta), "alpha": s * np.sin(beta) / rho, "push": np.ones(s.size)}
    return DrawnRod("rod", "", arrays, rho, rho, "", StoredStudy(xr.Dataset()))


def test_waves_that_are_rounding_beside_the_range_of_a_curve_are_no_band() -> None:
    x = np.linspace(0, 1, 4001)
    for size, bands in ((1e-3, 0), (1e-1, 1)):
        y = np.exp(-20 * x) + size * np.sin(2000 * x) * (x > 0.5)
        assert sum(part.band is not None for part in waves.stretches(x, y, 6.0)) == bands


def test_each_edge_of_many_contacts_has_its_place() -> None:
    s = np.linspace(0, 15, 3001)
    push = np.maximum(np.sin(2 * np.pi * (s + 0.25)), 0)
    edges = np.arange(0.25, 15, 0.5)
    np.testing.assert_allclose(varying_lines.contact_edges(s, push), edges, atol=s[1])
    assert not varying_lines.contact_edges(s, push - 0.1).size  # held on


def test_only_a_rod_that_would_be_a_hair_is_set_in_lines() -> None:
    assert unrolled.lines_of(helix(300, 9.0), ROOM, SMALL) is not None
    assert unrolled.lines_of(helix(5, 9.0), ROOM, SMALL) is None  # 25 diameters high
    assert unrolled.lines_of(helix(300, 0.3), ROOM, SMALL) is None  # as wide as it is high: it is seen in one piece


def test_a_rod_in_lines_has_a_ring_at_each_place_where_it_passes_through_itself() -> None:
    long = loads(load("fig6").text.replace("L = 20.0", "L = 800.0"))
    sol = solve(long.case(), stations=16001)
    rho, a = float(sol.case.rho), 0.25
    arrays = {"s": sol.s, "z": sol.z, "alpha": sol.alpha, "push": sol.push}
    curve = DrawnRod("rod", "", arrays, rho, a, "overlaps", StoredStudy(xr.Dataset()))
    found = unrolled.lines_of(curve, ROOM, SMALL)
    assert found is not None
    every = unrolled.crossings(sol.s, rho, sol.alpha, sol.z, a, rho)
    assert len(every) > 100
    assert sum(len(view.rings) for view in found.views) == len(every)
    for view in found.views:
        line = np.hstack([(view.x, view.y), *((x, y) for x, y, _, _ in view.over)])
        assert all(np.linalg.norm(line - place[:, None], axis=0).min() < 1.1 * a for place, _, _ in view.rings)


def test_the_lines_show_all_of_a_rod_each_from_where_the_one_above_ends() -> None:
    curve = helix(300, 9.0)
    found = unrolled.lines_of(curve, ROOM, SMALL)
    assert found is not None
    parts = [[view.x, *(x for x, *_ in view.over)] for view in found.views]
    ends = [(x[0][0], x[-1][-1]) for x in parts]
    assert ends[0][0] == 0
    assert ends[-1][1] == pytest.approx(curve["z"][-1])
    assert [first for first, _ in ends[1:]] == pytest.approx([last for _, last in ends[:-1]])
    low, high = found.views[0].band
    assert found.form.scale * (high - low) >= unrolled.THINNEST
    assert found.height <= ROOM[1] * (1 + 1e-9)
    assert found.before + found.form.scale * max(last - first for first, last in ends) <= ROOM[0] * (1 + 1e-9)
    assert [view.begins for view in found.views] == [True, *[False] * (len(ends) - 1)]
    fewer = unrolled.lines_of(curve, (1.5, 1.2), SMALL)  # no room for all
    assert fewer is not None
    shown = sum(view.x[-1] - view.x[0] + sum(x[-1] - x[0] for x, *_ in view.over) for view in fewer.views)
    assert shown < 0.9 * curve["z"][-1]
    last = fewer.views[-1]
    assert (last.over[-1][0] if last.over else last.x)[-1] == pytest.approx(curve["z"][-1])
    assert f"only {len(fewer.views)} pieces of " in fewer.in_lines


def test_each_point_of_a_line_is_on_the_rod_and_inside_the_line(pipe) -> None:
    fig = one_rod.figure(StoredStudy(pipe), sheet=sheet(panel="curve"))
    (ax,) = fig.axes
    assert ax.get_aspect() == 1.0
    fig.draw_without_rendering()
    z, across = pipe["z"].values, float(pipe["rho"]) * pipe["alpha"].values
    low, high = sorted(ax.get_ylim())
    turn = 2 * np.pi * float(pipe["rho"])
    rows = list(drawn_numbers.rows(ax))
    points = np.array([row[2:4] for row in rows if row[0] == "line" and row[4] != ""], dtype=float)
    assert np.ptp(points[:, 0]) == pytest.approx(np.ptp(z))  # from end to end
    off = points[:, 1] - np.interp(points[:, 0], z, across)
    assert (
        np.abs(off / turn - np.round(off / turn)).max() < 1e-3
    )  # on some turn; between stations the reference is straight
    for drawn in ax.collections:
        for path in drawn.get_paths() if drawn.get_array() is not None else []:
            y = ax.transData.inverted().transform(drawn.get_transform().transform(path.vertices))[:, 1]
            assert low <= y.min()
            assert y.max() <= high


def test_a_long_rod_in_lines_shows_what_is_stored(pipe) -> None:
    pictures = {
        "alone": lambda: one_rod.figure(StoredStudy(pipe), sheet=sheet(panel="curve")),
        "in a column": lambda: unrolled.figure(StoredStudy(pipe), sheet=sheet("paper", 89)),
        "on a page": lambda: unrolled.figure(StoredStudy(pipe), sheet=sheet("paper", 183, titled=False)),
    }
    stored_figures.check("pictures_long_rods", pictures)


def test_the_rounding_of_a_level_curve_is_no_band_of_waves() -> None:
    x = np.linspace(0, 1, 2001)
    assert any(part.band for part in waves.stretches(x, 160 + np.sin(3000 * x), 5.0))
    assert not any(part.band for part in waves.stretches(x, 160 * (1 + 1e-13 * np.sin(3000 * x)), 5.0))
