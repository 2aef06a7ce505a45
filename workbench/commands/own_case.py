"""What a command's options ask for: a rod of one's own, named in full, or Table 1 with some fields changed."""

from dataclasses import MISSING, Field, fields
from typing import Any

from solver import Case, Cylinder, Ends, InputError, Rod, Start
from solver.problem.case import TWISTS, from_fields
from solver.problem.errors import choices

OF_START = {f.name for f in fields(Start)} - {f.name for f in fields(Ends)}
OF_ENDS = {f.name for f in fields(Ends)} - {f.name for f in fields(Start)}


def own_case(options: dict[str, Any], kind: type | None = None) -> tuple[Case, dict[str, Any]]:
    """A case of options alone, and what was assumed for the fields left out, name -> value.

    kind: Start or Ends where the command decides it, else the options do. Raises `InputError`, which names every field
    that is missing: nothing that has a size is ever assumed but a load of 0.
    """
    advice = "; --table1 takes the rod of Table 1" if kind is None else ""
    kind = _kind(options) if kind is None else kind
    parts = (Rod, Cylinder, kind)
    _check_complete(kind, [f for part in parts for f in fields(part)], options, advice)
    chosen = [{f.name: options[f.name] for f in fields(part) if f.name in options} for part in parts]
    rod, cylinder, given_ = (from_fields(part, values) for part, values in zip(parts, chosen, strict=True))
    assumed = {
        f.name: f.default for part in parts for f in fields(part) if f.name not in options and f.default is not None
    }
    return Case(rod, cylinder, given_), assumed


def with_fields(case: Case, changes: dict[str, Any]) -> Case:
    """The same case with some fields changed; F1, dgamma and M3 of a start drop each other. Raises `InputError`."""
    parts: list[Any] = []
    left = dict(changes)
    for part in (case.rod, case.cylinder, case.given):
        kind = type(part)
        own = {field.name: getattr(part, field.name) for field in fields(kind)}
        if kind not in (Rod, Cylinder):  # whatever is left must be one of its fields
            _check_given(kind, left)
            if kind is Start and any(name in changes for name in TWISTS):
                own |= dict.fromkeys(TWISTS)
            parts.append(from_fields(kind, {**{k: v for k, v in own.items() if v is not None}, **left}))
            break
        parts.append(from_fields(kind, {**own, **{name: left.pop(name) for name in own if name in left}}))
    return Case(*parts)


def _kind(options: dict[str, Any]) -> type:
    """Start or Ends, by the names that only one of them has."""
    starts, ends = ([name for name in options if name in names] for names in (OF_START, OF_ENDS))
    if starts and ends:
        raise InputError(
            f"a rod is given by its start or by its ends: {starts[0]} is of a start, {ends[0]} is of the ends"
        )
    return Ends if ends else Start


def _check_complete(kind: type, wanted: list[Field[Any]], options: dict[str, Any], advice: str) -> None:
    missing = [f.name for f in wanted if f.default is MISSING and f.name not in options]
    if kind is Start and not any(name in options for name in TWISTS):
        missing.append(f"one of {choices(TWISTS)}")
    if missing:
        given = "its start" if kind is Start else "its ends"
        unsaid = kind is Start and not OF_START & set(options)
        other = "; given by its ends it needs beta0 and betaL instead" if unsaid else ""
        told = f"{choices(missing[:-1])} and {missing[-1]}" if len(missing) > 1 else missing[0]
        raise InputError(f"a rod given by {given} also needs {told}{other}{advice}")


def _check_given(kind: type, left: dict[str, Any]) -> None:
    known = [field.name for field in fields(kind)]
    given = "start" if kind is Start else "ends"
    for name in left:
        if name not in known:
            raise InputError(f"this rod is given by its {given}, which have no {name}; choose from {choices(known)}")
