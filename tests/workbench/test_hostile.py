"""Files from anyone: whatever is in them, a command ends with one sentence, and nothing in them is followed or run."""

import json
import shutil
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from random import Random
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr

import workbench.accessor  # noqa: F401  (ds.rod)
from solver import InputError
from solver.problem.declared_fields import RANGES
from studies import load
from studies.language.loader import loads
from tests.slow import slow, slow_but
from tests.workbench import altered, forked, runs, small
from tests.workbench.command import exit_status
from workbench.figures import canvas, study_figure
from workbench.run import in_memory, recipe, writing
from workbench.run.study_store import run_to_file
from workbench.stored import checks, file_checks, reading, schema
from workbench.stored.stored_study import StoredStudy

AXES = "[axes.E]\nvalues = {}\n[axes.R]\nvalues = [0.5, 0.75, 1.0]\n"
LAW = small.law("kappa_max", "R", "falls", claim="(2)")
HEAD = 'observables = ["bends", "attached"]\noutputs = ["beta", "alpha", "z", "contact"]'


def stored(path: Path, values: str = "[1e4, 2e4]") -> Path:
    return writing.write(in_memory.run(small.study(AXES.format(values) + LAW, HEAD)), path)


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> bytes:
    """The bytes of a good file, without the checksums that would tell first whatever is altered."""
    path = stored(tmp_path_factory.mktemp("whole") / "small.h5")
    with h5py.File(path, "a") as file:
        del file.attrs[file_checks.SUMS]
    return path.read_bytes()


@pytest.fixture(scope="module")
def opened(whole: bytes) -> Iterator[xr.Dataset]:
    """The good file, opened once; a test alters a copy."""
    with xr.open_dataset(BytesIO(whole), engine="h5netcdf") as ds:
        yield ds


DOORS = ("check", "export csv")  # which read lazily and at once, as all others do
ALL = ("check", "merge", "summary", "plot", "scene")


def told(commands: tuple[str, ...], folder: Path, tmp_path: Path) -> list[dict[str, Any]]:
    """How the commands end on every file in the folder."""
    good, out = stored(tmp_path / "good.h5", "[3e4]"), tmp_path / "out"
    out.mkdir()
    run = forked.run("-m", "tests.workbench.hostile", folder, good, out, *commands, timeout=3600)
    assert run.returncode == 0, run.stderr
    return [json.loads(line) for line in run.stdout.splitlines()]


@pytest.mark.parametrize("value", (np.inf, -np.inf))
def test_stations_that_are_all_infinite_are_refused_without_a_warning(opened: xr.Dataset, value: float) -> None:
    ds = opened.load().copy(deep=True)
    ds["u"] = ds["u"].copy(data=np.full(ds["u"].shape, value))
    with pytest.raises(InputError, match="u must rise from 0 to 1"):
        checks.check(ds, "small.h5", [checks.fields])


@pytest.mark.parametrize("precision", ("f2", "f4"))
def test_curves_in_a_lower_precision_are_judged_without_a_warning(opened: xr.Dataset, precision: str) -> None:
    ds = opened.load().copy(deep=True)
    for name in ("beta", "alpha", "z"):
        ds[name] = (0 * ds[name]).astype(precision)
    checks.check(ds, "small.h5", [checks.curves])


BOMB = "[" * 1_000_000


@pytest.mark.parametrize(("commands", "cuts", "flips"), [(DOORS, 2, 4), slow(ALL, 50, 200)])
def test_damaged_files_end_in_a_sentence(commands, cuts: int, flips: int, whole: bytes, tmp_path: Path) -> None:
    """Files cut short at many lengths, and files with some bytes changed, a few or a stretch of them."""
    folder, random = tmp_path / "damaged", Random(1)
    folder.mkdir()
    for i in range(cuts):
        (folder / f"cut {i:04}").write_bytes(whole[: len(whole) * i // cuts])
    for i in range(flips):
        content, at = bytearray(whole), random.randrange(len(whole))
        for k in range(random.choice([1, 1, 8, 512])):
            content[(at + k) % len(whole)] = random.randrange(256)
        (folder / f"flip {i:04}").write_bytes(content)
    rows = told(commands, folder, tmp_path)
    assert [row for row in rows if row["faults"]] == []
    assert all(row["status"] == 2 for row in rows if row["file"].startswith("cut"))


@pytest.mark.parametrize(("count", "seed"), [(6, 1), slow(1000, 2)])
def test_changed_bits_are_noticed(count: int, seed: int, tmp_path: Path) -> None:
    """A file with one bit changed is refused, or all of it that is read is as it was."""
    path, random = stored(tmp_path / "good.h5"), Random(seed)
    whole, good = path.read_bytes(), reading.read(path)
    for _ in range(count):
        content = bytearray(whole)
        content[random.randrange(len(whole))] ^= 1 << random.randrange(8)
        path.write_bytes(content)
        try:
            found = reading.read(path)
        except InputError:
            continue
        xr.testing.assert_identical(found, good)


ONE_AXIS = "[axes.E]\nvalues = {}\n[base]\nL = 5.0\n" + LAW.replace('"R"', '"E"')
FOLLOWED = '[axes.betaL]\nfollow = true\nto = 60\ncount = 3\nunit = "deg"\n' + LAW.replace('"R"', '"betaL"')
ENDS = small.text(
    {**small.SHORT, "beta0": 0.3, "betaL": 0.5},
    small.axis("FZ", [-4.0, -2.0]),
    outputs=["beta", "alpha", "z", "contact"],
    stations=21,
)
BASES = {
    "one axis": small.study(ONE_AXIS.format("[1e4, 2e4]"), HEAD),
    "two axes": small.study(AXES.format("[1e4, 2e4]") + LAW, HEAD),
    "no axis": small.study("[base]\nL = 5.0\n", HEAD),
    "followed": small.study(FOLLOWED, HEAD),
    "samples": small.study("[zip]\nE = [1e4, 2e4]\nR = [0.5, 0.75]\n", HEAD),
    "between two ends": loads(ENDS),
}


@pytest.mark.parametrize(
    ("base", "commands", "count"),
    [("one axis", DOORS, 5), ("samples", DOORS, 5), *(slow(base, ("all",), 100) for base in BASES)],
)
def test_a_study_that_is_altered_in_one_place_is_read_or_refused_in_a_sentence(
    base: str, commands: tuple[str, ...], count: int, tmp_path: Path
) -> None:
    folder, path = tmp_path / "altered", writing.write(in_memory.run(BASES[base]), tmp_path / "base.h5")
    folder.mkdir()
    with h5py.File(path, "a") as file:
        del file.attrs[file_checks.SUMS]
    for k, (place, way, change) in enumerate(Random(1).sample(list(altered.alterations(path)), count)):
        change(Path(shutil.copy(path, folder / f"{k:03} {place} {way}".replace("/", " "))))
    assert [row for row in told(commands, folder, tmp_path) if row["faults"]] == []


@pytest.mark.parametrize("text", slow_but(("$\\mathrm{", "$x$ and $\\frac{", "\\alpha $"), "$x$ and $\\frac{"))
def test_a_dollar_in_a_name_is_drawn_as_it_is(whole: bytes, tmp_path: Path, text: str) -> None:
    path = tmp_path / "dollar.h5"
    path.write_bytes(whole)
    with h5py.File(path, "a") as file:
        for name in ("E", "R", "contact", "bends"):
            file[name].attrs["long_name"] = text
        file.attrs["title"] = text
    out = tmp_path / "out.png"
    canvas.save(study_figure.figure(StoredStudy(reading.read(path))), out, 50)
    assert out.exists()


COMMANDS = "\x1b[2J \x9b31m \x07 \u202e \u2028 \x00"


@pytest.mark.parametrize(
    ("field", "value"),
    (("inclination", np.pi * (1 + 1e-15)), ("nu", 0.5), ("nu", np.nextafter(-1, 0)), ("weight", 0.0)),
)
def test_a_value_that_the_solver_takes_is_no_fault_of_a_file(field: str, value: float) -> None:
    assert not RANGES[field].excludes(value)
    assert list(checks.fields(xr.Dataset({field: value}))) == []


def test_a_word_of_the_command_line_does_not_reach_the_terminal_as_it_is(capsys) -> None:
    for words in (["check", COMMANDS.replace("\x00", "")], ["check", "--\x1b[2J"], ["\x1b[2J"]):
        assert exit_status(*words) == 2
        said = capsys.readouterr().err
        assert said.rstrip("\n").isprintable()
        assert said.count("\n") == 1


def test_an_output_that_is_there_is_looked_at_with_the_same_care(tmp_path: Path) -> None:
    path, other = tmp_path / "many.h5", tmp_path / "other.h5"
    study = load(str(runs.study(tmp_path, runs.grid(2, 2))))
    run_to_file(study, path)
    assert recipe.look(path) is not None
    shutil.copy(path, other)
    with h5py.File(path, "a") as file:
        del file["E"]
        file["E"] = h5py.ExternalLink("other.h5", "/E")  # the very same values
    assert recipe.look(path) is None


AS_NOBODY = """
import contextlib, os, sys
from workbench import cli
with contextlib.suppress(SystemExit):
    cli.main(["check", sys.argv[1]])  # whatever it imports is imported now
if os.geteuid() == 0:
    os.seteuid(65534)  # root may read everything
cli.main(["check", sys.argv[2]])
"""


def test_a_file_that_may_not_be_read_is_refused_as_such(whole: bytes, tmp_path: Path) -> None:
    for name, mode in (("mine.h5", 0o600), ("secret.h5", 0)):
        (tmp_path / name).write_bytes(whole)
        (tmp_path / name).chmod(mode)
    (tmp_path / "main.py").write_text(AS_NOBODY)
    run = forked.run(tmp_path / "main.py", tmp_path / "mine.h5", tmp_path / "secret.h5")
    assert run.returncode == 2, run.stderr
    assert run.stderr == f"workbench: cannot read {tmp_path / 'secret.h5'}: permission denied\n"


def test_a_run_makes_a_file_of_an_older_format_again(tmp_path: Path) -> None:
    path = tmp_path / "small.h5"
    study = small.study(AXES.format("[1e4]"), HEAD)
    run_to_file(study, path)
    with h5py.File(path, "a") as file:
        file.attrs["format"] = 1
    assert run_to_file(study, path).solved == 3
    assert reading.read(path).attrs["format"] == schema.FORMAT


ATTRIBUTES = ("study", "reading", "tolerance", "method", "stiffness", "length_unit", "side")


@pytest.mark.parametrize("name", ATTRIBUTES)
@pytest.mark.parametrize("value", [None, 3.5, "", "nonsense \x1b", BOMB])
def test_the_accessor_copes_with_a_hostile_attribute(opened: xr.Dataset, name: str, value: Any) -> None:
    ds = opened.copy()
    ds.attrs.pop(name)
    if value is not None:
        ds.attrs[name] = value
    said = ""
    for ask in (lambda: ds.rod.case, lambda: ds.rod.F1, lambda: ds.rod.sel(E=1e4), lambda: ds.rod.at(E=1.5e4)):
        try:
            ask()
        except InputError as refusal:
            said += str(refusal)
    assert said.isprintable()
