"""Studies as hypothesis draws them: every kind of axis, base, reading, unit, output and law."""

from copy import deepcopy
from typing import Any

from hypothesis import strategies as st

from solver.observe.observables import OBSERVABLES
from solver.problem.units import FORCES, LENGTHS
from studies import READINGS, TABLE_1
from studies.grammar.axes import DEFAULT_UNITS, in_rad
from studies.language.study import OUTPUTS
from studies.laws.law_kinds import KINDS, MONOTONE
from studies.laws.line_verdicts import DIRECTIONS

# For each field a range in which the solver takes every value, whatever the others are.
RANGES = {
    "E": (1.0, 1e9), "nu": (-0.9, 0.5), "a": (0.01, 0.4), "L": (0.1, 1e3), "R": (0.5, 10.0),
    "inner_radius": (0.0, 0.009),
    "beta": (-3.0, 3.0), "dbeta": (0.1, 2.0), "alpha": (-3.0, 3.0), "gamma": (-3.0, 3.0), "dgamma": (-2.0, 2.0),
    "F1": (-50.0, 50.0), "F2": (-50.0, 50.0), "F3": (-50.0, 50.0), "M3": (-9.0, 9.0),
    "beta0": (-3.0, 3.0), "betaL": (-9.0, 9.0), "FZ": (-50.0, 50.0), "MZ": (-50.0, 50.0),
}  # fmt: skip
ANGLES = {"beta", "alpha", "gamma", "beta0", "betaL"}
ROD = ("E", "nu", "a", "L", "R")
# Printable text with what TOML must quote, and letters of more than one byte.
WORDS = st.text(st.sampled_from("abc XYZ019 \"'\\#[]{}=.,;:/%é漢🙂β-_"), min_size=1, max_size=20)
NAMES = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_-]{0,12}", fullmatch=True)


def number(field: str) -> st.SearchStrategy[Any]:
    """A value of a field; now and then a whole number, or an angle in text, as people write them."""
    low, high = RANGES[field]
    real = st.floats(low, high, allow_subnormal=False)
    whole = [st.integers(int(low) + 1, int(high))] if high - low > 2 else []
    texts = [st.sampled_from(["30deg", "-17.5 deg", "pi/6", "2pi/3", "0.5rad"])] if field in ANGLES else []
    return st.one_of(real, *whole, *texts)


@st.composite
def axes(draw: Any, field: str) -> dict[str, Any]:
    """A table of one axis of a field."""
    low, high = RANGES[field]
    told: dict[str, Any] = {}
    kind = draw(st.sampled_from(["values", "linear", "geometric"]))
    if kind == "values":
        told["values"] = draw(st.lists(number(field), min_size=1, max_size=5, unique_by=in_rad))
    else:
        least = max(low, high / 1e3) if kind == "geometric" else low  # geometric steps do not pass 0
        shares = draw(st.tuples(st.floats(0, 0.4), st.floats(0.5, 1)))
        first, last = (least + share * (high - least) for share in shares)
        told |= {"from": first, "to": last, "count": draw(st.integers(2, 6))}
        if draw(st.booleans()):
            told |= {"from": last, "to": first}
        if kind == "geometric" or draw(st.booleans()):
            told["spacing"] = kind
    if field in ANGLES and not any(isinstance(value, str) for value in told.get("values", [])):
        unit = draw(st.sampled_from([None, "rad", "deg"]))
        told |= {"unit": unit} if unit else {}
    return told


@st.composite
def distributions(draw: Any, field: str) -> dict[str, Any]:
    """A table of the distribution of a sampled field, which stays within the range of the field."""
    low, high = RANGES[field]
    kind = draw(st.sampled_from(["uniform", "log-uniform", "normal", "truncated"]))
    least = max(low, high / 1e3) if kind == "log-uniform" else low
    first, last = (least + share * (high - least) for share in draw(st.tuples(st.floats(0, 0.4), st.floats(0.5, 1))))
    told: dict[str, Any] = {} if kind == "uniform" and draw(st.booleans()) else {"distribution": kind}
    if kind in ("normal", "truncated"):
        told = {"distribution": "normal", "mean": (first + last) / 2, "std": (last - first) / 13}
    return told if kind == "normal" else {**told, "from": first, "to": last}


def _samples(draw: Any, said: dict[str, Any], fields: list[str]) -> None:
    """Now and then samples of some of these fields, or lists of them in pairs."""
    source = draw(st.sampled_from([None, None, "sample", "zip"]))
    names = draw(st.lists(st.sampled_from(fields), min_size=1, max_size=3, unique=True)) if source and fields else []
    if names and source == "sample":
        method = draw(st.sampled_from(["", "sobol", "latin-hypercube", "random", "saltelli"]))
        size = len(names) + 2 if method == "saltelli" else draw(st.integers(1, 9))
        said["sample"] = {"size": size, "seed": draw(st.integers(0, 2**40))}
        said["sample"] |= {"method": method} if method else {}
        said["sample"] |= {name: draw(distributions(name)) for name in names}
    if names and source == "zip":
        size = draw(st.integers(1, 4))
        said["zip"] = {name: draw(st.lists(number(name), min_size=size, max_size=size)) for name in names}


@st.composite
def studies(draw: Any) -> dict[str, Any]:
    """A study that can be run, as the tables of its TOML."""
    kind = draw(st.sampled_from(["reading", "start", "ends", "followed"]))
    said: dict[str, Any] = {"title": draw(WORDS.filter(str.strip))}
    if draw(st.booleans()):
        said["name"] = draw(NAMES)
    rod = draw(st.sampled_from([ROD, (*ROD, "inner_radius")]))
    if kind in ("reading", "followed"):
        said["reading"] = draw(st.sampled_from([*READINGS, "compression", "shear/solid"]))
        fields = list(TABLE_1)
        needed: list[str] = []
    elif kind == "start":
        twist = draw(st.sampled_from(["F1", "dgamma", "M3"]))
        needed = [*rod, "beta", "dbeta", twist]
        fields = [*needed, "F2", "F3", "alpha", "gamma"]
    else:
        needed = [*rod, "beta0", "betaL"]
        fields = [*needed, "FZ", "MZ", "M3", "alpha", "gamma"]
    varied = [] if kind == "followed" else draw(st.lists(st.sampled_from(fields), max_size=3, unique=True))
    base = [*needed, *draw(st.lists(st.sampled_from(fields), max_size=4, unique=True))]
    said["base"] = {name: draw(number(name)) for name in dict.fromkeys(base) if name not in varied}
    if draw(st.booleans()):
        said["base"]["side"] = draw(st.sampled_from(["outside", "inside"]))
    if kind not in ("reading", "followed") and draw(st.booleans()):
        said["base"]["stiffness"] = draw(st.sampled_from(["solid", "paper"] if rod == ROD else ["solid"]))
    said["axes"] = {name: draw(axes(name)) for name in varied}
    if kind == "followed":
        said["axes"] = {
            "betaL": {"follow": True, "to": draw(st.floats(1, 60)), "count": draw(st.integers(2, 9)), "unit": "deg"}
        }
    if kind == "ends" and draw(st.booleans()):
        said["equilibrium"] = draw(which())
    if kind in ("reading", "start") or (kind == "ends" and not varied and "dbeta0" not in said.get("equilibrium", {})):
        left = [name for name in fields if name not in varied and name not in said["base"]]
        _samples(draw, said, left)
    said["units"] = {"length": draw(st.sampled_from([*LENGTHS])), "force": draw(st.sampled_from([*FORCES]))}
    if "reading" in said and said["units"] != DEFAULT_UNITS:  # then no number comes from Table 1
        elsewhere = {*said["axes"], *said.get("sample", {}), *said.get("zip", {})}
        said["base"] |= {name: draw(number(name)) for name in TABLE_1 if name not in {*said["base"], *elsewhere}}
    _what_is_computed(draw, said)
    said["laws"] = draw(st.lists(laws(said["axes"]), max_size=2)) if said["axes"] else []
    empty = [name for name in ("base", "axes", "laws") if not said[name] and draw(st.booleans())]
    return {name: value for name, value in said.items() if name not in empty}


def which() -> Any:
    """A table [equilibrium], in each of its three ways."""
    named = {"dbeta0": st.floats(-3, 3), "energy": st.floats(-100, 100)}
    ways = ({"choose": st.sampled_from(["nearest", "lowest"])}, {"index": st.integers(0, 9)}, named)
    return st.one_of([st.fixed_dictionaries(way) for way in ways])


def _what_is_computed(draw: Any, said: dict[str, Any]) -> None:
    if draw(st.booleans()):
        said["observables"] = draw(st.lists(st.sampled_from(sorted(OBSERVABLES)), max_size=5, unique=True))
    if count := draw(st.integers(0, len(EXPRESSIONS))):
        said["expressions"] = dict(list(EXPRESSIONS.items())[:count])
    if draw(st.booleans()):
        said["outputs"] = draw(st.lists(st.sampled_from(OUTPUTS), max_size=5, unique=True))
    if draw(st.booleans()):
        said["stations"] = draw(st.integers(2, 2001))
    if draw(st.booleans()):
        said["tol"] = draw(st.floats(1e-13, 0.5))
    if draw(st.booleans()):
        said["method"] = "auto"


@st.composite
def laws(draw: Any, varied: dict[str, Any]) -> dict[str, Any]:
    """A law along one of the axes."""
    axis = draw(st.sampled_from(sorted(varied)))
    law: dict[str, Any] = {
        "claim": draw(WORDS.filter(str.strip)),
        "observable": draw(st.sampled_from(sorted(OBSERVABLES))),
        "axis": axis,
        "source": draw(WORDS.filter(str.strip)),
    }
    if (kind := draw(st.sampled_from([MONOTONE, *KINDS]))) != MONOTONE:
        return {**law, "kind": kind, **draw(rules(kind, law["observable"], axis))}
    law["direction"] = draw(st.sampled_from(sorted(DIRECTIONS)))
    if draw(st.booleans()):
        law["also"] = draw(st.lists(st.sampled_from(sorted(OBSERVABLES)), max_size=3, unique=True))
    if draw(st.booleans()):
        law["alternatives"] = draw(st.lists(st.sampled_from(sorted(OBSERVABLES)), max_size=2, unique=True))
        law["fixed"], law["fixed_note"] = draw(st.sampled_from(["in advance", "after"])), draw(WORDS.filter(str.strip))
    if law["direction"].startswith("not-") and draw(st.booleans()):
        law["says"] = {"not-falling": "rises", "not-rising": "falls"}[law["direction"]]
    others = sorted(set(varied) - {axis})
    if others and draw(st.booleans()):
        law["at"] = {
            name: draw(number(name)) for name in draw(st.lists(st.sampled_from(others), min_size=1, unique=True))
        }
    return law


def rules(kind: str, observable: str, axis: str) -> st.SearchStrategy[dict[str, Any]]:
    """The keys of a law with numbers, each a number or a formula."""
    size = st.floats(1e-9, 1e9)
    value = st.one_of(st.floats(-1e9, 1e9), st.sampled_from([f"2*{observable}", f"-{observable}/pi", "0"]))
    place = st.one_of(st.floats(-1e9, 1e9), st.sampled_from([f"{axis}*2", f"abs({axis})"]))
    ways: dict[str, list[dict[str, st.SearchStrategy[Any]]]] = {
        "equals": [{"formula": value, "relative": size}, {"formula": value, "absolute": size}],
        "bounded": [{"least": value}, {"most": value}, {"least": value, "most": value}],
        "scales": [{"exponent": st.floats(-9, 9), "within": size}],
        "boundary": [{"passes": value, "x": place, "within": size}],
    }
    return st.one_of([st.fixed_dictionaries(way) for way in ways[kind]])


EXPRESSIONS = {"first": "attached < 0.9", "second": "first + bends/pi", "third": "kappa_max*rho**0.5", "fourth": "-L"}


# what a study cannot be, or hardly

DEEP: list[Any] = []
for _ in range(200):
    DEEP = [DEEP]
WRONG = (
    *(float("nan"), float("inf"), -float("inf"), 0, -1, 10**30, 10**400, 1e308, -1e308, 5e-324, True, False),
    *("", " ", "\x1b[2J", "a\nb", "\u2028", "\u202e", "../../etc/passwd", "/", "x" * 10_000, "é" * 300),
    *("{0.__class__}", "__import__('os')", [], [[]], [1, "a"], [1.0, 1.0], [1e308, -1e308], [None], DEEP, {}),
    *({"a": {"b": {}}}, [{}], [{"claim": 3}], {"values": [float("nan")]}, {"from": 1, "to": 2, "count": 10**12}),
    {"from": 1e-320, "to": 1e308, "count": 3, "spacing": "geometric"},
    {"from": -1.7e308, "to": 1.7e308, "count": 3},
    {"from": 1.0, "to": 1.0000000000000002, "count": 9},
)
KEYS = ("", "a b", "../x", "\n", "\x1b]0;x\x07", "E", "from", "values", "__class__", "é", "x" * 5000, "laws", "title")


def wrong() -> st.SearchStrategy[Any]:
    """One of them, of its own: what is drawn is changed further."""
    return st.sampled_from(WRONG).map(deepcopy)


@st.composite
def mutated(draw: Any) -> dict[str, Any]:
    """A study of which one to three values, keys or tables are something else, or gone."""
    said = draw(studies())
    for _ in range(draw(st.integers(1, 3))):
        table = said
        inner = [value for value in table.values() if isinstance(value, dict) and value]
        while inner and draw(st.integers(0, 3)):
            table = draw(st.sampled_from(inner))
            inner = [value for value in table.values() if isinstance(value, dict) and value]
        key = draw(st.sampled_from(sorted(table))) if table else "title"
        what = draw(st.sampled_from(["value", "value", "gone", "key", "moved"]))
        if what == "value":
            table[key] = draw(wrong())
        elif what == "gone":
            table.pop(key, None)
        elif what == "key":
            table[draw(st.sampled_from(KEYS))] = draw(wrong())
        else:
            table[draw(st.sampled_from(KEYS))] = table.pop(key, 1)
    return said
