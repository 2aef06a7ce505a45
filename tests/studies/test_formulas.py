"""Formulas: what they may hold, their units, their values, and why a case has none."""

import ast
import operator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import InputError
from studies.grammar.formulas import FUNCTIONS, MOST_TEXT, evaluate, parse


def value(text: str, **values: object) -> np.ndarray:
    return evaluate(parse(text), values)[0]


HOSTILE = (
    "__import__('os').system('true')", "(1).__class__", "x.real", "x[0]", "[1, 2]", "{1}", "lambda: 1", "f'{x}'", "'a'",
    "x if x else 1", "[x for x in y]", "x := 1", "*x", "print(1)", "sqrt(*x)", "sqrt(x=1)", "max", "x % 2", "x // 2",
    "x(1)", "sqrt(1)(2)", "eval('1')", "x @ y", "x = 1", "1 2", "\x00", "9" * 400, "b'a'",
)  # fmt: skip


@pytest.mark.parametrize("text", HOSTILE)
def test_anything_but_arithmetic_is_refused_with_one_sentence(text: str) -> None:
    with pytest.raises(InputError) as error:
        parse(text)
    assert "\n" not in str(error.value).replace("\\n", "")


@given(st.text(st.sampled_from("abLFZ0123456789.+-*/()<>=!& ,_'[]{}:^%@~\"\\"), max_size=80))
def test_no_text_does_more_than_raise_the_one_error(text: str) -> None:
    try:
        formula = parse(text)
    except InputError:
        return
    allowed = (ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.Call, ast.Constant, ast.Name)
    assert isinstance(formula.tree, allowed)


@pytest.mark.parametrize(
    "text, said",
    [
        ("2 pi", "is not a formula: invalid syntax at character"),
        ("FZ**2*", "is not a formula: invalid syntax at the end, where a number, a name or a function is missing"),
        ("  FZ + * 2", r"invalid syntax at character 6, '\* 2'"),
        ("(FZ", "'\\(' was never closed"),
    ],
)
def test_a_formula_that_python_cannot_read_is_refused_with_the_place(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        parse(text)


def test_the_values_are_those_of_numpy_on_arrays() -> None:
    x, y = np.array([0.5, 2.0, -3.0]), np.array([[1.0], [4.0]])
    np.testing.assert_array_equal(value("x**2*y - x/y + abs(x)", x=x, y=y), x**2 * y - x / y + np.abs(x))
    np.testing.assert_array_equal(value("max(x, y, 1)", x=x, y=y), np.maximum(np.maximum(x, y), 1))
    np.testing.assert_array_equal(value("0 < x <= 2", x=x), [1, 1, 0])
    np.testing.assert_array_equal(value("x == 2 or not x > 0", x=x), [0, 1, 1])
    for name in set(FUNCTIONS) - {"min", "max"}:
        np.testing.assert_array_equal(value(f"{name}(y)", y=y), getattr(np, name)(y))


numbers = st.floats(-100, 100).map(lambda x: round(x, 3))
TREES = st.recursive(
    st.one_of(numbers.map(repr), st.sampled_from(["x", "y"])),
    lambda inner: st.tuples(inner, st.sampled_from(["+", "-", "*", "/"]), inner).map(lambda t: f"({' '.join(t)})"),
    max_leaves=12,
)


@given(TREES, numbers, numbers)
def test_arithmetic_is_that_of_python(text: str, x: float, y: float) -> None:
    """An independent reading of the same text: Python's own rules, with its floats."""
    if len(text) > MOST_TEXT:
        return
    (found,), (why,) = (np.atleast_1d(one) for one in evaluate(parse(text), {"x": x, "y": y}))

    def of(node: ast.expr) -> float:
        match node:
            case ast.Constant():
                return float(node.value)  # type: ignore[arg-type]
            case ast.Name():
                return {"x": x, "y": y}[node.id]
            case ast.UnaryOp():
                return -of(node.operand)
            case ast.BinOp():
                do = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}
                return do[type(node.op)](of(node.left), of(node.right))
        raise AssertionError

    try:
        expected = of(ast.parse(text, mode="eval").body)
    except ZeroDivisionError:
        assert np.isnan(found)  # also 1/(1/0), which numpy takes for 0
        assert why.startswith("it divides by ")
        return
    if np.isfinite(expected):
        assert (found, why) == (expected, "")
