"""Writes tests/golden.json: about 600 problems with the answers of the code as it is. Run from the root:

    python -m benchmarks.make_golden            # makes all rows anew: only after a change of an answer that is meant
    python -m benchmarks.make_golden compare    # names each stored row whose answer differs now
    python -m benchmarks.make_golden store folds  # stores those of one kind that differ, after a change that is meant

`marched` of a shape is the largest difference of its far end from a march of the equations, written anew.
Rows with M10 or M1L are of the kinds that were compared with marches by SciPy and an index on a mesh.
"""

import json
import sys
import warnings
from collections.abc import Iterator
from time import perf_counter
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from solver import Case, Solution
from tests.cases import START
from tests.extreme_cases import KINDS as EXTREME
from tests.extreme_cases import draw
from tests.golden import FILE, Row, answer, differences, rows, solution_of

A25 = 4 / (np.pi * 0.25**4)  # E of a rod with a = 0.25 and A = 1
UNIT: Row = {"rod": {"E": A25, "nu": 0.25, "a": 0.25}, "cylinder": {"R": 0.75}}
ANGLES = {"beta0", "betaL"}


def problem(L: float, side: str = "outside", **given: Any) -> Row:
    """A rod with A = 1 on rho = 1."""
    cylinder = {"R": 0.75 if side == "outside" else 1.25, "side": side}
    return {"rod": {**UNIT["rod"], "L": L}, "cylinder": cylinder, "ends": given}


def fields(part: Any) -> Row:
    values = {name: value for name, value in vars(part).items() if value is not None and not name.startswith("_")}
    return {name: value if isinstance(value, str) else float(value) for name, value in values.items()}


def plain(case: Case) -> Row:
    rod = {name: value for name, value in fields(case.rod).items() if name in case.rod.__dataclass_fields__}
    return {"rod": rod, "cylinder": fields(case.cylinder), "start": fields(case.given)}


def starts() -> Iterator[Row]:
    for name, named in START.items():
        yield {"kind": "shape", "name": f"start {name}", **plain(named.case), "observe": named.L < 200}
    rng = np.random.default_rng(1)
    for i in range(60):
        M3, F2, F3 = rng.normal(0, 1.5, 3)
        row = problem(rng.uniform(1, 20), rng.choice(["outside", "inside"]).item())
        start = {"beta": rng.uniform(-3, 3), "dbeta": rng.normal(), "F2": F2, "F3": F3, "M3": M3}
        del row["ends"]
        yield {"kind": "shape", "name": f"start {i}", **row, "start": start, "observe": True}
    for kind in EXTREME:
        case = draw(8, 5, kind)
        for i in range(8):
            parts = [{n: np.broadcast_to(v, 8)[i].item() if np.ndim(v) else v for n, v in vars(part).items()
                      if v is not None and n in part.__dataclass_fields__}
                     for part in (case.rod, case.cylinder, case.given)]  # fmt: skip
            yield {
                "kind": "shape",
                "name": f"extreme {kind} {i}",
                "rod": parts[0],
                "cylinder": parts[1],
                "start": parts[2],
            }


def random_ends(seed: int, n: int, longest: float = 12.0, size: float = 1.0) -> Iterator[Row]:
    rng = np.random.default_rng(seed)
    for _ in range(n):
        FZ, MZ, M3 = (rng.normal(0, size, 3) * (rng.random(3) < 0.8)).tolist()
        beta0, betaL = rng.uniform(-1.5, 1.5, 2).tolist()
        side = rng.choice(["outside", "inside"]).item()
        yield problem(rng.uniform(1, longest), side, beta0=beta0, betaL=betaL, FZ=FZ, MZ=MZ, M3=M3)


def dead() -> Iterator[Row]:
    for i, row in enumerate(random_ends(2, 90)):
        yield {
            "kind": "shape",
            "name": f"dead {i}",
            **row,
            "choose": ["nearest", "lowest", 1][i % 3],
            "observe": i % 2 == 0,
        }
    for i, row in enumerate(random_ends(3, 60, 20.0)):
        yield {"kind": "equilibria", "name": f"every equilibrium {i}", **row}


def saddles() -> Iterator[Row]:
    """Long rods, which rest next to a saddle; ends on a saddle and next to it; a corner: at rest next to a saddle."""
    section = {"FZ": -0.7506, "MZ": -0.3655, "M3": 0.7464}
    for L in (5.0, 20.0, 60.0, 300.0, 1e4):
        row = problem(L, beta0=np.pi / 6, betaL=np.pi / 6, **section)
        yield {"kind": "shape", "name": f"section 5, L = {L:g}", **row, "observe": True}
        if L < 100:
            yield {"kind": "equilibria", "name": f"every one of section 5, L = {L:g}", **row}
    for i, row in enumerate(random_ends(4, 12, 400.0)):
        yield {"kind": "shape", "name": f"long {i}", **row, "observe": True}
    for L in (5.0, 15.0, 60.0):
        for gap in (0.0, 1e-9, 1e-3):
            row = problem(L, beta0=gap, betaL=0.8, FZ=1.0)
            yield {"kind": "equilibria", "name": f"{gap:g} from a saddle, L = {L:g}", **row}
            yield {"kind": "shape", "name": f"corner: {gap:g} from a saddle, L = {L:g}", **row, "choose": "lowest"}
            back = problem(L, beta0=gap, betaL=gap, FZ=1.0, M3=0.1, MZ=0.1)
            yield {"kind": "equilibria", "name": f"back to {gap:g} from a saddle, L = {L:g}", **back}


def helices() -> Iterator[Row]:
    rng = np.random.default_rng(6)
    for i in range(12):
        b, M3 = rng.uniform(0.1, 1.3), rng.normal()
        FZ = rng.normal()
        s, c = np.sin(b), np.cos(b)
        MZ = (M3 * np.cos(2 * b) + (FZ + 2 * c * s * s) * s) / c
        ends = {"beta0": float(b), "betaL": float(b), "FZ": FZ, "MZ": float(MZ), "M3": M3}
        row = problem(rng.uniform(2, 8), **ends)
        yield {"kind": "shape", "name": f"helix {i}", **row, "observe": True}
        yield {"kind": "equilibria", "name": f"every one beside helix {i}", **row}
        if i < 6:
            yield {"kind": "follow", "name": f"from helix {i}", **row, "over": {"FZ": [FZ - 2, FZ, FZ + 1]}}
    for i, FZ in enumerate((-0.05, -0.2, -0.6)):
        b = float(np.arcsin(np.sqrt(-FZ / 2)))
        row = problem(10.0, "inside", beta0=b, betaL=b, FZ=FZ)
        yield {"kind": "shape", "name": f"pipe {i}", **row, "observe": True}


COMBINATIONS = (("height",), ("azimuth",), ("rotation",), ("height", "azimuth"), ("height", "rotation"),
                ("azimuth", "rotation"), ("height", "azimuth", "rotation"))  # fmt: skip
PARTNER = {"height": "FZ", "azimuth": "MZ", "rotation": "M3"}


def problems_with_held_ends(seed: int, n: int) -> Iterator[Row]:
    """An equilibrium under dead loads, and ends that hold some of its displacements a little changed."""
    rng = np.random.default_rng(seed)
    for i, row in enumerate(random_ends(seed, n, 8.0)):
        row["choose"] = ("nearest", "lowest", 0)[i % 3]
        solution = solution_of(row)
        names = COMBINATIONS[i % len(COMBINATIONS)]
        change = rng.uniform(-0.1, 0.1, 3)
        if not solution.solved:
            continue
        moved = {"height": solution.z, "azimuth": solution.alpha, "rotation": solution.gamma}
        given = {k: v for k, v in row["ends"].items() if k not in {PARTNER[name] for name in names}}
        held = {name: float(moved[name][-1] - moved[name][0]) * (1 + d) for name, d in zip(names, change, strict=False)}
        yield {**row, "held": {**given, **held}}


def rods_held() -> Iterator[Row]:
    for i, row in enumerate(problems_with_held_ends(7, 80)):
        yield {"kind": "shape", "name": f"held {i}", **row, "observe": i % 3 == 0}


def follows() -> Iterator[Row]:
    rng = np.random.default_rng(8)
    axes = ("FZ", "M3", "MZ", "L", "betaL", "R")
    for i, row in enumerate(random_ends(8, 36, 10.0)):
        axis = axes[i % len(axes)]
        own = {**row["rod"], **row["cylinder"], **row["ends"]}[axis]
        wide = 0.5 * own if axis in ("L", "R") else 2.0
        yield {"kind": "follow", "name": f"follow {axis} {i}", **row, "over": {axis: [own - wide, own, own + wide]}}
    for i, row in enumerate(problems_with_held_ends(9, 28)):
        axis = next(name for name in PARTNER if name in row["held"])
        own = row["held"][axis]
        values = [own - 0.3 * rng.random(), own, own + 0.3 * rng.random()]
        yield {"kind": "follow", "name": f"follow held {axis} {i}", **row, "over": {axis: values}}


def folds() -> Iterator[Row]:
    rows = list(random_ends(10, 8, 6.0))
    for i, row in enumerate(rows):
        L = row["rod"]["L"]
        yield {"kind": "folds", "name": f"folds {i}", **row, "lattice": 4, "over": {"FZ": [-6, 1], "L": [L, L + 2]}}
    row = problem(6.0, beta0=0.0, betaL=0.0)
    yield {"kind": "folds", "name": "buckling", **row, "lattice": 4, "over": {"FZ": [-3.0, -0.2], "L": [3.0, 6.0]}}


def loops() -> Iterator[Row]:
    for turns in (1, 2, 3):
        for waves in (1, 2, 3, 4):
            for longer in (1.05, 1.6):
                rod = {"E": A25, "nu": 0.25, "a": 0.25, "L": 2 * np.pi * turns * longer}
                yield {"kind": "loops", "name": f"loop {turns} {waves} {longer}", "rod": rod, "cylinder": {"R": 0.75},
                       "options": {"turns_around": turns, "folds": waves}}  # fmt: skip


SEEN = ["height", "turns_around", "amplitude", "kappa_max", "kappa_mean", "push_min", "push_max", "push_mean",
        "attached", "energy", "bending_energy", "F3_size_max", "lift_off_at", "push_max_at"]  # fmt: skip


def sensitivities() -> Iterator[Row]:
    for name in list(START)[::4]:
        row = plain(START[name].case)
        fields = ["E", "nu", "a", "L", "R", "beta0", "dbeta0", "F3", "dgamma" if "dgamma" in row["start"] else "F1"]
        yield {"kind": "sensitivity", "name": f"derivatives {name}", **row, "fields": fields, "observables": SEEN}
    for i, row in enumerate(random_ends(11, 24)):
        fields = ["E", "nu", "a", "L", "R", *row["ends"]]
        yield {"kind": "sensitivity", "name": f"derivatives dead {i}", **row, "fields": fields, "observables": SEEN}
    for i, row in enumerate(problems_with_held_ends(12, 24)):
        fields = ["E", "nu", "a", "L", "R", *row["held"]]
        yield {"kind": "sensitivity", "name": f"derivatives held {i}", **row, "fields": fields, "observables": SEEN}


def fits() -> Iterator[Row]:
    start = {"rod": {"E": 1.07e4, "nu": 0.25, "a": 0.25, "L": 20.0}, "cylinder": {"R": 0.75},
             "start": {"beta": np.pi / 6, "dbeta": 0.5, "F1": 5.0, "F3": 10.0}}  # fmt: skip
    yield {"kind": "fit", "name": "fit F1", **start, "vary": {"F1": [1, 9]}, "targets": {"height": 9.0}}
    more = {"vary": {"F1": [1, 9], "E": [8e3, 2e4]}, "targets": {"height": 9.0, "kappa_max": 2.5}}
    yield {"kind": "fit", "name": "fit F1 and E", **start, **more}
    for i, row in enumerate(random_ends(13, 4, 4.0, 0.5)):
        own = row["ends"]["FZ"]
        target = {"height": 0.98 * float(solution_of(row).z[-1])}
        yield {"kind": "fit", "name": f"fit FZ {i}", **row, "vary": {"FZ": [own - 1, own + 1]}, "targets": target}


def march_error(solution: Solution) -> float | None:
    """The largest difference of beta, alpha and z/rho at the far end from a march from beta'(0).

    None where the march itself loses six digits.
    """
    A, rho = solution.case.rod.bending_stiffness, solution.case.rho
    FZ, MZ, M3 = (float(load) for load in solution.loads)
    lam, mu, phi = MZ * rho / A, M3 * rho / A, FZ * rho**2 / A

    def flow(t: float, y: Any) -> list[float]:
        s, c = np.sin(y[0]), np.cos(y[0])
        return [y[1], -(lam * c - mu * np.cos(2 * y[0]) - (phi + 2 * c * s * s) * s), s, c]

    def far_end(change: float) -> Any:
        begin = [float(solution.beta[0]), float(solution.dbeta[0]) * rho + change, 0.0, 0.0]
        span = float(solution.case.rod.L) / rho
        return solve_ivp(flow, (0, span), begin, "DOP853", rtol=1e-13, atol=1e-13).y[[0, 2, 3], -1]

    y, end = far_end(0.0), [float(solution.beta[-1]), float(solution.alpha[-1]), float(solution.z[-1]) / rho]
    end[1] -= float(solution.alpha[0])
    if np.abs(far_end(1e-9) - y).max() > 1e-9 * 1e6:
        return None
    return float(f"{np.abs(y - end).max():.1e}")


def _within_reach(row: Row) -> bool:
    return "beta" in row["answer"] and not row["name"].startswith("extreme") and row["rod"]["L"] < 500


def short(value: Any, digits: int = 13) -> Any:
    """Numbers of answers with 13 digits; the others change with the order of operations."""
    if isinstance(value, dict):
        return {name: short(one, 2 if name.endswith("_error") else 13) for name, one in value.items()}
    if isinstance(value, list):
        return [short(one, digits) for one in value]
    if isinstance(value, float):
        return float(f"{value:.{digits}g}")
    return value.item() if isinstance(value, np.generic) else value


def rods_with_hinges() -> Iterator[Row]:
    """Rods with a hinge at one end or at both, without an end moment."""
    rng = np.random.default_rng(15)
    for i in range(24):
        loads = dict(zip(("FZ", "MZ", "M3"), rng.uniform(-2.5, 2.5, 3).tolist(), strict=True))
        free = ({"M10": 0.0, "M1L": 0.0}, {"M10": 0.0, "betaL": rng.uniform(-2, 2)}, {"beta0": 0.4, "M1L": 0.0})[i % 3]
        row = problem(float(rng.uniform(1.5, 6)), **free, **loads)
        kind = ("shape", "follow", "sensitivity")[i // 3 % 3]
        if kind == "follow":
            row["over"] = {"M3": [loads["M3"] - 0.5, loads["M3"], loads["M3"] + 0.5]}
        elif kind == "sensitivity":
            row |= {"fields": ["E", "L", "FZ"], "observables": ["height", "energy"]}
        yield {"kind": kind, "name": f"hinged {kind} {i}", **row}


def make() -> None:
    made = []
    kinds = starts, dead, saddles, helices, rods_held, follows, folds, loops, sensitivities, fits, rods_with_hinges
    for kind in kinds:
        for row in kind():
            begun = perf_counter()
            row["answer"] = short(answer(row))
            if perf_counter() - begun > 2:
                print(f"{row['name']}: {perf_counter() - begun:.1f} s", flush=True)
            if row["kind"] == "shape" and row["answer"].get("condition", np.inf) < 1e6 and _within_reach(row):
                row["marched"] = march_error(solution_of(row))
            made.append(json.loads(json.dumps(row)))
        print(kind.__name__, len(made), flush=True)
    write(made)


def write(made: list[Row]) -> None:
    lines = (json.dumps(row, separators=(",", ":")) for row in made)
    FILE.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")


def store(kind: str) -> None:
    write(
        [
            {**row, "answer": short(answer(row))} if row["kind"] == kind and any(differences(row)) else row
            for row in rows()
        ]
    )


def compare() -> None:
    for row in rows():
        for line in differences(row):
            print(f"{row['name']}: {line}", flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    if sys.argv[1:2] == ["store"]:
        store(sys.argv[2])
    else:
        compare() if "compare" in sys.argv else make()
