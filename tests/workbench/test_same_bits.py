"""Every kind of study has the same bits in any chunks, by any workers, in memory, and where its run was stopped."""

from pathlib import Path

import pytest
import xarray as xr

from studies import Study
from studies.language.loader import loads
from tests.slow import slow_but
from tests.workbench import runs, small
from workbench.store import in_memory
from workbench.store.study_store import Options, run_to_file

PIPE = {"E": 2.06e8, "inner_radius": 0.0543, "nu": 0.3, "a": 0.0635, "L": 20.0, "R": 0.108, "side": "inside"}
SNAP = {"E": 325.95, "nu": 0.25, "a": 0.25, "R": 0.75, "L": 5.0, "beta0": 0.5, "betaL": 0.5}
SEEN = {"observables": ["amplitude", "height", "index"], "outputs": ["beta"], "stations": 21}
KEYS = {"reading": "force-first/tension/paper", "observables": ["turns", "wraps"], "outputs": ["beta", "z"]}
TWO_RODS = small.axis("E", [325.95, 651.9])


def table_1(tables: str) -> Study:
    return loads(small.text({}, tables, stations=11, **KEYS), "text", "table")


def pushed(axes: str) -> Study:
    """A pipe pushed down its hole."""
    return loads(small.text(PIPE | {"beta0": 0.0, "betaL": 0.0}, axes, "m kN", **SEEN), "text", "pushed")


def snapping(count: int, tables: str = "") -> Study:
    """A rod that snaps through, followed beyond its fold."""
    axes = small.axis("FZ", (2.0, -3.0, count), follow=True) + tables
    return loads(small.text(SNAP, axes, **SEEN), "text", "snapping")


SAMPLES = '[sample]\nsize = 40\nseed = 3\nE = { from = 5e3, to = 4e4, distribution = "log-uniform" }\n'
PLANE = "[base]\nL = 6.0\n" + small.axis("E", (5e3, 4e4, 5), spacing="geometric") + small.axis("R", (0.5, 1.5, 4))
EXPRESSIONS = '[expressions]\nshare = "turns/wraps"\ngap = "1/(F1 - 5*N)"\n'  # which has no value in the middle
STUDIES = {
    "grid": table_1(EXPRESSIONS + small.axis("E", (5e3, 4e4, 3)) + small.axis("F1", (1.0, 9.0, 13))),
    "samples": table_1(SAMPLES + "R = { from = 0.5, to = 1.5 }\n"),
    "refined": table_1(PLANE + '[refine]\nwatch = ["turns"]\npoints = 15\n' + small.law("turns", "E", "falls")),
    "sweep": pushed(small.axis("FZ", (-60.0, -40.0, 11))),
    "sweep of a grid": pushed(small.axis("L", [19.0, 20.0, 21.0]) + small.axis("FZ", (-60.0, -50.0, 9))),
    "followed": snapping(11),
    "followed in blocks": snapping(41),
    "followed lines": snapping(41, TWO_RODS),
}
WAYS = {"cut": Options(workers=1, chunk=1), "pool": Options(workers=2, chunk=16)}
QUICK = ("grid", "samples", "refined", "sweep", "followed")

small_blocks = runs.small_blocks(16)


@pytest.fixture(scope="module")
def whole(small_blocks, tmp_path_factory) -> dict[str, Path]:
    """The file of each study, by one process in one go; made where it is first needed."""
    folder = tmp_path_factory.mktemp("whole")

    class Files(dict[str, Path]):
        def __missing__(self, name: str) -> Path:
            self[name] = folder / f"{name}.h5"
            run_to_file(STUDIES[name], self[name], Options(workers=1, chunk=10_000))
            return self[name]

    return Files()


@pytest.mark.parametrize("way", slow_but(WAYS, "cut"))
@pytest.mark.parametrize("name", slow_but(STUDIES, *QUICK))
def test_every_bit_is_the_same_whatever_the_chunks_and_the_workers(whole, tmp_path, name: str, way: str) -> None:
    run_to_file(STUDIES[name], tmp_path / "one.h5", WAYS[way])
    assert runs.contents(tmp_path / "one.h5") == runs.contents(whole[name])
    assert [path.name for path in tmp_path.iterdir()] == ["one.h5"]


@pytest.mark.parametrize("name", slow_but(STUDIES, *QUICK))
def test_a_study_in_memory_has_the_bits_of_the_stored_one(whole, name: str) -> None:
    ds = in_memory.run(STUDIES[name])
    with xr.open_dataset(whole[name]) as stored:
        assert list(stored.dims) == list(ds.dims)
        xr.testing.assert_identical(stored.load().drop_attrs(deep=False), ds.drop_attrs(deep=False))
        assert {**ds.attrs, "created": ""}.items() <= {**stored.attrs, "created": ""}.items()


IN_ONE_BLOCK = "sweep of a grid"
STOPPED = [*((name, 1) for name in STUDIES if name != IN_ONE_BLOCK), ("refined", 40), ("refined", 120)]


@pytest.mark.parametrize("stopped", slow_but(STOPPED, *((name, 1) for name in QUICK)))
def test_a_run_that_is_stopped_goes_on_to_the_same_bits(whole, tmp_path, stopped: tuple[str, int]) -> None:
    name, after = stopped
    path, expected = tmp_path / "one.h5", runs.contents(whole[name])
    with pytest.raises(KeyboardInterrupt, match="cases are kept in"):
        run_to_file(STUDIES[name], path, Options(workers=1, chunk=8), progress=runs.stop_after(after))
    assert not path.exists()
    done = run_to_file(STUDIES[name], path, Options(workers=1))
    assert 0 < done.solved < sum(done.statistics["outcomes"].values())
    assert runs.contents(path) == expected
    assert run_to_file(STUDIES[name], path).finished_before
    assert [path.name for path in tmp_path.iterdir()] == ["one.h5"]
