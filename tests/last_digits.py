"""A plugin of pytest that changes last digits, as another processor or another library would.

`python -m pytest -p tests.last_digits` lets the elementary functions of NumPy that the project and its tests call, and
all functions of `numpy.linalg` and `scipy.linalg`, return numbers one unit in the last place higher, lower, or as they
are. Which of the three hangs on the digits of the number, but for its sign and its power of two, and on LAST_DIGITS in
the environment, a whole number (default: 0): so a function still returns the same for the same argument, and scales
exactly where it did. Numbers that any library returns exactly stay: whole ones, and multiples of pi/4.
"""

import contextlib
import functools
import os
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
import scipy.linalg

for name in ("dask.array", "heyoka"):  # they refuse functions of NumPy that are none
    with contextlib.suppress(ImportError):
        import_module(name)

SEED = np.uint64(int(os.environ.get("LAST_DIGITS", "0")))
OURS = ("solver", "studies", "workbench", "tests")
TRIGONOMETRY = ("sin", "cos", "tan", "sinh", "cosh", "tanh")
FUNCTIONS = (
    *TRIGONOMETRY, *(f"arc{name}" for name in TRIGONOMETRY), "arctan2", "hypot", "exp", "exp2", "expm1", "log", "log2",
    "log10", "log1p", "logaddexp", "power", "float_power", "cbrt",
)  # fmt: skip
LAPACK = ("dgtsv", "dgtsvx", "dptsv", "dpbsv", "dgbsv")
_DIGITS = np.uint64(2**52 - 1)
_MIXER = np.uint64(0x9E3779B97F4A7C15)  # the golden ratio: its products scatter
_EXACT = 1e15  # beyond it all floats are whole


def changed(result: Any) -> Any:
    """A result with other last digits; what is not of floats stays."""
    if isinstance(result, tuple):
        parts = [changed(part) for part in result]
        return type(result)(*parts) if hasattr(result, "_fields") or type(result) is not tuple else tuple(parts)
    if (type(result) is np.ndarray and result.dtype == np.float64) or type(result) in (float, np.float64):
        return _changed(np.asarray(result)) if np.ndim(result) else type(result)(_changed(np.asarray(result)))
    if type(result) is np.ndarray and result.dtype == np.complex128:
        return _changed(result.real) + 1j * _changed(result.imag)
    return result


def _changed(values: np.ndarray) -> np.ndarray:
    size = np.abs(values)
    bits = np.ascontiguousarray(size).view(np.uint64).reshape(size.shape)
    with np.errstate(over="ignore", invalid="ignore"):
        mixed = ((bits & _DIGITS) ^ SEED) * _MIXER
        step = (((mixed ^ (mixed >> np.uint64(31))) * _MIXER) >> np.uint64(33)) % np.uint64(3)
        quarters = size * (4 / np.pi)
        stays = ~(size < _EXACT) | (size == np.rint(size)) | (np.abs(quarters - np.rint(quarters)) < 1e-15 * quarters)
        towards = np.where(step == 0, 0.0, np.where(step == 1, np.inf, size))
        return np.asarray(np.copysign(np.where(stays, size, np.nextafter(size, towards)), values))


class Inexact:
    """A function of NumPy whose results change where the project calls it; else it is that function itself."""

    def __init__(self, function: Any) -> None:
        self.function = function
        functools.update_wrapper(self, function)

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        result = self.function(*arguments, **options)
        caller = sys._getframe(1).f_globals.get("__name__", "")
        if not caller.startswith(OURS):
            return result
        out = options.get("out")
        if out is None:
            return changed(result)
        (out[0] if isinstance(out, tuple) else out)[...] = changed(result)
        return result

    def __getattr__(self, name: str) -> Any:
        return getattr(self.function, name)


def _inexact(function: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(function)
    def call(*arguments: Any, **options: Any) -> Any:
        return changed(function(*arguments, **options))

    return call


for name in FUNCTIONS:
    setattr(np, name, Inexact(getattr(np, name)))
for module in (np.linalg, scipy.linalg):
    for name in module.__all__:
        if callable(function := getattr(module, name)) and not isinstance(function, type):
            setattr(module, name, _inexact(function))
for name in LAPACK:
    setattr(scipy.linalg.lapack, name, _inexact(getattr(scipy.linalg.lapack, name)))


def pytest_report_header() -> str:
    return f"last digits of NumPy, numpy.linalg and scipy.linalg changed, seed {SEED}"
