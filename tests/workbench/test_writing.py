"""Through HDF5 and back, and never half."""

import os
import re
import shutil
import signal
import stat
import subprocess
import sys
import warnings
from contextlib import ExitStack, suppress
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from solver import InputError
from studies.language.loader import loads
from tests.slow import slow
from tests.workbench import forked, runs, small
from workbench.run import in_memory, run_and_resume, writing
from workbench.stored import bounds, boxes, reading


def test_what_is_stored_is_what_is_read(six, tmp_path) -> None:
    for stored in (six, in_memory.run(small.study())):  # a grid, and a single case
        path = writing.write(stored, tmp_path / f"{stored.sizes.get('E')}.h5")
        xr.testing.assert_identical(reading.read(path), stored)


def test_a_text_that_grew_since_it_was_read_is_stored_whole(six, tmp_path) -> None:
    longer = reading.read(writing.write(six, tmp_path / "small.h5"))
    sentence = "failed: a sentence that is longer than all that were stored before"
    longer["outcome"] = longer["outcome"].copy(data=np.full(longer["outcome"].shape, sentence))
    assert set(reading.read(writing.write(longer, tmp_path / "longer.h5"))["outcome"].values.ravel()) == {sentence}


def test_a_file_is_written_and_opened_as_xarray_alone_does(six, tmp_path) -> None:
    six.to_netcdf(tmp_path / "theirs.h5", engine="h5netcdf", encoding=writing.encodings(six))
    writing.write_new(six, tmp_path / "ours.h5")
    assert runs.contents(tmp_path / "ours.h5") == runs.contents(tmp_path / "theirs.h5")
    with (
        reading.raw(tmp_path / "ours.h5") as ours,
        xr.open_dataset(tmp_path / "ours.h5", engine="h5netcdf") as theirs,
    ):
        xr.testing.assert_identical(ours, theirs)
        for name, variable in ours.variables.items():
            assert variable.dtype == theirs[name].dtype


def test_of_many_opened_files_those_closed_meanwhile_are_opened_again(six, tmp_path) -> None:
    path = writing.write(six, tmp_path / "small.h5")
    with ExitStack() as stack:
        copies = [tmp_path / f"{k}.h5" for k in range(4)]
        opened = [stack.enter_context(reading.raw(shutil.copy(path, copy))) for copy in copies]
        with xr.set_options(file_cache_maxsize=2):
            for one in (*opened, opened[0]):
                np.testing.assert_array_equal(one["beta"], six["beta"])


def test_a_bare_open_dataset_reads_it_without_a_warning(six, tmp_path) -> None:
    path = writing.write(six, tmp_path / "small.h5")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with xr.open_dataset(path) as opened:
            assert opened.attrs.pop("checksums")
            xr.testing.assert_identical(opened.load(), six)


def test_h5py_reads_numbers_units_and_texts(six, tmp_path) -> None:
    with h5py.File(writing.write(six, tmp_path / "small.h5")) as file:
        assert file["outcome"].asstr()[0, 0] == "solved"
        assert file["E"].attrs["units"] == "N/cm^2"
        assert file.attrs["study"].startswith('title = "two moduli')
        assert (file["beta"].compression, file["beta"].compression_opts, file["beta"].shuffle) == ("gzip", 1, True)
        assert file["beta"].fletcher32
        assert file["beta"].dims[0].keys() == ["E"] or "E" in file["beta"].dims[0]


def test_a_selection_that_another_program_has_stored_is_read(six, tmp_path) -> None:
    with xr.open_dataset(writing.write(six, tmp_path / "small.h5")) as opened:
        opened.isel(E=[1]).assign_attrs(history="mine").to_netcdf(tmp_path / "part.h5", engine="h5netcdf")
    xr.testing.assert_identical(reading.read(tmp_path / "part.h5").drop_attrs(), six.isel(E=[1]).drop_attrs())


def test_a_result_replaces_one_of_the_same_study_and_any_file_by_force(six, tmp_path) -> None:
    path = writing.write(six, tmp_path / "small.h5")
    writing.write(six.assign_attrs(title="again"), path)
    assert reading.read(path).attrs["title"] == "again"
    (tmp_path / "notes.txt").write_text("mine")
    writing.write(six, tmp_path / "notes.txt", force=True)
    xr.testing.assert_identical(reading.read(tmp_path / "notes.txt"), six)


def test_whoever_reads_the_old_file_while_it_is_replaced_reads_it_whole(six, tmp_path) -> None:
    path = writing.write(six, tmp_path / "small.h5")
    with path.open("rb") as old:
        before = path.read_bytes()
        writing.write(six.assign_attrs(title="new"), path)
        assert old.read() == before
    assert reading.read(path).attrs["title"] == "new"


def test_a_write_that_fails_leaves_the_good_file_and_no_other(six, tmp_path, monkeypatch) -> None:
    path = writing.write(six, tmp_path / "small.h5")
    before = path.read_bytes()

    def full_disk(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(InputError, match=r"cannot write .*small.h5: No space left on device"):
        writing.write(six.assign_attrs(title="new"), path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["small.h5"]


@pytest.mark.skipif(os.name == "nt", reason="no limit of the size of files there")
@pytest.mark.parametrize("room", [slow(0), 5000])
def test_a_full_disk_is_one_sentence_where_hdf5_would_end_the_process(six, tmp_path, room) -> None:
    path = writing.write(six, tmp_path / "small.h5")
    limited = (
        "import resource, sys\nsys.dont_write_bytecode = True  # else that of a library is cut short\n"
        "from workbench.run import writing\nfrom workbench.stored import reading\nds = reading.read(sys.argv[1])\n"
        "size = resource.RLIMIT_FSIZE\nhard = resource.getrlimit(size)[1]\n"
        f"resource.setrlimit(size, ({room}, hard))\n"
        "try:\n    writing.write(ds, sys.argv[2])\nexcept ValueError as error:\n    said = error\n"
        "resource.setrlimit(size, (hard, hard))\nprint(said)"
    )
    new = tmp_path / "new.h5"
    script = tmp_path / "limited.py"
    script.write_text(limited)
    run = forked.run(script, path, new)
    script.unlink()
    assert (run.returncode, run.stdout, run.stderr) == (0, f"cannot write {new}: File too large\n", "")
    assert [p.name for p in tmp_path.iterdir()] == ["small.h5"]


@pytest.mark.parametrize("system, folders", (("linux", 1), ("win32", 0)))
def test_windows_flushes_files_that_are_open_for_writing_and_no_folder(
    six, tmp_path, monkeypatch, system, folders
) -> None:
    fcntl = pytest.importorskip("fcntl", reason="no fcntl on this system")
    flushed = []

    def watched(handle: int) -> None:
        writable = fcntl.fcntl(handle, fcntl.F_GETFL) & os.O_ACCMODE != os.O_RDONLY
        flushed.append((stat.S_ISDIR(os.fstat(handle).st_mode), writable))

    monkeypatch.setattr(os, "fsync", watched)
    monkeypatch.setattr(sys, "platform", system)
    writing.write(six, tmp_path / "small.h5")
    assert flushed.count((True, False)) == folders
    assert [writable for folder, writable in flushed if not folder] == [True]


KILLED = """
import os, signal, sys
from pathlib import Path
from workbench.run import writing
from workbench.stored import reading
ds = reading.read(sys.argv[1])
os.fsync = lambda handle: os.kill(os.getpid(), signal.SIGKILL)  # written, not renamed
writing.write(ds, sys.argv[1])
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
def test_a_killed_run_leaves_the_good_file_whole(six, tmp_path) -> None:
    path = writing.write(six, tmp_path / "small.h5")
    before = path.read_bytes()
    (tmp_path / "main.py").write_text(KILLED)
    run = forked.run(tmp_path / "main.py", path)
    assert run.returncode == -signal.SIGKILL, run.stderr
    assert path.read_bytes() == before
    xr.testing.assert_identical(reading.read(path), six)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has other locks")
def test_a_file_that_another_program_writes_is_not_called_damaged(six, tmp_path) -> None:
    file = writing.write(six, tmp_path / "six.h5")
    code = "import sys, h5py; held = h5py.File(sys.argv[1], 'a'); print(1, flush=True); sys.stdin.read()"
    with subprocess.Popen([sys.executable, "-c", code, file], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdout is not None
        other.stdout.readline()
        with pytest.raises(InputError, match=r"^cannot read .*six\.h5: another program holds it open"):
            reading.read(file)
        other.communicate()
    assert reading.read(file).equals(six)


ROD = {"E": 1e4, "nu": 0.25, "a": 0.05, "L": 20.0, "R": 0.75, "beta": 0.5, "dbeta": 0.5, "M3": 0.0, "F3": 10.0}
LOGS = "[expressions]\n" + "".join(f'a_quantity_of_some_length_{k} = "log(bends - 100)"\n' for k in range(20))


def stored_study(base, tables, tmp_path, head="") -> xr.Dataset:
    """The file of a study that is run into one, read; the same study that is run in memory and then stored too."""
    study = loads(head + small.text(ROD | base, tables))
    run_and_resume.run_to_file(study, tmp_path / "run.h5")
    writing.write(in_memory.run(study), tmp_path / "memory.h5")
    ran, kept = (reading.read(tmp_path / f"{name}.h5") for name in ("run", "memory"))
    assert {*ran["outcome"].values} == {*kept["outcome"].values}
    return ran


@pytest.mark.parametrize(
    ("base", "tables", "words"),
    [
        ({"E": 1e40, "F3": 1e37}, small.axis("R", [0.75, 0.8]), "failed: .+ contact is not finite, or beyond 1e.30"),
        ({"alpha": 1e13}, small.axis("R", [0.75, 0.8]), "failed: .+ alpha is not finite, or beyond 1e.12"),
        ({}, small.axis("E", [1e4, 2e4]) + LOGS, r"solved; .+a_quantity_of_some_length_2.+; \.\.\."),
    ],
)
def test_a_case_that_a_file_cannot_hold_says_so_and_the_file_is_read(base, tables, words, tmp_path) -> None:
    outcomes = stored_study(base, tables, tmp_path)["outcome"].values.tolist()
    assert all(re.fullmatch(words, outcome) and len(outcome) <= bounds.LABEL for outcome in outcomes)


def test_the_control_characters_of_a_comment_are_blanks_in_the_file(tmp_path) -> None:
    ds = stored_study({}, small.axis("E", [1e4, 2e4]), tmp_path, head="# a \x85 comment\n")
    assert ds.attrs["study"].startswith("# a   comment\n")


@pytest.mark.parametrize(
    ("base", "tables", "words"),
    [
        ({}, small.axis("E", [1e4, 1e308]), "the axis E holds values that are not finite, or beyond 1e.50"),
        ({}, small.axis("E", [1e-60, 1e4]), "E of a study that is stored must be from 1e-50 to 1e.50, got 1e-60"),
        ({"E": 1e60}, small.axis("R", [0.75, 0.8]), "E of a study that is stored must be .+, got 1e.60"),
        ({"L": 1e30}, small.axis("R", [1e-5, 0.8]), "L of a study that is stored must be at most 1e.30 times rho"),
    ],
)
def test_a_study_that_no_file_can_hold_is_refused_before_it_is_solved(
    base, tables, words, tmp_path, monkeypatch
) -> None:
    study = loads(small.text(ROD | base, tables))
    monkeypatch.setattr(run_and_resume, "_run", lambda *_: pytest.fail("it was solved"))
    with pytest.raises(InputError, match=words):
        run_and_resume.run_to_file(study, tmp_path / "study.h5")
    with pytest.raises(InputError, match="cannot write"):
        writing.write(in_memory.run(study), tmp_path / "study.h5")
    assert list(tmp_path.iterdir()) == []


def test_a_new_folder_in_which_nothing_was_written_goes_and_any_other_stays(tmp_path: Path) -> None:
    def interrupt(folder: Path, name: str = "") -> bool:
        with suppress(KeyboardInterrupt), writing.folder_of_results(folder):
            (folder / name).touch()
            raise KeyboardInterrupt
        return folder.exists()

    assert not interrupt(tmp_path / "new")
    assert interrupt(tmp_path / "kept", "a.h5")
    (tmp_path / "old").mkdir()
    assert interrupt(tmp_path / "old")


@pytest.mark.parametrize(
    ("function", "kept"),
    [
        ("studies.language.case_input.read_case", "nothing was stored"),
        ("workbench.run.atomic.flush", "nothing was stored"),  # while the first file is written
        ("workbench.figures.canvas.save", "stored: one.h5"),
    ],
)
def test_ctrl_c_names_the_files_that_were_stored(call, tmp_path, monkeypatch, function: str, kept: str) -> None:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(function, stop)
    status, _, err = call("solve", "--table1", "-o", "one.h5", "--plot", "one.png")
    assert (status, err) == (130, f"workbench: interrupted; {kept}\n")
    assert [path.name for path in tmp_path.iterdir()] == kept.split(": ")[1:]


def test_ctrl_c_after_a_run_has_written_its_file_names_the_file(call, tmp_path, monkeypatch) -> None:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("workbench.run.shards.clear", stop)
    assert call("run", "fig7_1_modulus")[::2] == (130, "workbench: interrupted; stored: fig7_1_modulus.h5\n")
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    assert "already complete" in call("run", "fig7_1_modulus")[1]
    assert [path.name for path in tmp_path.iterdir()] == ["fig7_1_modulus.h5"]


@pytest.mark.parametrize(
    ("shape", "chunk"), [((5, 7), (5, 7)), ((9, 2**15), (2, 2**15)), ((3, 4, 2**17), (1, 1, 2**16))]
)
def test_a_chunk_is_a_stretch_of_the_flat_order_of_at_most_512_kB(shape, chunk) -> None:
    assert boxes.chunk_shape(shape) == chunk


def test_a_number_below_the_least_of_its_observable_is_unfit() -> None:
    ((name, why, bad),) = bounds.unfit({"gap_max": np.array([-1.0, 0.0, np.nan])}, (), {})
    assert (name, why, bad.tolist()) == ("gap_max", "is out of its range", [True, False, False])
