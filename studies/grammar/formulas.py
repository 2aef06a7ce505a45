"""Formulas: arithmetic on named numbers with units, in the grammar of Python, read as a tree and never run as code.

A formula has numbers, names, ``+ - * / **``, comparisons, ``and or not``, and the functions of `FUNCTIONS`. `parse`
reads it, `evaluate` computes its values, `dimension` its unit; in units angles and counts are plain numbers. `size_of`
says how large the unit is that an expression may state.
"""

import ast
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, reduce
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.problem.errors import InputError, choices, near
from solver.problem.quantities import current, in_current_names, unit_text
from solver.problem.units import UnknownUnit, size_in, unit_size

MOST_TEXT = 500  # characters of a formula
MOST_DEPTH = 60  # levels of a formula
MOST_POWER = 12  # of a quantity with a unit, and the largest denominator

OPERATORS: dict[type, tuple[str, Callable[..., Any]]] = {
    ast.Add: ("+", np.add),
    ast.Sub: ("-", np.subtract),
    ast.Mult: ("*", np.multiply),
    ast.Div: ("/", np.divide),
    ast.Pow: ("**", np.power),
    ast.UAdd: ("+", np.positive),
    ast.USub: ("-", np.negative),
    ast.Lt: ("<", np.less),
    ast.LtE: ("<=", np.less_equal),
    ast.Gt: (">", np.greater),
    ast.GtE: (">=", np.greater_equal),
    ast.Eq: ("==", np.equal),
    ast.NotEq: ("!=", np.not_equal),
    ast.And: ("and", np.logical_and),
    ast.Or: ("or", np.logical_or),
    ast.Not: ("not", np.logical_not),
}
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "exp": np.exp,
    "log": np.log,
    "abs": np.abs,
    "min": np.minimum,
    "max": np.maximum,
}
CONSTANTS = {"pi": float(np.pi)}
IN = " in "  # between the formula of an expression and the unit of its value
OF_SEVERAL = ("min", "max")  # functions of two or more values

Dimension = tuple[Fraction, Fraction]  # exponents of length and force
PLAIN: Dimension = (Fraction(0), Fraction(0))


FORMULAS = ("formula", "least", "most", "passes", "x")  # keys of a law whose value may be a formula


def tables_in_current_names(value: Any, key: str = "") -> Any:
    """Tables of a study, or of what is stored of it, with the names of today in place of former ones.

    A name is a key, or a whole text, but for claims and their sources; formulas have several. Each gives a notice.
    """
    if isinstance(value, dict):
        return {
            current(name): tables_in_current_names(item, name if key != "expressions" else key)
            for name, item in value.items()
        }
    if isinstance(value, list):
        return [tables_in_current_names(item, key) for item in value]
    if isinstance(value, str) and key in ("expressions", *FORMULAS):
        return in_current_names(value)
    return value if key in ("claim", "laws", "source") else current(value)


@dataclass(frozen=True)
class Formula:
    """A formula that was read.

    text: as given. tree: its nodes, all of the allowed kinds. names: those of quantities, in order, without functions
    and constants. whole: whether its values are 0 and 1, for false and true. unit: the unit behind `IN` in which an
    expression states its value; "" where it has none.
    """

    text: str
    tree: ast.expr
    names: tuple[str, ...]
    whole: bool
    unit: str = ""


@cache
def parse(text: str) -> Formula:
    """The formula of a text, whose names are checked by `dimension`. Raises `InputError`."""
    if len(text) > MOST_TEXT:
        raise InputError(f"the formula has {len(text)} characters; the limit is {MOST_TEXT}")
    expression, _, unit = text.partition(IN)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(expression.strip(), mode="eval").body
    except SyntaxError as error:
        raise InputError(f"{text!r} is not a formula: {_why(error, expression.strip())}") from None
    except (ValueError, RecursionError, MemoryError):
        raise InputError(f"{text[:60]!r} is not a formula") from None
    names = dict.fromkeys(_names(tree, text))
    return Formula(text, tree, tuple(name for name in names if name not in CONSTANTS), _is_truth(tree), unit.strip())


def _why(error: SyntaxError, text: str) -> str:
    """What is wrong with the text by Python, and the place."""
    said = error.msg.partition(".")[0]
    if not error.offset or error.offset > len(text):
        return f"{said} at the end, where a number, a name or a function is missing"
    return f"{said} at character {error.offset}, {text[error.offset - 1 :][:20]!r}"


def _is_truth(node: ast.expr) -> bool:
    """Whether the values of a node are true or false."""
    return isinstance(node, ast.Compare | ast.BoolOp) or (
        isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
    )


def _operands(node: ast.AST) -> list[Any]:
    """The nodes on which a node works, in order."""
    below = node.args if isinstance(node, ast.Call) else ast.iter_child_nodes(node)
    return [part for part in below if isinstance(part, ast.expr)]


def _names(node: ast.AST, text: str, depth: int = 1) -> Iterator[str]:
    """The names of a tree, each node checked against what a formula may hold. Raises `InputError`."""
    if depth > MOST_DEPTH:
        raise InputError(f"the formula {text[:60]!r} has more than {MOST_DEPTH} levels")
    _check(node, text)
    if isinstance(node, ast.Name):
        yield node.id
    for part in _operands(node):
        yield from _names(part, text, depth + 1)


def _check(node: ast.AST, text: str) -> None:
    """Raise `InputError` unless a formula may hold the node."""
    match node:
        case ast.Name(id=name):
            if name in FUNCTIONS:
                raise InputError(f"{name} in {text!r} is a function: write {name}(...)")
            return
        case ast.Call(func=ast.Name(id=name), keywords=[]):
            _check_arguments(name, len(node.args), text)
            return
        case ast.Constant() if _is_finite(node.value):
            return
        case ast.BinOp(op=ast.BitXor()):
            raise InputError(f"{text!r}: a power is written with **, not ^")
        case ast.BinOp() | ast.UnaryOp() | ast.BoolOp() if type(node.op) in OPERATORS:
            return
        case ast.Compare() if all(type(op) in OPERATORS for op in node.ops):
            return
    parts = "numbers, names, + - * / **, < <= > >= == !=, and or not, pi"
    shown = ast.unparse(node)[:60]
    raise InputError(f"a formula cannot hold {shown!r}; it has {parts} and the functions {choices(FUNCTIONS)}")


def _check_arguments(name: str, count: int, text: str) -> None:
    if name not in FUNCTIONS:
        raise InputError(
            f"no function {name[:60]!r} in a formula{near(name[:60], FUNCTIONS)}; choose from {choices(FUNCTIONS)}"
        )
    several = name in OF_SEVERAL
    if count < 1 + several or (count > 1 and not several):
        need = "two values or more" if several else "one value"
        raise InputError(f"{name} in {text!r} needs {need}, got {count}")


def _is_finite(value: object) -> bool:
    try:
        return type(value) in (int, float) and isfinite(value)  # type: ignore[arg-type]
    except OverflowError:
        return False


def evaluate(formula: Formula, values: Mapping[str, Any]) -> tuple[NDArray[np.float64], NDArray[np.str_]]:
    """The values of a formula, and for each NaN the reason, "" elsewhere.

    values: name -> array of numbers; all broadcast to one shape, which both results have.
    """
    faults: list[tuple[Any, str]] = []
    with np.errstate(all="ignore"):
        numbers = np.array(_value(formula.tree, values, faults), dtype=float)
    shape = np.broadcast_shapes(numbers.shape, *(np.shape(values[name]) for name in formula.names))
    result = np.array(np.broadcast_to(numbers, shape))
    why = np.full(shape, "", dtype=object)
    bad = ~np.isfinite(result)
    for mask, reason in faults:  # the first fault of a case is the cause, whatever became of it
        mine = np.broadcast_to(mask, shape)
        why[mine & (why == "")] = reason
        bad |= mine
    why[bad & (why == "")] = "its value is too large for a number"
    result[bad] = np.nan
    return result, why.astype(str)


def _value(node: ast.expr, values: Mapping[str, Any], faults: list[tuple[Any, str]]) -> Any:
    """The values of a node. To faults is added where and why a value is not finite."""
    parts = [_value(part, values, faults) for part in _operands(node)]
    faults += [(mask, reason) for mask, reason in _faults(node, parts, values) if np.any(mask)]
    match node:
        case ast.Constant():
            return np.float64(node.value)  # type: ignore[arg-type]
        case ast.Name(id=name):
            return np.float64(CONSTANTS[name]) if name in CONSTANTS else np.asarray(values[name], dtype=float)
        case ast.Call(func=ast.Name(id=name)):
            return _apply(FUNCTIONS[name], parts)
        case ast.Compare():
            pairs = zip(node.ops, parts, parts[1:], strict=False)
            return _truth(reduce(np.logical_and, [OPERATORS[type(op)][1](a, b) for op, a, b in pairs]), parts)
        case ast.BinOp() | ast.UnaryOp() | ast.BoolOp():
            value = _apply(OPERATORS[type(node.op)][1], parts)
            return _truth(value, parts) if _is_truth(node) else value
    raise AssertionError(node)


def _apply(rule: Callable[..., Any], parts: list[Any]) -> Any:
    """A function of one value, or of two, applied to several in turn."""
    return reduce(rule, parts) if parts[1:] else rule(parts[0])


def _faults(node: ast.expr, parts: list[Any], values: Mapping[str, Any]) -> Iterator[tuple[Any, str]]:
    """Where a node has no value, and why."""
    match node:
        case ast.Name(id=name) if name not in CONSTANTS:
            yield ~np.isfinite(np.asarray(values[name], dtype=float)), f"{name} has no value"
        case ast.Call(func=ast.Name(id="sqrt")):
            yield parts[0] < 0, f"sqrt of a negative number in {ast.unparse(node)!r}"
        case ast.Call(func=ast.Name(id="log")):
            yield parts[0] <= 0, f"log of a number that is not positive in {ast.unparse(node)!r}"
        case ast.BinOp(op=ast.Div(), right=right):
            yield parts[1] == 0, f"it divides by {ast.unparse(right)!r}, which is 0"
        case ast.BinOp(op=ast.Pow(), left=left):
            a, b = parts
            yield (a == 0) & (b < 0), f"it divides by {ast.unparse(left)!r}, which is 0"
            yield (a < 0) & (b != np.round(b)), f"power of a negative number in {ast.unparse(node)!r}"


def _truth(truth: Any, parts: list[Any]) -> Any:
    """1 and 0 for true and false, NaN where a part is NaN."""
    unknown = reduce(np.logical_or, map(np.isnan, parts))
    return np.where(unknown, np.nan, np.where(truth, 1.0, 0.0))


def dimension(formula: Formula, known: Mapping[str, Dimension], units: Mapping[str, str]) -> Dimension:
    """The dimension of a formula over names with these dimensions. Raises `InputError`.

    known: name -> dimension. units: of length and force, for messages.
    """
    for name in formula.names:
        if name not in known:
            meant = near(name, known)
            raise InputError(f"no name {name[:60]!r} in a formula{meant}; choose from {choices([*known, *CONSTANTS])}")
    return _Units(known, units).of(formula.tree) or PLAIN


def is_zero(formula: Formula) -> bool:
    """Whether a formula is the number 0, which fits every unit."""
    return not formula.names and _Units({}, {}).of(formula.tree) is None


def unit_words(dimension: Dimension, units: Mapping[str, str]) -> str:
    """``a plain number``, ``in N/cm^2``."""
    return "a plain number" if dimension == PLAIN else f"in {unit_text(dimension, units)}"


@dataclass(frozen=True)
class _Units:
    """The dimensions of the nodes of a formula; None for the number 0, which fits every unit."""

    known: Mapping[str, Dimension]
    units: Mapping[str, str]

    def of(self, node: ast.expr) -> Dimension | None:
        parts = [(part, self.of(part)) for part in _operands(node)]
        dims = [dim or PLAIN for _, dim in parts]
        match node:
            case ast.Constant():
                return None if node.value == 0 else PLAIN
            case ast.Name(id=name):
                return PLAIN if name in CONSTANTS else self.known[name]
            case ast.Call(func=ast.Name(id="sqrt")):
                return dims[0][0] / 2, dims[0][1] / 2
            case ast.Call(func=ast.Name(id=name)):
                return self._equal(parts, name) if name in ("abs", *OF_SEVERAL) else self._plain(parts, name)
            case ast.Compare():
                self._equal(parts, OPERATORS[type(node.ops[0])][0])
                return PLAIN
            case ast.BoolOp() | ast.UnaryOp(op=ast.Not()):
                return self._plain(parts, OPERATORS[type(node.op)][0])
            case ast.BinOp(op=ast.Mult()):
                return dims[0][0] + dims[1][0], dims[0][1] + dims[1][1]
            case ast.BinOp(op=ast.Div()):
                return dims[0][0] - dims[1][0], dims[0][1] - dims[1][1]
            case ast.BinOp(op=ast.Pow()):
                self._plain(parts[1:], "the exponent of **")
                return PLAIN if dims[0] == PLAIN else self._power(node, dims[0])
            case ast.BinOp() | ast.UnaryOp():
                return self._equal(parts, OPERATORS[type(node.op)][0])
        raise AssertionError(node)

    def _power(self, node: ast.BinOp, base: Dimension) -> Dimension:
        if any(isinstance(part, ast.Name) and part.id not in CONSTANTS for part in ast.walk(node.right)):
            raise InputError(
                f"{self._tell(node.left, base)}: its exponent must be a number, got {ast.unparse(node.right)!r}"
            )
        with np.errstate(all="ignore"):
            exponent = float(_value(node.right, {}, []))
        share = Fraction(exponent).limit_denominator(MOST_POWER) if isfinite(exponent) else Fraction(0)
        if abs(exponent) > MOST_POWER or abs(float(share) - exponent) > 1e-12:
            limit = f"must be a fraction of at most {MOST_POWER}"
            raise InputError(f"{self._tell(node.left, base)}: its exponent {limit}, got {exponent:g}")
        return base[0] * share, base[1] * share

    def _plain(self, parts: list[tuple[ast.expr, Dimension | None]], user: str) -> Dimension:
        """No dimension. Raises `InputError` where a part has one."""
        for node, dim in parts:
            if dim not in (None, PLAIN):
                raise InputError(f"{self._tell(node, dim)}, but {user} needs a plain number")
        return PLAIN

    def _equal(self, parts: list[tuple[ast.expr, Dimension | None]], user: str) -> Dimension | None:
        """The one dimension of the parts. Raises `InputError` where they differ."""
        sized = [(node, dim) for node, dim in parts if dim is not None]
        for node, dim in sized:
            if dim != sized[0][1]:
                raise InputError(f"{self._tell(*sized[0])} and {self._tell(node, dim)}, but {user} needs equal units")
        return sized[0][1] if sized else None

    def _tell(self, node: ast.expr, dim: Dimension | None) -> str:
        return f"{ast.unparse(node)[:60]!r} is {unit_words(dim or PLAIN, self.units)}"


NAMED = ("Pa", "kPa", "MPa", "GPa", "ksi", "deg")  # at the end of a name they claim to be its unit


def size_of(text: str, units: Mapping[str, str]) -> tuple[float, Dimension]:
    """The size of a unit such as ``MPa``, ``deg/(30 m)`` or ``kN m`` in the units of a study, and its dimension.

    Raises `InputError` for a text that is no product of known units.
    """
    try:
        size, (length, force, _) = unit_size(text.strip())
    except UnknownUnit as error:
        raise InputError(f"unit {text!r}: {error}") from None
    return size / size_in((length, force), units), (Fraction(length), Fraction(force))
