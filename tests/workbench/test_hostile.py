"""Files from anyone: whatever is in them, a command ends with one sentence, and nothing in them is followed or run."""

import json
import os
import re
import shutil
from collections.abc import Callable, Iterator
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
from studies import load
from studies.language.loader import loads
from tests.slow import slow, slow_but
from tests.workbench import forked, runs, small
from tests.workbench.command import exit_status
from workbench.figures import canvas, study_figure
from workbench.scene import opengl
from workbench.store import checksums, in_memory, reading, schema, stored_run, writing
from workbench.store.study_store import run_to_file
from workbench.words import escaping

ROOT = Path(__file__).parents[2]
AXES = "[axes.E]\nvalues = {}\n[axes.R]\nvalues = [0.5, 0.75, 1.0]\n"
LAW = small.law("kappa_max", "R", "falls", claim="(2)")
HEAD = 'observables = ["turns", "attached"]\noutputs = ["beta", "alpha", "z", "contact"]'


def stored(path: Path, values: str = "[1e4, 2e4]") -> Path:
    return writing.write(in_memory.run(small.study(AXES.format(values) + LAW, HEAD)), path)


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> bytes:
    """The bytes of a good file, without the checksums that would tell first whatever is altered."""
    path = stored(tmp_path_factory.mktemp("whole") / "small.h5")
    with h5py.File(path, "a") as file:
        del file.attrs[checksums.KEY]
    return path.read_bytes()


@pytest.fixture(scope="module")
def opened(whole: bytes) -> Iterator[xr.Dataset]:
    """The good file, opened once; a test alters a copy."""
    with xr.open_dataset(BytesIO(whole), engine="h5netcdf") as ds:
        yield ds


# All of them open files by the same door.
SOME, ALL = ("check",), ("check", "merge", "summary", "plot", "scene")


def told(commands: tuple[str, ...], folder: Path, tmp_path: Path) -> list[dict[str, Any]]:
    """What the commands say of every file in the folder."""
    good, out = stored(tmp_path / "good.h5", "[3e4]"), tmp_path / "out"
    out.mkdir()
    run = forked.run("-m", "tests.workbench.hostile", folder, good, out, *commands, timeout=3600)
    assert run.returncode == 0, run.stderr
    return [json.loads(line) for line in run.stdout.splitlines()]


def ends_in_a_sentence(row: dict[str, Any]) -> bool:
    """Refused in one printable sentence, or done without complaint."""
    if row["status"] in (0, 1):
        return "Traceback" not in row["said"]
    one = row["said"].count("\n") == 1 and row["said"].strip().isprintable()
    return row["status"] == 2 and one and row["said"].startswith("workbench: ")


# Each takes an open file and makes it hostile; every command refuses each of them.


def without_variable(name: str) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        del file[name]

    return change


def with_attribute(name: str, value: Any) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        del file.attrs[name]
        if value is not None:
            file.attrs[name] = value

    return change


def replaced(name: str, values: Any, **how: Any) -> Callable[[h5py.File], None]:
    """A variable replaced by plain data, without its dimensions' names."""

    def change(file: h5py.File) -> None:
        del file[name]
        file.create_dataset(name, data=values, **how)

    return change


def linked(link: Any) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        del file["beta"]
        file["beta"] = link

    return change


def nan_on_an_axis(file: h5py.File) -> None:
    file["E"][1] = np.nan


def value_twice(file: h5py.File) -> None:
    file["E"][...] = 1e4


def no_values(file: h5py.File) -> None:
    file.create_dataset("more", shape=(0, 3), dtype=float)


def claims_a_terabyte(file: h5py.File) -> None:
    del file["beta"]
    file.create_dataset("beta", shape=(2, 3, 21_000_000_000), chunks=(1, 1, 1_000_000), dtype=float, compression="gzip")


def objects(file: h5py.File) -> None:
    file.create_dataset("objects", data=[file.ref], dtype=h5py.ref_dtype)


def compound(file: h5py.File) -> None:
    file.create_dataset("compound", data=np.zeros(3, dtype=[("a", float), ("b", int)]))


def a_group(file: h5py.File) -> None:
    file.create_group("group")["x"] = 1


def virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout(shape=(2,), dtype=float)
    layout[:] = h5py.VirtualSource("/etc/passwd", "x", shape=(2,))
    file.create_virtual_dataset("virtual", layout)


def external(file: h5py.File) -> None:
    file.create_dataset("external", shape=(16,), dtype="i1", external=[("/etc/passwd", 0, 16)])


def unknown_filter(file: h5py.File) -> None:
    plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plist.set_chunk((4,))
    plist.set_filter(32001, h5py.h5z.FLAG_OPTIONAL, ())  # blosc's number: a plug-in that HDF5 would look for
    h5py.h5d.create(file.id, b"packed", h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((4,)), plist)


def label_of_bytes(file: h5py.File) -> None:
    file["beta"].attrs["long_name"] = np.array(b"\xc8\xcf", dtype=h5py.string_dtype())


def with_number(name: str, number: float) -> Callable[[h5py.File], None]:
    """The first case, which is solved, has another number; of an array along the rod in its middle."""

    def change(file: h5py.File) -> None:
        at = (*[0] * (file[name].ndim - 1), 10) if name == "z" else (0,) * file[name].ndim
        values = file[name][...].astype(float)
        values[at] = number
        file[name][...] = values

    return change


def empty_label(file: h5py.File) -> None:
    file["beta"].attrs["units"] = h5py.Empty("f")


BOMB = "[" * 1_000_000
HOSTILE: dict[str, tuple[Callable[[h5py.File], None], str]] = {  # what alters a file, and why it is refused
    "a link to another file": (
        linked(h5py.ExternalLink("../whole.h5", "/beta")),
        "is a link to another place; links are not followed",
    ),
    "a soft link": (linked(h5py.SoftLink("/alpha")), "is a link to another place; links are not followed"),
    "a soft link to itself": (linked(h5py.SoftLink("/beta")), ""),
    "an array in another file": (external, "is stored in another file; links are not followed"),
    "a view of another file": (virtual, "is stored in another file; links are not followed"),
    "a filter to be loaded": (unknown_filter, "is compressed with filter 32001"),
    "references": (objects, "must hold numbers or text, got object"),
    "records": (compound, "must hold numbers or text, got [("),
    "a folder": (a_group, "is not an array"),
    "a size that is not there": (
        claims_a_terabyte,
        "claims 1008000000000 bytes, but only 0 compressed bytes are stored",
    ),
    "no values": (no_values, "is empty: its shape is (0, 3)"),
    "NaN on an axis": (nan_on_an_axis, "the axis 'E' holds values that are not finite"),
    "a value twice on an axis": (value_twice, "the axis 'E' holds a value twice"),
    "no outcome": (without_variable("outcome"), ""),
    "no error": (without_variable("error"), ""),
    "no values of an axis": (without_variable("R"), ""),
    "outcomes that are numbers": (replaced("outcome", np.zeros((2, 3))), ""),
    "outcomes of other cases": (replaced("outcome", [b"solved"] * 5), ""),
    "text for an angle": (replaced("beta", np.full((2, 3, 21), b"x")), ""),
    "an angle of other cases": (replaced("beta", np.zeros((7, 7))), ""),
    "an axis of words": (replaced("E", [b"soft", b"stiff"]), ""),
    "an axis in two dimensions": (replaced("E", np.zeros((2, 2))), ""),
    "errors in two dimensions more": (replaced("error", np.zeros((2, 3, 4, 5))), ""),
    "no laws": (with_attribute("laws", None), ""),
    "no title": (with_attribute("title", None), ""),
    "no study": (with_attribute("study", None), ""),
    "no reading": (with_attribute("reading", None), ""),
    "no tolerance": (with_attribute("tolerance", None), ""),
    "a tolerance in words": (with_attribute("tolerance", "small"), ""),
    "a tolerance of NaN": (with_attribute("tolerance", np.nan), ""),
    "laws that are no JSON": (with_attribute("laws", "{"), ""),
    "laws that are code": (with_attribute("laws", "__import__('os').abort()"), ""),
    "laws nested without end": (with_attribute("laws", BOMB), "the attribute laws is not a list of laws in JSON"),
    "laws that are a number": (with_attribute("laws", "3"), ""),
    "laws of another kind": (with_attribute("laws", '[{"claim": 3}]'), ""),
    "a law on no axis": (
        with_attribute(
            "laws", '[{"claim": "c", "observable": "turns", "axis": "x", "direction": "falls", "source": "s"}]'
        ),
        "",
    ),
    "a title that is a number": (with_attribute("title", 3.0), ""),
    "a title that clears the terminal": (
        with_attribute("title", "\x1b[2J"),
        "the attribute title must be one line of text",
    ),
    "a title of two lines": (with_attribute("title", "a\nb"), ""),
    "a unit that is a list": (with_attribute("length_unit", ["cm", "N"]), ""),
    "a newer format": (with_attribute("format", 99), "is of format 99, but this version reads format"),
    "a format in words": (with_attribute("format", "new"), ""),
    "a label that is no text": (label_of_bytes, "is not UTF-8 text"),
    "no text at all": (with_attribute("study", h5py.Empty("f")), "the attribute 'study' is empty"),
    "an empty label": (empty_label, "'beta' the attribute 'units' is empty"),
    "a height of NaN": (with_number("z", np.nan), "'z' of a solved case is not finite"),
    "a height beyond reason": (with_number("z", 1e30), "'z' of a solved case is not finite, or beyond 1e+30"),
    "fewer bends than none": (with_number("turns", -1), "turns of a solved case cannot be -1"),
    "more than the whole rod pressed on": (with_number("attached", 7), "attached of a solved case cannot be 7"),
}


REASONS = {name: why for name, (_, why) in HOSTILE.items() if why} | {
    "a real folder": "is a folder",
    "a pipe": "is not a regular file",
    "a link in a circle": "Too many levels of symbolic links",
    "a link to a device": "is not a regular file",
    "a text": "cannot be read as HDF5",
}


@pytest.mark.parametrize(("commands", "names"), [(SOME, HOSTILE.keys() & REASONS.keys()), slow(ALL, HOSTILE.keys())])
def test_hostile_files_are_refused(commands, names, whole: bytes, tmp_path: Path) -> None:
    folder = tmp_path / "hostile"
    folder.mkdir()
    for name in names:
        (folder / name).write_bytes(whole)
        with h5py.File(folder / name, "a") as file:
            HOSTILE[name][0](file)
    (folder / "a text").write_text("title = 't'\n")
    (folder / "nothing").touch()
    (folder / "a real folder").mkdir()
    os.mkfifo(folder / "a pipe")
    (folder / "a link in a circle").symlink_to(folder / "a link in a circle")
    (folder / "a link to a device").symlink_to("/dev/zero")
    (tmp_path / "whole.h5").write_bytes(whole)
    rows = told(commands, folder, tmp_path)
    assert [row for row in rows if REASONS.get(row["file"], "") not in row["said"]] == []
    assert len(rows) == len(commands) * (len(names) + 6)
    assert [row for row in rows if row["status"] != 2 or not ends_in_a_sentence(row)] == []
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.parametrize(("commands", "cuts", "flips"), [(SOME, 2, 4), slow(ALL, 50, 200)])
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
    assert [row for row in rows if not ends_in_a_sentence(row)] == []
    assert all(row["status"] == 2 for row in rows if row["file"].startswith("cut"))


@pytest.mark.parametrize(("count", "seed"), [(6, 1), slow(1000, 2)])
def test_changed_bits_are_noticed(count: int, seed: int, tmp_path: Path) -> None:
    """A file with one bit changed is refused, or all of it that is read is as it was."""
    path, random = stored(tmp_path / "good.h5"), Random(seed)
    whole, good = path.read_bytes(), writing.read(path)
    for _ in range(count):
        content = bytearray(whole)
        content[random.randrange(len(whole))] ^= 1 << random.randrange(8)
        path.write_bytes(content)
        try:
            found = writing.read(path)
        except InputError:
            continue
        xr.testing.assert_identical(found, good)


@pytest.mark.slow
def test_a_file_without_any_one_of_its_variables_is_drawn_or_refused(whole: bytes, tmp_path: Path) -> None:
    folder = tmp_path / "lacking"
    folder.mkdir()
    (tmp_path / "whole.h5").write_bytes(whole)
    with h5py.File(tmp_path / "whole.h5") as file:
        names = list(file)
    for name in names:
        (folder / name).write_bytes(whole)
        with h5py.File(folder / name, "a") as file:
            del file[name]
    assert [row for row in told(ALL, folder, tmp_path) if not ends_in_a_sentence(row)] == []


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


def altered_files_end_in_a_sentence(base: str, stride: int, tmp_path: Path, *commands: str) -> None:
    paths = tmp_path / "base.h5", tmp_path / "good.h5"
    for path, study in zip(paths, (BASES[base], small.study(ONE_AXIS.format("[3e4]"), HEAD)), strict=True):
        writing.write(in_memory.run(study), path)
    run = forked.run("-m", "tests.workbench.altered", *paths, tmp_path, stride, 0, *commands, timeout=3600)
    assert run.returncode == 0, run.stderr[-2000:]
    assert [json.loads(line) for line in run.stdout.splitlines()] == []


@pytest.mark.parametrize(
    ("base", "commands"), [("one axis", ("check", "export csv")), ("samples", ("check", "summary"))]
)
def test_a_study_that_is_altered_in_one_place_is_read_or_refused_in_a_sentence(base, commands, tmp_path: Path) -> None:
    altered_files_end_in_a_sentence(base, 997, tmp_path, *commands)


def test_arrays_along_the_rod_without_their_arc_lengths_are_refused(tmp_path: Path) -> None:
    path = writing.write(in_memory.run(BASES["one axis"]).drop_vars("s"), tmp_path / "no.h5")
    with pytest.raises(InputError, match=r"no\.h5: \w+ is an array along the rod, but s is missing"):
        reading.open_study(path)


@pytest.mark.slow
@pytest.mark.parametrize("base", BASES)
def test_every_alteration_of_a_study_ends_in_a_sentence(base: str, tmp_path: Path) -> None:
    if not opengl.probe()[0]:
        pytest.skip("scenes cannot be drawn here")
    altered_files_end_in_a_sentence(base, 1, tmp_path)


UNITS = ("$\\mathrm{", "$x$ and $\\frac{", "\\alpha $")


@pytest.mark.parametrize("text", slow_but(UNITS, UNITS[1]))
def test_a_dollar_in_a_units_name_is_drawn_as_it_is(whole: bytes, tmp_path: Path, text: str) -> None:
    path = tmp_path / "dollar.h5"
    path.write_bytes(whole)
    with h5py.File(path, "a") as file:
        for name in ("E", "R", "contact", "turns"):
            file[name].attrs["units"] = file[name].attrs["long_name"] = text
        file.attrs["title"] = text
    out = tmp_path / "out.png"
    canvas.save(study_figure.figure(writing.read(path)), out, 50)
    assert out.exists()


NUMBERS = {
    "no radius": ("rho", np.nan, "rho must be finite, got nan"),
    "a radius of nothing": ("rho", 0.0, r"rho must be from 1e-50 to 1e\+50, got 0"),
    "a radius that is another": ("rho", 17.0, r"rho is not R \+ a"),
    "no load": ("FZ", np.nan, "FZ of a solved case is not finite, or far too large for its rod"),
    "a load without end": ("MZ", np.inf, "MZ of a solved case is not finite"),
    "a load that no float holds": ("M3", 1e300, "M3 of a solved case is not finite, or far too large for its rod"),
    "no arc": ("s", np.nan, "s must be u L"),
    "an arc the other way": ("s", -1.0, "s must be u L"),
    "one station": ("u", 0.5, "u must rise from 0 to 1"),
    "an angle that is none": ("beta", np.nan, "'beta' of a solved case is not finite"),
    "a leap along the cylinder": ("z", 1e3, "z of a solved case moves farther than the rod is long"),
    "an error that is none": ("error", np.nan, "error of a solved case must be a number and not negative"),
}


@pytest.mark.parametrize("name", NUMBERS)
def test_numbers_that_cannot_be_are_refused_on_reading_and_named(whole: bytes, tmp_path: Path, name: str) -> None:
    path = tmp_path / "altered.h5"
    path.write_bytes(whole)
    variable, value, sentence = NUMBERS[name]
    with h5py.File(path, "a") as file:
        file[variable][(0,) * file[variable].ndim] = value
    with pytest.raises(InputError, match=sentence):
        writing.read(path)


@pytest.mark.parametrize("name", ["outcome", slow("caution")])
def test_numbers_in_place_of_words_are_refused(whole: bytes, tmp_path: Path, name: str) -> None:
    with xr.open_dataset(BytesIO(whole), engine="h5netcdf") as ds:
        ds.assign({name: xr.zeros_like(ds["error"])}).to_netcdf(tmp_path / "numbers.h5", engine="h5netcdf")
    with pytest.raises(InputError, match=f"'{name}' must hold text, got float64"):
        writing.read(tmp_path / "numbers.h5")


@pytest.mark.parametrize(
    "name, key, value, sentence",
    [
        ("turns", "add_offset", "x", "'turns' has the attribute add_offset, which the format does not allow"),
        ("E", "scale_factor", 2.0, "'E' has the attribute scale_factor, which the format does not allow"),
        ("nu", "_FillValue", "$", "the attribute _FillValue of 'nu' must be a number"),
    ],
)
def test_numbers_that_are_stored_as_others_are_refused(
    whole: bytes, tmp_path: Path, name: str, key: str, value: Any, sentence: str
) -> None:
    path = tmp_path / "scaled.h5"
    path.write_bytes(whole)
    with h5py.File(path, "a") as file:
        file[name].attrs[key] = value
    with pytest.raises(InputError, match=sentence):
        writing.read(path)


COMMANDS = "\x1b[2J \x9b31m \x07 \u202e \u2028 \x00"


def test_what_commands_a_terminal_is_written_as_python_writes_it() -> None:
    assert escaping.line(COMMANDS) == r"\x1b[2J \x9b31m \x07 \u202e \u2028 \x00"
    assert escaping.lines("é 漢 🙂 β\n\tplain") == "é 漢 🙂 β\n\tplain"
    packed = escaping.in_json(json.dumps({"a": COMMANDS, "é": "🙂\n"}, ensure_ascii=False))
    assert packed.isprintable()
    assert "🙂" in packed
    assert json.loads(packed) == {"a": COMMANDS, "é": "🙂\n"}


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
    assert stored_run.look(path) is not None
    shutil.copy(path, other)
    with h5py.File(path, "a") as file:
        del file["E"]
        file["E"] = h5py.ExternalLink("other.h5", "/E")  # the very same values
    assert stored_run.look(path) is None


def test_a_run_into_a_pipe_is_refused_and_waits_for_nobody(tmp_path: Path) -> None:
    runs.study(tmp_path, runs.grid(2, 2))
    os.mkfifo(tmp_path / "many.h5")
    done = runs.run(tmp_path, "many.toml", limit=600)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "workbench: many.h5 exists and is not a study's dataset; give --force to replace it\n"


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


@pytest.mark.parametrize("older", [1, None])
@pytest.mark.parametrize("name, said", [("small", "STUDY"), ("fig6", "fig6")])
def test_a_file_of_an_older_format_is_refused_with_the_command_that_makes_it_again(
    whole: bytes, tmp_path: Path, older: int | None, name: str, said: str
) -> None:
    path = tmp_path / "old.h5"
    path.write_bytes(whole)
    with h5py.File(path, "a") as file:
        del file.attrs["format"], file["solved"]
        file.attrs["study_name"] = name
        if older is not None:
            file.attrs["format"] = older
    again = f"make it again with: workbench run {said} --out {path}"
    with pytest.raises(InputError, match=re.escape(f"is of format 1, but this version reads format 2; {again}")):
        writing.read(path)


def test_a_run_makes_a_file_of_an_older_format_again(tmp_path: Path) -> None:
    path = tmp_path / "small.h5"
    study = small.study(AXES.format("[1e4]"), HEAD)
    run_to_file(study, path)
    with h5py.File(path, "a") as file:
        file.attrs["format"] = 1
    assert run_to_file(study, path).solved == 3
    assert writing.read(path).attrs["format"] == schema.FORMAT


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
