"""The error that the solver raises for an invalid value, the wording of its messages, the checks that every call makes
(of the tolerance, of types, and of whole numbers), and the outcome of a case whose computation raises."""

import operator
import traceback
from collections.abc import Callable, Collection, Iterable
from difflib import SequenceMatcher, get_close_matches
from pathlib import Path
from typing import Any, TypeVar

T = TypeVar("T")

# word -> the symbols of the fields, or the names, that it may mean, in the order in which a message names them
SYMBOLS = {
    "modulus": ("E",), "young": ("E",), "poisson": ("nu",), "inner": ("inner_radius",), "radius": ("R", "a"),
    "diameter": ("R", "a"), "length": ("L",), "bending_stiffness": ("EI",), "torsional_stiffness": ("GJ",),
    "tension": ("FZ", "F3"), "axial": ("FZ",), "force": ("FZ", "F3"), "torque": ("M3", "MZ"),
    "moment": ("M3", "MZ"), "twist": ("M3", "dgamma"), "theta": ("beta", "beta0", "betaL"),
    "pitch": ("lay",), "lay-angle": ("lay",), "angle": ("beta", "beta0", "betaL"),
    "rising": ("rises",), "increasing": ("rises",), "falling": ("falls",), "decreasing": ("falls",),
}  # fmt: skip


class InputError(ValueError):
    """An invalid value; the message names the value and, if there are any, the choices.

    Examples
    --------
    >>> from solver import Cylinder, InputError
    >>> try:
    ...     Cylinder(R=-0.75)
    ... except InputError as error:
    ...     print(error)
    Cylinder.R must be positive and finite, got -0.75
    """


def show(value: object) -> str:
    """The value as a sentence shows it; a long one is cut."""
    try:
        text = repr(value)
    except ValueError:  # Python does not write integers of more than 4300 digits
        return "an integer of more than 4300 digits"
    return text if len(text) <= 200 else f"{text[:197]}..."


def known_name(name: object, names: Iterable[object]) -> bool:
    """Whether a value of any type is one of the names."""
    return isinstance(name, str) and name in names


def names_of(value: Any) -> tuple[Any, ...]:
    """One name or several as a tuple of what may be names."""
    try:
        return (value,) if isinstance(value, str) else tuple(value)
    except TypeError:  # of what holds none
        return (value,)


def choices(names: Iterable[object]) -> str:
    """The names as a list in a sentence: ``a, b, c``."""
    return ", ".join(str(name) for name in names)


def no_such(kind: str, name: object, names: Iterable[object]) -> InputError:
    """The error ``no method 'rk5', did you mean 'rk4'; choose from orbit, rk4``."""
    known = list(names)
    return InputError(f"no {kind} {show(name)}{near(name, known)}; choose from {choices(known)}")


def check_known(kind: str, name: object, names: Collection[object]) -> None:
    """Raise the error of `no_such` where a name is none of the known ones."""
    if name not in names:
        raise no_such(kind, name, names)


def near(name: object, known: Iterable[object]) -> str:
    """``, did you mean 'sobol'`` where known names are close to this one or are its symbols; else nothing."""
    text, names = str(name)[:60], list(dict.fromkeys(map(str, known)))
    likely = [other for other in names if other.lower() == text.lower()]
    likely = likely or (_symbols(text, names) if text.lower() in SYMBOLS else []) or _closest(text, names, 0.9)
    likely = likely or _symbols(text, names) or _begin(text, names)
    if text.lower() not in SYMBOLS:  # what this word means is known, and not that of similar letters
        likely = likely or _closest(text, names) or _one_letter_off(text, names)
    return f", did you mean {' or '.join(map(repr, likely))}" if likely else ""


def _closest(text: str, names: list[str], least: float = 0.6) -> list[str]:
    """The names that are closest to the text: weight and height for ``eight``."""
    closest = get_close_matches(text, names, 3, least)
    likeness = [SequenceMatcher(None, name, text).ratio() for name in closest]
    return [name for name, alike in zip(closest, likeness, strict=True) if alike == max(likeness)]


def _symbols(text: str, names: list[str]) -> list[str]:
    """The names that are symbols of a word in the text: those of ``youngs_modulus`` are E."""
    word = next((word for word in SYMBOLS if word in text.lower()), "")
    symbols = [name for name in SYMBOLS.get(word, ()) if name in names]
    return symbols and [*dict.fromkeys((*symbols, *_begin(text, names)))]


def _begin(text: str, names: list[str]) -> list[str]:
    """The names, one to three, of which the text is the beginning: beta0 and betaL for ``beta``."""
    longer = [name for name in names if len(text) > 3 and name.startswith(text)]
    return longer if len(longer) < 4 else []


def _one_letter_off(text: str, names: list[str]) -> list[str]:
    """The first short name that differs in one letter: FZ for FX; not F1 for F2."""

    def alike(other: str) -> bool:
        apart = [a + b for a, b in zip(other, text, strict=True) if a != b]
        return len(apart) == 1 and apart[0].isalpha()

    return [name for name in names if 1 < len(name) == len(text) < 4 and alike(name)][:1]


# half the digits of a float: far below what a picture or a measurement shows. x10: a digit less of every answer
DEFAULT_TOLERANCE = 1e-8
LARGEST_SEED = 2**63 - 1  # of random numbers


def check_tolerance(tol: Any) -> float:
    """The tolerance as a float. Raises `InputError` unless it is between 0 and 1."""
    try:
        value = float(tol)
    except (TypeError, ValueError, OverflowError):
        value = -1.0
    if not 0 < value < 1:
        raise InputError(f"tol must be a number between 0 and 1, got {show(tol)}")
    return value


def check_type(function: str, value: object, kind: type[T], hint: str = "") -> T:
    """The value if it is of a class. Raises `InputError` with the name of the function that takes it."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise InputError(f"{function} takes {article} {kind.__name__}, got {type(value).__name__}{hint}")
    return value


def yes_or_no(name: str, value: Any) -> bool:
    """The value as a bool. Raises `InputError` unless it is true or false, 1 or 0."""
    try:
        number = operator.index(value)
    except TypeError:  # of NumPy's bool too
        number = int(value) if type(value).__name__ in ("bool", "bool_") else -1
    if number not in (0, 1):
        raise InputError(f"{name} must be True or False, got {show(value)}")
    return number == 1


def whole_number(name: str, value: Any, least: int, most: int) -> int:
    """The value as an int. Raises `InputError` unless it is a whole number from `least` to `most`."""
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if isinstance(value, bool) or not least <= number <= most:
        raise InputError(f"{name} must be a whole number from {least} to {most}, got {show(value)}")
    return number


FAULT = "this is a fault of the solver, not of the case: please report it"


def attempt(compute: Callable[[], T]) -> T | str:
    """What a computation returns; where it raises, the outcome "failed: ..." that says so.

    Raises what says nothing of a case: `InputError`; that a machine lacks memory, a package or a file, and may have it
    the next time; a warning that its user wants as an error. An interruption is no `Exception`.
    """
    try:
        return compute()
    except (InputError, MemoryError, ImportError, OSError, Warning):
        raise
    except Exception as error:
        calls = traceback.extract_tb(error.__traceback__)
        solver = str(Path(__file__).parents[1])
        frames = [call for call in calls if call.filename.startswith(solver) and not call.name.startswith("<")]
        words = " ".join(str(error).split())[:200]
        said = f"{type(error).__name__}{words and f' ({words})'} in {Path(frames[-1].filename).stem}.{frames[-1].name}"
        return f"failed: the solver raised {said}; {FAULT}"
