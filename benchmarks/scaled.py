"""What breaks where a tuned constant of the solver is ten times larger. Run from the checkout (some minutes a room):

    python -m benchmarks.scaled branches held   # rooms, or modules such as nodes/banded_newton
    python -m benchmarks.scaled --by 0.1 nodes

Each number in the head of a module is changed in a process of its own, and some problems that run a function with it
are solved again: the stored ones of tests/golden.json, and others with weight, friction and held ends. A line says of
how many problems the answer stays, differs in its digits, or is another one (an outcome, a count, an end of a branch),
and the time over that before. Constants that are computed from one where it stands keep their values. `scaled.txt` sums
up what it said of all rooms.
"""

import argparse
import ast
import importlib
import inspect
import json
import math
import os
import pkgutil
import resource
import sys
import warnings
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from functools import partial
from importlib.util import resolve_name
from pathlib import Path
from time import process_time
from types import FrameType
from typing import Any

import numpy as np

import solver
from solver import fit, follow, solve
from solver.core.library import library
from solver.switch import switch
from tests.golden import Row, answer, case_of, differences, rows, sentence, solution_of

HERE = Path(solver.__file__).parent
EACH, LONG = 0.5, 1.2  # seconds of the problems of a constant; of one that is left out where others do
PIPE = {"EI": 1.228e6, "GJ": 9.45e5, "a": 0.0635, "weight": 242.0}  # 5 inch, in N and m
HOLE = {"R": 0.10795, "side": "inside", "inclination": "90deg"}
BUCKLES = 2 * math.sqrt(1.228e6 * 242 / (0.10795 - 0.0635))
Profiles = list[tuple[Row, float, set[tuple[str, str]]]]  # problems, seconds, the functions (file, name) that they run
SMALL = {"EI": 1.0, "GJ": 0.8, "a": 0.1}


def further_rows() -> Iterator[Row]:
    """Problems beside the stored ones: pipes, rods with weight or friction, held ends, lists."""

    def row(kind: str, name: str, rod: Row, cylinder: Row, ends: Row, **more: Any) -> Row:
        return {"kind": kind, "name": name, "rod": rod, "cylinder": cylinder, "ends": ends, **more}

    clamped = {"beta0": 0.0, "betaL": 0.0, "azimuth": 0.0}
    for L, load in ((60, 0.8), (120, 1.1), (300, 1.6), (1000, 1.3), (2000, 1.05)):
        yield row("shape", f"pipe {L} {load}", {"L": L, **PIPE}, HOLE, {**clamped, "FZ": -load * BUCKLES})
    for way in ("forward", "axial-forward", "rotating"):
        rubbed = {**HOLE, "friction": 0.3, "sliding": way}
        yield row("shape", f"pipe {way}", {"L": 500.0, **PIPE}, rubbed, {**clamped, "FZ": -1.3 * BUCKLES})
    rng = np.random.default_rng(5)
    for i in range(14):
        ends = dict(zip(("beta0", "betaL", "FZ", "M3", "alpha"), rng.normal(0, 0.8, 5).tolist(), strict=True))
        wall = {"R": 0.8, "inclination": float(rng.uniform(0, 3)), "side": ("outside", "inside")[i % 2]}
        wall |= {"friction": 0.2} if i % 3 == 0 else {}
        rod = {**SMALL, "L": float(rng.uniform(2, 12)), "weight": float(10 ** rng.uniform(-2, 0))}
        ends |= {"azimuth": 0.3} if i % 4 == 2 else {}
        yield row("shape", f"general {i}", rod, wall, ends, observe=i % 2 == 0)
    for L in (3, 5):
        wall, ends = {"R": 0.8, "inclination": "70deg"}, {"beta0": 0.3, "betaL": -0.2, "FZ": -2.5, "alpha": 0.4}
        yield row("equilibria", f"list with weight, L = {L:g}", {**SMALL, "L": L, "weight": 0.5}, wall, ends)
    for name, ends in (
        ("height", {"beta0": 0.3, "betaL": 0.2, "height": 4.2}),
        ("both", {"beta0": 0.3, "betaL": 0.2, "height": 4.0, "azimuth": 1.0}),
        ("hinge", {"M10": 0.0, "betaL": 0.2, "height": 4.4}),
    ):
        yield row("equilibria", f"list, held {name}", {**SMALL, "L": 5.0}, {"R": 0.9}, ends)
    yield from rows_of_other_kinds()
    rod, wall = {"E": 1.07e4, "nu": 0.25, "a": 0.25, "L": 6.0, "weight": 0.1}, {"R": 0.75, "inclination": "60deg"}
    for name, values in (("FZ", [-20.0, -8.66, 0.0]), ("L", [3.0, 6.0, 8.0]), ("weight", [0.0, 0.1, 0.5])):
        ends = {"beta0": 0.5, "betaL": 0.8, "FZ": -8.66}
        yield row("follow", f"follow {name} with weight", rod, wall, ends, over={name: values})


def rows_of_other_kinds() -> Iterator[Row]:
    """Problems of which golden.json has none or only long ones, each as small as it can be."""
    wall, low, upright = {"R": 0.9}, {"R": 0.9, "inclination": "70deg"}, {"R": 0.9, "inclination": "0deg"}
    bent, buckled = (
        {"beta0": 0.5, "betaL": 0.8, "FZ": -2.0, "MZ": 0.2, "M3": 0.3},
        {"beta0": 0.0, "betaL": 0.0, "FZ": -1.0},
    )
    held, hinged = {"beta0": 0.3, "betaL": 0.2, "height": 4.0}, {"M10": 0.0, "M1L": 0.0, "FZ": -0.8}
    start = {"beta": 0.5, "dbeta": 0.3, "F2": 0.1, "F3": 1.0, "M3": 0.2}

    def row(kind: str, ends: Row, cylinder: Row, L: float = 5.0, *, weight: float = 0.0, **more: Any) -> Row:
        rod = {**SMALL, "L": L} | ({"weight": weight} if weight else {})
        name = f"{kind} {weight} " + " ".join(f"{name}={value}" for name, value in ends.items())
        return {"kind": kind, "name": name, "rod": rod, "cylinder": cylinder, "ends": ends, **more}

    plane = {"FZ": [-1.6, -0.4], "L": [3.0, 4.5]}
    yield row("folds", bent, wall, 4.0, lattice=2, over=plane)
    yield row("folds", buckled, wall, 4.0, lattice=2, over=plane)
    yield row("folds", buckled, low, 4.0, weight=0.3, lattice=2, over=plane)
    yield row("folds", held, wall, lattice=2, over={"height": [3.6, 4.2], "L": [4.8, 5.4]})
    yield row("switch", buckled, wall, 4.0, over={"FZ": [-1.2, -0.2]})
    for ends in (held, hinged):
        yield row("follow", ends, wall, over={"L": [5.0, 5.5]})
        yield row("follow", ends, low, weight=0.3, over={"L": [5.0, 5.5]})
    yield row("shape", held, low, weight=0.3)
    yield row("shape", {}, low, weight=0.3, start=start)
    yield row("shape", held | {"azimuth": 1.0}, wall)
    yield row("equilibria", {"M10": 0.1, "betaL": 0.2, "height": 4.4}, wall)
    yield row("equilibria", hinged, low, 4.0, weight=0.3)
    yield row("equilibria", bent | {"MZ": 0.0}, upright, 6.0, weight=0.3)
    for changed in ({"FZ": -4.0}, {"MZ": 0.5}, {"M3": 0.0}):
        yield row("free", bent | changed, wall)
    yield row("free", bent, {"R": 1.1, "side": "inside"})
    yield row("free", bent, low, weight=0.3)
    yield row("descent", bent, wall, 4.0)
    for push in (-3.0, 0.0, 3.0):
        yield row("cautions", bent | {"FZ": push}, wall)
        yield row("cautions", bent | {"FZ": push}, low, weight=0.3)
    for method in ("shooting", "difference", "collocation"):
        yield row("method", bent, wall, method=method)
    for method in ("orbit", "swing", "dop853", "verlet"):
        yield row("method", {}, wall, method=method, start=start)
    yield row("points", bent, wall, 4.0, vary=["FZ", "MZ"])
    straight = {"beta0": 0.0, "betaL": 0.0, "azimuth": 0.0}
    for L, load, hole in ((3000, 3.0, HOLE), (1500, -2.0, {**HOLE, "inclination": "45deg"})):  # a helix; a taut pipe
        name, ends = f"pipe {L} {load}", {**straight, "FZ": -load * BUCKLES}
        yield {"kind": "shape", "name": name, "rod": {"L": L, **PIPE}, "cylinder": hole, "ends": ends}


def free_shape(row: Row) -> Row:
    """The rod that is let go: its ends, pushes and contacts."""
    rod = solution_of(row).let_go()
    numbers = {name: float(getattr(rod, name)[-1]) for name in ("beta", "alpha", "z", "radius")}
    return {
        "outcome": sentence(rod.outcome),
        "contacts": len(rod.contacts),
        **numbers,
        "largest": float(rod.radius.max()),
    }


def motion(row: Row) -> Row:
    """The energies on the way down of a rod that is let go."""
    return {"energies": solution_of(row).descent(4)[1].tolist()}


def side_branches(row: Row) -> Row:
    """What branches off a branch."""
    branch = follow(solution_of(row), **row["over"])
    special = [point for point in branch.special if point.kind != "fold"]
    return {"off": [[float(one.dbeta[0]) for one in switch(branch, point)] for point in special[:1]]}


def cautions(row: Row) -> Row:
    return {"caution": sentence(solution_of(row).caution)}


def far_end(row: Row) -> Row:
    """The far end by one of the methods."""
    rod = solve(case_of(row), tol=1e-8, stations=9, method=row["method"])
    return {"outcome": sentence(rod.outcome), "beta": float(rod.beta[-1]), "z": float(rod.z[-1])}


def fit_to_points(row: Row) -> Row:
    """A fit to places of the rod itself, without their arc lengths, from other loads."""
    rod = solution_of(row)
    points = {"alpha": rod.alpha[1:], "z": rod.z[1:]}
    other = {name: 0.9 * row["ends"][name] for name in row["vary"]}
    fitting = fit(case_of({**row, "ends": row["ends"] | other}), row["vary"], points=points, starts=2)
    return {"outcome": sentence(fitting.outcome), "values": fitting.values}


KINDS = {
    "free": free_shape, "descent": motion, "switch": side_branches, "cautions": cautions, "method": far_end,
    "points": fit_to_points,
}  # fmt: skip


def result(row: Row) -> Row:
    """The answer of a problem, or how it fails, as JSON reads it."""
    try:
        return json.loads(json.dumps(KINDS.get(row["kind"], answer)(row)))
    except Exception as error:
        return {"crash": f"{type(error).__name__}: {error}"}


def profiles() -> Profiles:
    """Each problem with its answer of now, its seconds, and the functions of the solver that run for it."""
    out = []
    for row in [*rows()[::2], *further_rows()]:
        ran: set[tuple[str, str]] = set()

        def note(frame: FrameType, event: str, _: Any, ran: set[tuple[str, str]] = ran) -> None:
            if event == "call" and frame.f_code.co_filename.startswith(str(HERE)):
                ran.add((frame.f_code.co_filename, frame.f_code.co_name))

        begun = process_time()
        sys.setprofile(note)
        now = result(row)
        sys.setprofile(None)
        out.append(({**row, "answer": now}, process_time() - begun, ran))
    return out


class Modules:
    """The modules of the solver: their trees, and which names each imports from which."""

    def __init__(self) -> None:
        names = [module.name for module in pkgutil.walk_packages(solver.__path__, "solver.")]
        self.of = {n: importlib.import_module(n) for n in names if not n.endswith(("__main__", ".rod"))}
        self.trees = {n: ast.parse(inspect.getsource(module)) for n, module in self.of.items()}
        self.users: dict[tuple[str, str], list[tuple[str, str]]] = defaultdict(list)
        for name, tree in self.trees.items():
            for node in ast.walk(tree):
                if isinstance(node, ast.ImportFrom):
                    source = resolve_name("." * node.level + (node.module or ""), str(self.of[name].__package__))
                    for alias in node.names:
                        self.users[source, alias.name].append((name, alias.asname or alias.name))

    def holders(self, module: str, name: str) -> list[tuple[str, str]]:
        """The modules that have a name, and what each calls it."""
        out = [(module, name)]
        for holder in out:
            out += [user for user in self.users[holder] if user not in out]
        return out

    def readers(self, module: str, name: str) -> set[tuple[str, str]]:
        """The functions that read a name, as (file, function)."""
        return {
            (str(self.of[other].__file__), node.name)
            for other, local in self.holders(module, name)
            for node in ast.walk(self.trees[other])
            if isinstance(node, ast.FunctionDef)
            and any(isinstance(part, ast.Name) and part.id == local for part in ast.walk(node))
        }

    def change(self, module: str, name: str, new: Any) -> None:
        """Give a constant another value, also as the default of a parameter, in the core and in what is cached."""
        old = getattr(self.of[module], name)
        for other, local in self.holders(module, name):
            setattr(self.of[other], local, new)
            for function in vars(self.of[other]).values():
                if inspect.isfunction(function) and function.__defaults__ and isinstance(old, float):
                    function.__defaults__ = tuple(new if value is old else value for value in function.__defaults__)
        for kept in [value for other in self.of.values() for value in vars(other).values()]:
            if hasattr(kept, "cache_clear"):
                kept.cache_clear()
        library()  # gives the core the constants that C reads too

    def constants(self, rooms: list[str]) -> Iterator[tuple[str, str]]:
        """Module and name of each constant in the heads of the modules of some rooms."""
        for module, tree in self.trees.items():
            if any(module.startswith("solver." + room.replace("/", ".")) for room in rooms):
                for node in tree.body:
                    if isinstance(node, ast.Assign) and not is_enumeration(node.value):
                        parts = [part for part in ast.walk(node.targets[0]) if isinstance(part, ast.Name)]
                        yield from ((module, part.id) for part in parts if part.id.isupper())


def is_enumeration(value: ast.expr) -> bool:
    """Whether constants are only told apart: range(3), or -1, 0 and 1 in some order."""
    text = ast.unparse(value).strip("()")
    return text.startswith("range") or ("," in text and set(text.split(", ")) <= {"-1", "0", "1", "2"})


def scalings(value: Any, by: float) -> Iterator[tuple[str, Any]]:
    """The value times a factor, or each number of a record so, with its name."""
    if isinstance(value, float) or (isinstance(value, int) and not isinstance(value, bool)):
        yield "", type(value)(max(value * by, 1) if isinstance(value, int) else value * by)
    elif isinstance(value, tuple) and value and all(type(part) is float for part in value):
        yield "", tuple(part * by for part in value)
    elif is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            for _, new in scalings(getattr(value, field.name), by):
                yield f".{field.name}", replace(value, **{field.name: new})


def compare(change: Callable[[], None], chosen: list[Row], limit: float) -> list[tuple[str, float, str]]:
    """Solve problems after a change, in a process of its own: of each what differs, its seconds, a first difference."""
    read, write = os.pipe()
    if os.fork() == 0:
        resource.setrlimit(resource.RLIMIT_CPU, (int(limit), int(limit) + 1))
        change()
        with os.fdopen(write, "w") as out:
            for row in chosen:
                begun, now = process_time(), result(row)
                off = differences(row, now)
                kind = "same" if not off else "digits" if frame(now) == frame(row["answer"]) else "other"
                first = f"{row['name']}: {off[:1]}"[:150]
                print(json.dumps([kind, process_time() - begun, first]), file=out, flush=True)
        os._exit(0)
    os.close(write)
    with os.fdopen(read) as lines:
        compared = [json.loads(line) for line in lines]
    os.wait()
    return compared


def frame(value: Any) -> Any:
    """An answer without its numbers that are not whole."""
    if isinstance(value, dict):
        return {name: frame(part) for name, part in value.items()}
    return [frame(part) for part in value] if isinstance(value, list) else "#" if isinstance(value, float) else value


def choose(known: Profiles, readers: set[tuple[str, str]]) -> tuple[list[Row], float]:
    """Short problems of each kind that run one of some functions, or the shortest one, and their seconds."""
    by_kind: dict[str, list[tuple[float, Row]]] = defaultdict(list)
    for row, seconds, ran in sorted(known, key=lambda entry: entry[1]):
        if ran & readers and (seconds < LONG or not by_kind):
            by_kind[f"{row['kind']} {'weight' in row['rod']}"].append((seconds, row))
    chosen: list[tuple[float, Row]] = []
    while any(by_kind.values()) and sum(seconds for seconds, _ in chosen) < EACH:
        chosen += [group.pop(0) for group in by_kind.values() if group]
    return [row for _, row in chosen], sum(seconds for seconds, _ in chosen)


def report(modules: Modules, known: Profiles, module: str, name: str, by: float) -> None:
    """Print what a constant that is so many times larger changes."""
    chosen, before = choose(known, modules.readers(module, name))
    for part, new in scalings(getattr(modules.of[module], name), by):
        after = compare(partial(modules.change, module, name, new), chosen, 6 * before + 8)
        count = Counter(kind for kind, _, _ in after)
        words = f"{len(chosen)} problems: {count['same']} same, {count['digits']} digits, {count['other']} other"
        lost = f", {len(chosen) - len(after)} too slow" if len(after) < len(chosen) else ""
        time = sum(seconds for _, seconds, _ in after) / max(before, 1e-9)
        first = [text for wanted in ("other", "digits") for kind, _, text in after if kind == wanted][:1]
        print(f"{module[7:].replace('.', '/')} {name}{part}: {words}{lost}; time {time:.1f}", *first, flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(". Run")[0])
    parser.add_argument("rooms", nargs="+")
    parser.add_argument("--by", type=float, default=10.0)
    options, modules, known = parser.parse_args(), Modules(), profiles()
    for module, name in modules.constants(options.rooms):
        report(modules, known, module, name, options.by)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    main()
