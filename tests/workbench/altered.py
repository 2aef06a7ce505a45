"""Stored studies with one thing altered: every variable and every attribute, each in a dozen ways, by rule.

Run as a program: the commands on them, all in one process, and what is wrong with how they end. The two ways in which
commands read a file are tried on every altered file. What they let in is given to all commands, some alterations of one
way at a time: those of another are halved until a single one is wrong. So is every hundredth of what they refuse.
"""

import contextlib
import io
import json
import shutil
import sys
import warnings
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from random import Random
from typing import Any

import h5py
import numpy as np
import xarray as xr

Change = Callable[[Path], None]

LONG = "x" * 50_000
TEXTS: dict[str, Any] = {
    "empty": "",
    "very long": LONG,
    "mathtext": "$\\mathrm{",
    "mathtext closed": "$\\frac{$ $\\nothing$",
    "a terminal's command": "\x1b[2J\x1b]0;title\x07",
    "a terminal's command of one byte": "\x9b31m",
    "a new line": "one\ntwo",
    "a carriage return": "one\rtwo",
    "text from right to left": "\u202eabc\u2066",
    "a line separator": "a\u2028b",
    "markup": "[red]x[/red][/nothing]",
    "a template": "{0.__class__}{{7*7}}%s%n",
}
OTHERS: dict[str, Any] = {
    "a number": 3.5,
    "NaN": np.nan,
    "a list": np.array([1.0, 2.0]),
    "a NUL": np.bytes_(b"a\x00b"),
    "no text in UTF-8": np.array(b"\xc8\xcf", dtype=h5py.string_dtype()),
    "nothing": h5py.Empty("f"),
    "missing": None,
}
DECODED: dict[str, Any] = {
    "scale_factor": 1e300, "add_offset": "x", "missing_value": 0.0, "units": "days since 2000-01-01",
    "coordinates": "outcome", "dtype": "bool",
}  # fmt: skip
# Of the attributes of a variable these alone: there are many.
LABELS = ("empty", "very long", "mathtext", "a terminal's command", "a new line", "a number", "a NUL", "missing")
HDF5S_OWN = ("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates",
             "_NCProperties", "_nc3_strict")  # fmt: skip


def alterations(path: Path) -> Iterator[tuple[str, str, Change]]:
    """Place, way and change of every altered file that is made of the one at `path`."""
    with xr.open_dataset(path, engine="h5netcdf") as ds:
        variables = {str(name): (variable.dtype.kind, variable.ndim) for name, variable in ds.variables.items()}
    with h5py.File(path) as file:
        own = [key for key in file.attrs if key not in HDF5S_OWN]
        theirs = {name: [key for key in file[name].attrs if key not in HDF5S_OWN] for name in file}
    for name, (kind, ndim) in variables.items():
        for what, change in (_numbers() if kind in "biuf" else _words()).items():
            yield name, what, _in_place(name, change)
        for what, made in _structures(ndim).items():
            yield name, what, _rewritten(name, made)
    for where, keys in {"": own, **theirs}.items():
        for key in keys:
            for what, value in {**TEXTS, **OTHERS}.items():
                if where and what not in LABELS:
                    continue
                yield f"{where} @{key}", what, _attribute(where, key, value)
        if where:
            for key, value in DECODED.items():
                yield f"{where} @{key}", "that is decoded", _attribute(where, key, value)


def _numbers() -> dict[str, Callable[[Any], Any]]:
    def first(value: float) -> Callable[[Any], Any]:
        def change(values: Any) -> Any:
            values = values.copy()
            values[(0,) * values.ndim] = value
            return values

        return change

    return {
        "all NaN": lambda v: np.full_like(v, np.nan),
        "all inf": lambda v: np.full_like(v, np.inf),
        "all -inf": lambda v: np.full_like(v, -np.inf),
        "all 0": np.zeros_like,
        "negative": lambda v: -np.abs(v) - 1,
        "huge": lambda v: np.full_like(v, 1e300),
        "tiny": lambda v: np.full_like(v, 5e-324),
        "one NaN": first(np.nan),
        "one inf": first(np.inf),
        "one huge": first(1e300),
        "reversed": lambda v: v[::-1] if v.ndim == 1 else v[..., ::-1] if v.ndim else v * 2,
    }


def _words() -> dict[str, Callable[[Any], Any]]:
    return {f"all {what}": lambda v, text=text: np.full(v.shape, text, dtype=object) for what, text in TEXTS.items()}


def _structures(ndim: int) -> dict[str, Callable[[xr.Variable], xr.Variable | None]]:
    found: dict[str, Callable[[xr.Variable], xr.Variable | None]] = {
        "missing": lambda v: None,
        "of another shape": lambda v: xr.Variable(("other",), np.zeros(7) if v.dtype.kind in "iuf" else ["a"] * 7),
        "of text": lambda v: xr.Variable(v.dims, np.full(v.shape, "text")),
        "of bytes": lambda v: xr.Variable(v.dims, np.zeros(v.shape, dtype="i1")),
        "of single precision": lambda v: xr.Variable(v.dims, np.zeros(v.shape, dtype="f4")),
        "with a dimension more": lambda v: v.set_dims({"other": 3, **dict(zip(v.dims, v.shape, strict=True))}),
    }
    if ndim:
        found["of one value"] = lambda v: xr.Variable((), v.values.ravel()[0], v.attrs)
    if ndim > 1:
        found["transposed"] = lambda v: v.transpose()
    return found


def _in_place(name: str, change: Callable[[Any], Any]) -> Change:
    def work(path: Path) -> None:
        with h5py.File(path, "a") as file, np.errstate(all="ignore"):
            values = file[name][...]
            if values.dtype.kind in "iu":
                values = change(values.astype(float))
                values = np.nan_to_num(values, nan=-1, posinf=2**31, neginf=-(2**31)).clip(-(2**62), 2**62)
            else:
                values = change(values)
            file[name][...] = values

    return work


def _rewritten(name: str, make: Callable[[xr.Variable], xr.Variable | None]) -> Change:
    """The whole file written again with another variable; dimensions that no longer fit lose their names."""

    def work(path: Path) -> None:
        with h5py.File(path, "a") as file:
            old = file[name]
            dims = [dim[0].name.strip("/") if len(dim) else f"own {i}" for i, dim in enumerate(old.dims)]
            made = make(xr.Variable(dims, old[...], dict.fromkeys(())))
            attrs = {key: value for key, value in old.attrs.items() if key not in HDF5S_OWN}
            scales = [other for other in file if other != name and any(_scaled(dim, old) for dim in file[other].dims)]
            del file[name]
            if made is None:
                return
            values = made.values
            kind = h5py.string_dtype() if values.dtype.kind in "UO" else values.dtype
            new = file.create_dataset(name, data=values.astype(object) if values.dtype.kind in "UO" else values,
                                      dtype=kind)  # fmt: skip
            for key, value in attrs.items():
                new.attrs[key] = value
            if dims == [name] and made.ndim == 1 and made.dims == (name,):
                new.make_scale(name)
                for other in scales:
                    _scale_again(file[other], name, new)
            else:
                for i, dim in enumerate(made.dims):
                    if dim in file and file[dim].is_scale:
                        new.dims[i].attach_scale(file[dim])

    return work


def _scaled(dim: Any, scale: Any) -> bool:
    return any(dim[i] == scale for i in range(len(dim)))


def _scale_again(other: Any, name: str, new: Any) -> None:
    for dim, size in zip(other.dims, other.shape, strict=True):
        if not any(True for i in range(len(dim)) if dim[i]) and size == new.shape[0]:
            dim.attach_scale(new)


def _attribute(where: str, key: str, value: Any) -> Change:
    def work(path: Path) -> None:
        with h5py.File(path, "a") as file:
            at = file[where] if where else file
            at.attrs.pop(key, None)
            if value is not None:
                at.attrs[key] = value

    return work


def commands(path: Path, good: Path, out: Path) -> dict[str, list[str]]:
    """What is asked of every altered file; good: another dataset of the same study, to be merged with it."""
    coarse = ["--dpi", "50"]
    asked = {
        "check": ["check", "FILE"],
        "check --json": ["check", "FILE", "--json"],
        "summary": ["summary", "FILE"],
        "summary --json": ["summary", "FILE", "--json"],
        "plot": ["plot", "FILE", "--out", str(out / "plot.png"), *coarse],
        "scene": ["scene", "FILE", "--out", str(out / "scene.png"), *coarse],
        "merge": ["merge", "FILE", str(good), "--out", str(out / "merged.h5")],
    }
    for kind in ("csv", "vtp", "stl", "glb"):
        asked[f"export {kind}"] = ["export", "FILE", "--out", str(out / f"rod.{kind}")]
    asked["export step"] = ["export", "FILE", "--out", str(out / "rod.step"), "--tolerance", "0.01", "--centreline"]
    return {name: [str(path) if word == "FILE" else word for word in words] for name, words in asked.items()}


def ended(words: list[str], out: Path) -> tuple[Any, list[str]]:
    """The status of a command and what is wrong with how it ended; `out` is where it may write, empty before.

    Right is: status 0 or 1 and no word of Python's on stderr; or 2, one sentence there and nothing written. Never a
    character that a terminal would obey.
    """
    from workbench import cli
    from workbench.commands import console

    told, said = io.StringIO(), io.StringIO()
    before = console.out().file, console.err().file
    console.out().file, console.err().file = told, said
    status: Any = "no end"
    try:
        with contextlib.redirect_stdout(told), contextlib.redirect_stderr(said), warnings.catch_warnings():
            warnings.simplefilter("always")
            cli.main(words)
    except SystemExit as end:
        status = end.code
    except BaseException as error:
        return None, [f"ended in {error!r:.300}"]
    finally:
        console.out().file, console.err().file = before
    lines = said.getvalue().splitlines(keepends=True)
    found, sentence = [], "".join(line for line in lines if not line.startswith("workbench: notice: "))
    obeyed = {one for one in told.getvalue() + sentence if not one.isprintable() and one not in "\n\t"}
    if obeyed:
        found.append(f"printed {obeyed}")
    if status not in (0, 1, 2):
        found.append(f"status {status}")
    if status == 2 and not (sentence.startswith("workbench: ") and sentence.count("\n") == 1 and len(sentence) < 1500):
        found.append(f"said {sentence[-300:]!r}")
    if status != 2 and ("Warning" in sentence or "Traceback" in sentence):
        found.append(f"warned {sentence[-300:]!r}")
    left = [path.name for path in out.iterdir()]
    if status == 2 and left:
        found.append(f"left {left}")
    for path in out.iterdir():
        path.unlink()
    return status, found


Altered = tuple[str, str, Change]
DOORS = ("check", "export csv")  # which read lazily and at once, as all others do
TOGETHER = 16  # alterations of one way that commands are given in one file


def ends_of(altered: list[Altered], base: Path, good: Path, names: Sequence[str] = ()) -> dict[str, tuple[Any, list]]:
    """The status of each named command (default: all) on a file with these alterations, and what is wrong with it."""
    path, out = base.with_name("altered.h5"), base.with_name("out")
    out.mkdir(exist_ok=True)
    shutil.copy(base, path)
    for _, _, change in altered:
        change(path)
    return {name: ended(words, out) for name, words in commands(path, good, out).items() if not names or name in names}


def tell(altered: Altered, ends: dict[str, tuple[Any, list]]) -> None:
    """Print each fault as a JSON line."""
    for name, (_, faults) in ends.items():
        for fault in faults:
            print(json.dumps(f"{altered[0]} {altered[1]}: {name} {fault}"), flush=True)


def halve(altered: list[Altered], base: Path, good: Path, names: Sequence[str] = ()) -> None:
    """Give commands a file with alterations that are let in; those that refuse it or fail get each half of them."""
    ends = ends_of(altered, base, good, names)
    wrong = [name for name, (status, faults) in ends.items() if faults or status not in (0, 1)]
    middle = len(altered) // 2
    if not middle:
        tell(altered[0], ends)
    elif wrong:
        halve(altered[:middle], base, good, wrong)
        halve(altered[middle:], base, good, wrong)


def main(base: Path, good: Path, count: str) -> None:
    """Alter the study at `base` and print each fault as a JSON line.

    count: of so many alterations, drawn with a seed, by the doors alone; 0: of all, by all commands.
    """
    with h5py.File(base, "a") as file:  # which would refuse nearly all of them first
        file.attrs.pop("checksums", None)
    rows, let_in = list(alterations(base)), defaultdict[tuple[str, bool], list[Altered]](list)
    for k, row in enumerate(Random(1).sample(rows, int(count) or len(rows))):
        ends = ends_of([row], base, good, () if k % 100 == 99 else DOORS)
        tell(row, ends)
        if not int(count) and all(ends[door][0] in (0, 1) for door in DOORS):
            let_in[row[1], "@" in row[0]].append(row)  # an attribute of a variable that is missing cannot be altered
    for same in let_in.values():
        for k in range(0, len(same), TOGETHER):
            halve(same[k : k + TOGETHER], base, good)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3])
