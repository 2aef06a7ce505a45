"""Files from anyone: whatever is in them, a command ends with one sentence, and nothing in them is followed or run."""

import json
import os
import shutil
from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path
from random import Random
from tempfile import mkdtemp
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr

import workbench.accessor  # noqa: F401  (ds.rod)
from solver import InputError
from solver.problem.declared_fields import RANGES
from studies import load
from tests.slow import slow, slow_but
from tests.workbench import altered, forked, hostile, runs, small, study_kinds
from tests.workbench.command import exit_status
from workbench import cli
from workbench.figures import canvas, study_figure
from workbench.lab import measured_runs
from workbench.run import in_memory, recipe, writing
from workbench.run.run_and_resume import run_to_file
from workbench.stored import checks, file_checks, reading, schema
from workbench.stored.stored_study import StoredStudy

AXES = "[axes.E]\nvalues = {}\n[axes.R]\nvalues = [0.5, 0.75, 1.0]\n" + small.law(
    "kappa_max", "R", "falls", claim="(2)"
)
HEAD = 'observables = ["bends", "attached"]\noutputs = ["beta", "alpha", "z", "contact"]'
FOLLOWED = '[axes.betaL]\nfollow = true\nto = 60\ncount = 3\nunit = "deg"\n' + small.law("kappa_max", "betaL", "falls")
STUDIES = {
    "grid": small.study(AXES.format("[1e4, 2e4]"), HEAD),
    "one case": small.study("[base]\nL = 5.0\n", HEAD),
    "samples": small.study("[zip]\nE = [1e4, 2e4]\nR = [0.5, 0.75]\n", HEAD),
    "followed": small.study(FOLLOWED, HEAD),
    "refined": study_kinds.STUDIES["refined"].at_stations(11),
}
OTHERS = {
    "equilibria": "equilibria",
    "branches": "equilibria --axis betaL=-90deg:-30deg:7",
    "loops": "loops --table1 --a 0.05 --R 0.95 --L 12 --folds 1,2",
    "folds": "folds --axis betaL=-10deg:30deg --axis FZ=4:6 --lattice 2",
}
KINDS = (*STUDIES, *OTHERS, "trade")
DOORS = ("check", "summary", "export csv")  # which read lazily and at once, as all others do
ALL = tuple(hostile.COMMANDS)
UNCHANGED = ("", len)


@cache
def sound(kind: str) -> Path:
    """A good file of a kind, which no test changes."""
    path = Path(mkdtemp()) / "sound.h5"
    if kind in STUDIES:
        return writing.write(in_memory.run(STUDIES[kind]), path)
    if kind == "trade":
        return Path(shutil.copy(measured_runs.SHIPPED / "trade.h5", path))
    assert exit_status(*OTHERS[kind].split(), "--out", path) == 0
    return path


def alter(kind: str, change: altered.Change, path: Path, is_summed: bool = False) -> Path:
    """A file of a kind with one change, and no checksums, or those of what it now holds."""
    shutil.copy(sound(kind), path)
    with h5py.File(path, "a") as file:
        file.attrs.pop(file_checks.SUMS, None)
        altered.make(file, *change)
        if is_summed:
            file_checks.store_sums(file)
    return path


def ends(kind: str, folder: Path, commands: Iterable[str]) -> list[dict[str, Any]]:
    """How the commands end on every file in the folder; nothing is wrong with any end."""
    out = folder.with_name("out")
    out.mkdir()
    run = forked.run("-m", "tests.workbench.hostile", folder, sound(kind), *commands, cwd=out, timeout=3600)
    assert run.returncode == 0, run.stderr
    rows = [json.loads(line) for line in run.stdout.splitlines()]
    assert [row for row in rows if row["faults"]] == []
    return [row for row in rows if row["file"] != "sound.h5"]


@pytest.mark.parametrize(
    ("kind", "commands", "count"),
    [("samples", DOORS, 8), ("branches", DOORS, 8), *(slow(kind, ALL, 60) for kind in KINDS)],
)
def test_an_altered_or_damaged_file_is_read_or_refused_in_a_sentence(
    kind: str, commands: tuple[str, ...], count: int, tmp_path: Path
) -> None:
    folder, random, bare = tmp_path / "altered", Random(1), alter(kind, UNCHANGED, tmp_path / "bare.h5")
    folder.mkdir()
    with h5py.File(bare) as file:
        changes = random.sample(list(altered.by_rule(file)), count)
    for k, change in enumerate(changes):
        with suppress(InputError):  # no checksums of a file that cannot be read
            alter(kind, change, folder / f"{k} altered", is_summed=k % 3 == 0)
        if k % 2:
            (folder / f"{k} damaged").write_bytes(altered.damage(bare.read_bytes(), random))
    ends(kind, folder, commands)


@pytest.mark.parametrize(("kind", "count"), [("grid", 6), *(slow(kind, 40) for kind in KINDS if kind != "trade")])
def test_changed_bits_are_noticed(kind: str, count: int, tmp_path: Path) -> None:
    """A file with one bit changed is refused, or all of it that is read is as it was."""
    whole, path, is_study = sound(kind).read_bytes(), tmp_path / "changed.h5", kind in STUDIES
    good = reading.read(sound(kind), is_study)
    for seed in range(count):
        content, random = bytearray(whole), Random(seed)
        content[random.randrange(len(whole))] ^= 1 << random.randrange(8)
        path.write_bytes(content)
        try:
            xr.testing.assert_identical(reading.read(path, is_study), good)
        except InputError:
            continue


def test_a_fault_of_ours_is_told_as_such_with_a_sound_file_alone(tmp_path: Path, monkeypatch, capsys) -> None:
    def fail(*_: object, **__: object) -> None:
        raise KeyError("x")

    monkeypatch.setattr(cli, "_parser", lambda: fail)
    bare = alter("grid", UNCHANGED, tmp_path / "bare.h5")
    ours, blamed = "a fault of the workbench", f"{bare} cannot be used"
    for words, said in (((sound("grid"),), ours), ((bare,), blamed), ((sound("grid"), bare), blamed)):
        assert exit_status("merge", *words) == 2
        assert capsys.readouterr().err.startswith(f"workbench: {said}")
    with pytest.raises(KeyError):
        exit_status("summary", "fig6")


@pytest.mark.parametrize("value", (np.inf, -np.inf))
def test_stations_that_are_all_infinite_are_refused_without_a_warning(value: float) -> None:
    ds = reading.read(sound("grid")).assign_coords(u=np.full(21, value))
    assert next(checks.fields(ds)) == ": u must rise from 0 to 1"


@pytest.mark.parametrize("precision", ("f2", "f4"))
def test_curves_in_a_lower_precision_are_judged_without_a_warning(precision: str) -> None:
    ds = reading.read(sound("grid"))
    ds = ds.assign({name: (0 * ds[name]).astype(precision) for name in ("beta", "alpha", "z")})
    assert list(checks.numbers(ds, along=True)) == []


RADIUS = [("shape_rho", value, "must be") for value in (1e300, 0.0, -1.0, np.nan)]  # of each shape of branches


@pytest.mark.parametrize(("name", "value", "why"), [*RADIUS, ("'curve_height'", 1e300, "holds numbers beyond 1e.200")])
def test_numbers_of_any_file_are_in_their_range(name: str, value: float, why: str, tmp_path: Path) -> None:
    path = alter("branches", (name.strip("'") + "[0]", value), tmp_path / "altered.h5")
    with pytest.raises(InputError, match=f"^{path}: {name} {why}"):
        reading.read(path, study=False)


def test_a_label_that_leaves_a_picture_no_room_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="must be one line of text"):
        reading.read(alter("grid", ("E@long_name", "x" * 50_000), tmp_path / "altered.h5"))


@pytest.mark.parametrize(
    ("field", "value"),
    (("inclination", np.pi * (1 + 1e-15)), ("nu", 0.5), ("nu", np.nextafter(-1, 0)), ("weight", 0.0)),
)
def test_a_value_that_the_solver_takes_is_no_fault_of_a_file(field: str, value: float) -> None:
    assert not RANGES[field].excludes(value)
    assert list(checks.fields(xr.Dataset({field: value}))) == []


@pytest.mark.parametrize("text", slow_but(("$\\mathrm{", "$x$ and $\\frac{", "\\alpha $"), "$x$ and $\\frac{"))
def test_a_dollar_in_a_name_is_drawn_as_it_is(tmp_path: Path, text: str) -> None:
    ds = reading.read(sound("grid")).assign_attrs(title=text)
    for name in ("E", "R", "contact", "bends"):
        ds[name].attrs["long_name"] = text
    canvas.save(study_figure.figure(StoredStudy(ds)), tmp_path / "out.png", 50)
    assert (tmp_path / "out.png").exists()


def test_a_word_of_the_command_line_does_not_reach_the_terminal_as_it_is(capsys) -> None:
    for words in (["check", altered.COMMANDS], ["check", "--\x1b[2J"], ["\x1b[2J"]):
        assert exit_status(*words) == 2
        said = capsys.readouterr().err
        assert said.rstrip("\n").isprintable()
        assert said.count("\n") == 1


def test_an_output_that_is_there_is_looked_at_with_the_same_care(tmp_path: Path) -> None:
    path, other = tmp_path / "many.h5", tmp_path / "other.h5"
    run_to_file(load(str(runs.study(tmp_path, runs.grid(2, 2)))), path)
    assert recipe.look(path) is not None
    shutil.copy(path, other)
    with h5py.File(path, "a") as file:
        altered.make(file, "E", h5py.ExternalLink("other.h5", "/E"))  # the very same values
    assert recipe.look(path) is None


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="Windows has other rights")
def test_a_file_that_may_not_be_read_is_refused_as_such(tmp_path: Path) -> None:
    path, user = Path(shutil.copy(sound("grid"), tmp_path / "secret.h5")), os.geteuid()
    path.chmod(0)
    os.seteuid(user or 65534)  # root may read everything
    try:
        with pytest.raises(InputError, match=f"^cannot read {path}: permission denied$"):
            reading.read(path)
    finally:
        os.seteuid(user)


def test_a_run_makes_a_file_of_an_older_format_again(tmp_path: Path) -> None:
    path, study = tmp_path / "small.h5", small.study(AXES.format("[1e4]"), HEAD)
    run_to_file(study, path)
    with h5py.File(path, "a") as file:
        file.attrs["format"] = 1
    assert run_to_file(study, path).solved == 3
    assert reading.read(path).attrs["format"] == schema.FORMAT


@pytest.mark.parametrize("name", ("title", "study_name", "laws", "study", "reading", "side", "method", "length_unit"))
@pytest.mark.parametrize("value", [None, 3.5, "", "nonsense \x1b", altered.BOMB])
def test_the_accessor_copes_with_a_hostile_attribute(name: str, value: Any) -> None:
    ds, said = reading.read(sound("grid")), ""
    ds.attrs.pop(name)
    if value is not None:
        ds.attrs[name] = value
    for ask in (lambda: ds.rod.case, lambda: ds.rod.F1, lambda: ds.rod.sel(E=1e4), lambda: ds.rod.at(E=1.5e4)):
        try:
            ask()
        except InputError as refusal:
            said += str(refusal)
    assert said.isprintable()
