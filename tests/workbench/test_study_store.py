"""A study in chunks: the same bits however it is cut, whoever solves it, and however it grew."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from solver import InputError, solve
from studies import load
from studies.language.loader import loads
from studies.language.study import OUTPUTS
from tests.raising import LENGTHS, make_raise
from tests.slow import slow, slow_but
from tests.workbench import runs, small
from workbench.run import block, dataset_assembly, in_memory, plan, recipe, run_and_resume, shards
from workbench.run.run_and_resume import RunOptions, run_to_file
from workbench.stored import boxes, case_solving, quantity_variables, schema

GRID = runs.grid(3, 50)  # 150 cases: blocks of 64, the last one short


small_blocks = runs.small_blocks(64)


@pytest.fixture(scope="module")
def whole(small_blocks, tmp_path_factory) -> Path:
    """The study in one chunk, in one process."""
    folder = tmp_path_factory.mktemp("whole")
    run_to_file(load(runs.study(folder, GRID)), folder / "many.h5", RunOptions(workers=1, chunk=10_000))
    return folder / "many.h5"


def kept(path: Path, monkeypatch) -> Path:
    """A run that is stopped when all is solved and nothing assembled: the folder of its shards."""

    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(dataset_assembly, "assemble", stopped)
        with pytest.raises(KeyboardInterrupt, match=r"cases are kept in .*\.parts; run .* to write the file"):
            run_to_file(load(path), path.with_suffix(".h5"), RunOptions(workers=1, chunk=64))
    return shards.folder_of(path.with_suffix(".h5"))


def cases_per_block(monkeypatch) -> list[int]:
    """How many cases each block has that is solved from now on."""
    found: list[int] = []
    block_of = block.block_of

    def counting(study: Any, part: block.Chunk) -> block.Columns:
        found.append(part.cases)
        return block_of(study, part)

    monkeypatch.setattr(block, "block_of", counting)
    return found


@given(st.lists(st.integers(1, 40), max_size=3), st.data())
@settings(max_examples=25, deadline=None)
def test_a_file_gives_each_box_of_a_grid_the_cases_that_it_holds_in_any_order(sizes: list[int], data) -> None:
    shape = tuple(sizes)
    held = [data.draw(st.permutations(range(n)))[: data.draw(st.integers(1, n))] for n in shape]
    places = [np.full(n, -1) for n in shape]
    for place, rows in zip(places, held, strict=True):
        place[rows] = np.arange(len(rows))
    flat = np.arange(int(np.prod(shape))).reshape(shape)
    values = flat[np.ix_(*held)] if shape else flat
    dims = [f"x{k}" for k in range(len(shape))]
    ds = xr.Dataset({"a": (dims, values), "b": ([*dims, "u"], np.stack([values, -values], axis=-1))})
    source = dataset_assembly.FileSource("file.h5", ds, ["a", "b"], places)
    met, most = list[int](), data.draw(st.integers(1, 50))
    for where in boxes.blocks(shape, most):
        start, stop = boxes.span(where, shape)
        assert stop - start <= most
        assert flat[where].ravel().tolist() == list(range(start, stop))
        piece = source.read(where)
        if piece is not None:
            assert (start + piece[0]).tolist() == piece[1]["a"].tolist() == (-piece[1]["b"][:, 1]).tolist()
            met += piece[1]["a"].tolist()
    assert met == sorted(values.ravel().tolist())


# what is asked for, and nothing else


class Watched:
    """A solution that notes which of its fields are read."""

    def __init__(self, sol: Any, read: set[str]) -> None:
        self._sol, self._read = sol, read

    @property
    def __class__(self) -> Any:
        return type(self._sol)

    def __getattr__(self, name: str) -> Any:
        self._read.add(name)
        return getattr(self._sol, name)


@pytest.mark.parametrize("outputs, computed", [(["dbeta"], {"dbeta"}), ([], set()), (["h", "F2"], {"h", "F2"})])
def test_nothing_is_computed_along_the_rod_but_the_outputs(outputs, computed, monkeypatch) -> None:
    study = load("fig7_1_modulus").model_copy(update={"outputs": outputs, "observables": [], "laws": []})
    read: set[str] = set()
    monkeypatch.setattr(case_solving, "solve", lambda *args, **more: Watched(solve(*args, **more), read))
    ds = in_memory.run(study)
    assert read & set(OUTPUTS) == computed
    assert {
        quantity_variables.CURVES[str(name)] for name in ds.data_vars if name in quantity_variables.CURVES
    } == computed


# going on, and starting over


def test_a_finished_study_is_answered_at_once(whole, monkeypatch) -> None:
    monkeypatch.setattr(block, "block_of", lambda *_: pytest.fail("solved again"))
    before = whole.read_bytes()
    ran = run_to_file(load(whole.with_suffix(".toml")), whole)
    assert (ran.finished_before, ran.solved, sum(ran.statistics["outcomes"].values())) == (True, 0, 150)
    assert whole.read_bytes() == before


@pytest.mark.parametrize("follow", [False, slow(True)])
def test_other_results_of_the_same_study_are_replaced_with_a_line_that_says_what_differs(tmp_path, follow) -> None:
    ends = "beta0 = 0.1, betaL = 0.2, MZ = 0.0" if follow else "beta = 0.1, dbeta = 0.0, F3 = 2.0, M3 = 0.0"
    text = (
        'title = "one"\nunits = { length = "mm", force = "N" }\nstations = 5\ntol = 1e-8\n'
        f"base = {{ E = 206000, nu = 0.3, a = 5, L = 200, R = 50, {ends} }}\n"
    )
    if follow:
        text += "[axes.FZ]\nfollow = true\nfrom = 1\nto = 2\ncount = 3\n"
    told: list[str] = []
    for changed in (text, text, text.replace("206000", "210000").replace("1e-8", "1e-9")):
        run_to_file(loads(changed, default_name="one"), tmp_path / "one.h5", RunOptions(workers=1), told.append)
    (line,) = [line for line in told if "replaces" in line]
    assert line == (
        f"replaces the results in {tmp_path / 'one.h5'}, which differ: base.E was 206000.0, now 210000.0; "
        "tol was 1e-08, now 1e-09"
    )
    told.clear()
    run_to_file(loads(text, default_name="one"), tmp_path / "one.h5", RunOptions(workers=1, restart=True), told.append)
    assert not [line for line in told if "replaces" in line]


def test_a_law_that_changed_is_told_as_words(tmp_path) -> None:
    axis, told = small.axis("E", [1e4, 2e4]), list[str]()
    for direction in ("falls", "not-rising"):
        work = small.study(axis + small.law("bends", "E", direction), 'observables = ["bends"]')
        run_to_file(work, tmp_path / "small.h5", RunOptions(workers=1), told.append)
    (line,) = [line for line in told if "replaces" in line]
    assert "laws.1 was claim (1), observable bends, axis E, direction falls, source s, now claim (1), " in line


def test_a_finished_study_is_answered_without_xarray_and_pandas(whole) -> None:
    before = (
        "import atexit, sys\nfrom workbench.run import plan; plan.BLOCK = 64\n"
        "atexit.register(lambda: print(*{'xarray', 'pandas'} & set(sys.modules), '.'))"
    )
    with runs.start(whole.parent, whole.with_suffix(".toml"), before=before) as told:
        out, err = told.communicate(timeout=600)
    assert told.returncode == 0, err
    assert "already complete; use --restart to solve again" in out
    assert out.splitlines()[-1].split() == ["."]


def _flipped(content: bytes, at: int) -> bytes:
    return content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :]


def _exchanged(folder: Path) -> None:
    first, second = (folder / f"{a:012d}-{a + 64:012d}.shard" for a in (0, 64))
    aside = first.rename(folder / "aside")
    second.rename(first)
    aside.rename(second)


def _folder(folder: Path) -> None:
    _first(folder).unlink()
    _first(folder).mkdir()


def _first(folder: Path) -> Path:
    return folder / "000000000000-000000000064.shard"


def _damage_by(damage: Callable[[bytes], bytes]) -> Callable[[Path], Any]:
    return lambda folder: _first(folder).write_bytes(damage(_first(folder).read_bytes()))


SPOILT: dict[str, Callable[[Path], Any]] = {
    "missing": lambda folder: _first(folder).unlink(),
    "exchanged": _exchanged,
    "a folder": _folder,
    "cut short": _damage_by(lambda content: content[: len(content) // 2]),
    "empty": _damage_by(lambda content: b""),
    "a byte flipped in the middle": _damage_by(lambda content: _flipped(content, len(content) // 2)),
    "a byte flipped in the digest": _damage_by(lambda content: _flipped(content, 3)),
    "the last bit flipped": _damage_by(lambda content: _flipped(content, len(content) - 1)),
    "without a checksum": _damage_by(lambda content: content[32:]),
}


@pytest.mark.parametrize("name", slow_but(SPOILT, "missing", "exchanged", "empty", "the last bit flipped"))
def test_a_shard_that_is_missing_misplaced_or_damaged_is_solved_again_and_no_other(
    name, whole, tmp_path, monkeypatch
) -> None:
    path = runs.study(tmp_path, GRID)
    folder = kept(path, monkeypatch)
    SPOILT[name](folder)
    solved, again, said = cases_per_block(monkeypatch), 2 if name == "exchanged" else 1, list[str]()
    assert run_to_file(load(path), tmp_path / "many.h5", RunOptions(workers=1), said.append).solved == 64 * again
    assert solved == [64] * again
    lost = [f"discarded: {64 * again} cases in {folder}, damaged"]
    assert said[:-1] == ([] if name == "missing" else lost)
    assert runs.contents(tmp_path / "many.h5") == runs.contents(whole)
    assert folder.exists() == (name == "a folder")  # what is no shard is not removed


def test_shards_of_another_run_than_their_manifest_are_lost_with_restart_alone(tmp_path, monkeypatch) -> None:
    other, path, output = tmp_path / "other", runs.study(tmp_path, GRID), tmp_path / "many.h5"
    other.mkdir()
    folder, copied = kept(path, monkeypatch), kept(runs.study(other, runs.grid(3, 49)), monkeypatch)
    shutil.copy(copied / "manifest.json", folder)
    before = {shard: shard.read_bytes() for shard in folder.glob("*.shard")}
    runs.study(tmp_path, runs.grid(3, 49))
    with pytest.raises(InputError, match=r"0+-0+64\.shard is of another run .* move it elsewhere, or use --restart to"):
        run_to_file(load(path), output, RunOptions(workers=1))
    assert {shard: shard.read_bytes() for shard in folder.glob("*.shard")} == before
    assert run_to_file(load(path), output, RunOptions(workers=1, restart=True)).solved == 147
    shutil.copytree(copied, folder)  # beside a complete file they stay too
    for shard, content in before.items():
        shard.write_bytes(content)
    assert run_to_file(load(path), output).finished_before
    assert {shard: shard.read_bytes() for shard in before} == before


def test_a_part_that_is_interrupted_when_all_cases_are_kept_says_what_writes_the_file(tmp_path, monkeypatch) -> None:
    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    path = runs.study(tmp_path, GRID)
    kept(path, monkeypatch)
    monkeypatch.setattr(run_and_resume, "_solve", stop)
    with pytest.raises(KeyboardInterrupt, match=r"cases are kept in .*; run without --part to write the file"):
        run_to_file(load(path), tmp_path / "many.h5", RunOptions(workers=1, part=(1, 2)))


def test_a_shard_damaged_after_it_was_looked_at_is_solved_again(whole, tmp_path, monkeypatch) -> None:
    path = runs.study(tmp_path, GRID)
    shard = kept(path, monkeypatch) / "000000000064-000000000128.shard"
    solve_missing, times = run_and_resume._solve, []

    def damaging(*args: Any) -> None:
        solve_missing(*args)
        if not times:
            shard.write_bytes(_flipped(shard.read_bytes(), 1000))
        times.append(1)

    monkeypatch.setattr(run_and_resume, "_solve", damaging)
    ran = run_to_file(load(path), tmp_path / "many.h5", RunOptions(workers=1))
    assert len(times) == 2
    assert sum(ran.statistics["outcomes"].values()) == 150
    assert runs.contents(tmp_path / "many.h5") == runs.contents(whole)


def test_shards_of_other_code_or_a_newer_format_are_refused(tmp_path, monkeypatch) -> None:
    path = runs.study(tmp_path, runs.grid(2, 3))
    manifest = kept(path, monkeypatch) / "manifest.json"
    text = manifest.read_text()
    for old, new, sentence in (
        (f'"numpy": "{np.__version__}"', '"numpy": "1.0"', f"numpy was 1.0, now {np.__version__}"),
        (recipe.code_version(), "0.0.1+abc", r"code was 0\.0\.1\+abc, now"),
        ('"format": 4', '"format": 5', "is of format 5, but this version reads format 4"),
        ('"format": 4', '"format": 3', "is of format 3, .* reads format 4; use --restart to discard it"),
        ('"format": 4', '"form": 4', "is damaged; use --restart to discard"),
        (text, "{", "is damaged; use --restart to discard"),
    ):
        assert old in text
        manifest.write_text(text.replace(old, new))
        with pytest.raises(InputError, match=sentence):
            run_to_file(load(path), tmp_path / "many.h5")
    manifest.unlink()
    with pytest.raises(InputError, match="holds results of an unknown run; use --restart to discard them"):
        run_to_file(load(path), tmp_path / "many.h5")


def test_a_file_of_a_newer_version_is_not_replaced(tmp_path) -> None:
    path = runs.study(tmp_path, runs.grid(2, 3))
    run_to_file(load(path), tmp_path / "many.h5")
    with h5py.File(tmp_path / "many.h5", "a") as file:
        file.attrs["format"] = schema.FORMAT + 1
    before = (tmp_path / "many.h5").read_bytes()
    with pytest.raises(InputError, match="is of format 3, but this version reads format 2"):
        run_to_file(load(path), tmp_path / "many.h5")
    assert (tmp_path / "many.h5").read_bytes() == before


def test_a_study_that_does_not_fit_the_disk_is_refused_with_both_numbers(tmp_path, monkeypatch) -> None:
    path = runs.study(tmp_path, runs.grid(100, 1000))
    monkeypatch.setattr(shards, "free", lambda folder: 10_000_000)
    needed = r"needs up to 40\.1 MB for the file and 35\.2 MB for its parts until it is whole, but .* has 10 MB left"
    with pytest.raises(InputError, match=needed):
        run_to_file(load(path), tmp_path / "many.h5")
    with pytest.raises(InputError, match=r"the part needs up to 17\.\d MB, but .* has 10 MB left"):
        run_to_file(load(path), tmp_path / "many.h5", RunOptions(part=(1, 2)))
    assert plan.room(plan.plan(load(path)), tmp_path, 0, (1, 4)) == "100000 cases"
    assert [file.name for file in tmp_path.iterdir()] == ["many.toml"]


def test_more_than_memory_holds_is_refused_in_memory() -> None:
    study = load("fig7_1_modulus").model_copy(update={"stations": 100_001, "outputs": list(OUTPUTS)})
    axes = {"E": study.axes["E"].model_copy(update={"count": 1000})}
    with pytest.raises(InputError, match=r"1000 cases take 1\d\.\d GB in memory, more than the limit of 2 GB"):
        in_memory.run(study.model_copy(update={"axes": axes}))


def test_a_run_counts_outcomes_with_the_range_of_their_numbers(tmp_path) -> None:
    path = runs.study(tmp_path, {"E": [1e4, 2e4], "beta": [0.5, 0.6]}, method="dop853")
    path.write_text(path.read_text().replace("stations", "tol = 1e-15\nstations"))
    ran = run_to_file(load(path), tmp_path / "many.h5")
    with xr.open_dataset(tmp_path / "many.h5") as ds:
        texts = ds["outcome"].values.ravel().tolist()
    assert len(set(texts)) == 4  # each with its own numbers
    errors = sorted((text.split()[2] for text in texts), key=float)
    (told,) = ran.statistics["outcomes"]
    assert told.startswith(f"failed: error {errors[0]} to {errors[-1]} above the tolerance 1.0e-15 at condition ")


# growing

FORCES = np.linspace(1, 9, 60)


@pytest.fixture(scope="module")
def finished(small_blocks, tmp_path_factory) -> bytes:
    path = runs.study(tmp_path_factory.mktemp("half"), {"E": [1e4, 3e4], "F1": FORCES.tolist()})
    run_to_file(load(path), path.with_suffix(".h5"))
    return path.with_suffix(".h5").read_bytes()


@pytest.fixture
def half(finished, tmp_path) -> Path:
    """A finished study over two moduli and 60 forces."""
    (tmp_path / "many.h5").write_bytes(finished)
    return runs.study(tmp_path, {"E": [1e4, 3e4], "F1": FORCES.tolist()})


def test_a_file_with_a_changed_number_is_refused_before_it_grows(half, monkeypatch) -> None:
    output = half.with_suffix(".h5")
    with h5py.File(output, "a") as file:
        file["bends"][0] = 99
    runs.study(half.parent, {"E": [5e3, 1e4, 3e4], "F1": FORCES})
    before, solved = output.read_bytes(), cases_per_block(monkeypatch)
    with pytest.raises(InputError, match="bends has changed since it was stored"):
        run_to_file(load(half), output)
    assert (output.read_bytes(), solved) == (before, [])


def test_the_version_of_the_code_covers_every_source_of_solver_and_studies(monkeypatch) -> None:
    read: set[str] = set()
    monkeypatch.setattr(Path, "read_bytes", lambda path: read.add("/".join(path.parts[-3:])) or b"")
    recipe.code_version.__wrapped__()
    assert {"studies/language/expressions.py", "studies/grammar/axes.py", "solver/core/measured.h"} <= read


def test_a_file_whose_axes_were_changed_by_another_hand_is_not_taken_for_finished(half) -> None:
    with h5py.File(half.with_suffix(".h5"), "a") as file:
        file["E"][0] = 9e3
    assert run_to_file(load(half), half.with_suffix(".h5")).solved == 120


def test_a_finished_study_whose_law_was_edited_is_judged_by_the_law_as_it_is_now(tmp_path) -> None:
    path = runs.study(tmp_path, {"E": [1e4, 2e4, 4e4]})
    law = '[[laws]]\nclaim = "(1)"\nobservable = "kappa_max"\naxis = "E"\ndirection = "{}"\nsource = "a test"\n'
    text = path.read_text()
    told = []
    for direction in ("falls", "rises", "rises"):
        path.write_text(text + law.format(direction))
        ran = run_to_file(load(path), tmp_path / "many.h5")
        (row,) = ran.statistics["laws"]
        told.append((row["verdict"], ran.finished_before))
    assert told == [("true", False), ("false", False), ("false", True)]


def test_what_is_packed_together_lies_together() -> None:
    assert boxes.chunk_shape((7, 100, 3)) == (7, 100, 3)
    assert boxes.chunk_shape((1000, 1000)) == (65, 1000)
    assert boxes.chunk_shape((4, 50, 10**6)) == (1, 1, 2**16)


def test_restart_solves_a_finished_study_again(tmp_path, monkeypatch) -> None:
    path = runs.study(tmp_path, runs.grid(2, 2))
    run_to_file(load(path), tmp_path / "many.h5")
    solved = cases_per_block(monkeypatch)
    assert not run_to_file(load(path), tmp_path / "many.h5", RunOptions(restart=True)).finished_before
    assert solved == [4]


def test_a_count_stays_whole_where_all_is_solved_and_only_there(whole, tmp_path) -> None:
    path = runs.study(tmp_path, {"E": [1e4], "beta": [0.5]}, method="dop853")
    path.write_text(path.read_text().replace("stations", "tol = 1e-15\nstations"))
    run_to_file(load(path), tmp_path / "many.h5")
    with xr.open_dataset(whole) as good, xr.open_dataset(tmp_path / "many.h5") as bad:
        assert good["bends"].dtype == np.int64
        assert bad["bends"].dtype == np.float64
        assert np.isnan(bad["bends"]).all()


def test_a_grown_study_that_was_stopped_goes_on(half, monkeypatch) -> None:
    runs.study(half.parent, {"E": [1e4, 2e4, 3e4, 4e4], "F1": FORCES.tolist()})
    folder = kept(half, monkeypatch)
    assert len(list(folder.glob("*.shard"))) == 2
    assert run_to_file(load(half), half.with_suffix(".h5")).solved == 0
    with xr.open_dataset(half.with_suffix(".h5")) as ds:
        assert ds["E"].values.tolist() == [1e4, 2e4, 3e4, 4e4]
        assert (ds["outcome"] == "solved").all()


def test_a_study_does_not_grow_with_other_code(half, monkeypatch) -> None:
    runs.study(half.parent, {"E": [1e4, 2e4, 3e4], "F1": FORCES.tolist()})
    monkeypatch.setattr(recipe, "code_version", lambda: "0.2.0+new")
    with pytest.raises(InputError, match=r"holds part of this study, but code was .*, now 0\.2\.0\+new; use --restart"):
        run_to_file(load(half), half.with_suffix(".h5"))


OF_EACH = {
    "friction": ("solver.nodes.loaded_solutions.find_shape", {"friction": 0.3, "FZ": -1.0}, False, 1),
    "held": ("solver.held.held_equilibrium.by_rule", {"height": 4.5}, False, 1),
    "followed": ("workbench.stored.sweep.follow", {"FZ": -1.0}, True, 2),  # it raises on the way from the second case
}


@pytest.mark.parametrize("kind", OF_EACH)
def test_a_case_whose_column_raises_is_stored_with_its_neighbours(kind: str, tmp_path, monkeypatch) -> None:
    function, fields, followed, failed = OF_EACH[kind]
    lengths = small.axis("L", LENGTHS.tolist(), **({"follow": True} if followed else {}))
    text = small.text({**small.ROD, "beta0": 0.3, "betaL": 0.5, **fields}, lengths, observables=["height"], stations=11)
    make_raise(function, AssertionError(), monkeypatch)
    ran = run_to_file(loads(text, "text", kind), tmp_path / "raises.h5", RunOptions(workers=1))
    with xr.open_dataset(tmp_path / "raises.h5") as ds:
        outcomes = ds["outcome"].values.tolist()
    assert ran.solved == 3
    assert "the solver raised AssertionError in" in outcomes.pop(failed)
    assert all(outcome.startswith("solved") for outcome in outcomes)
