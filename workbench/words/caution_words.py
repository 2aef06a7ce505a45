"""Cautions in words: what the real rods of a file could not do, how much of it, and whether a real rod takes the shape.

The caution of each case is made by `solver.observe.cautions`. A sentence for pipes says what the model leaves out
(`docs/explanation/what-the-model-leaves-out.md`).
"""

import re
from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from solver.nodes.pipe_states import SLIGHT
from solver.observe.cautions import (
    ALL_ALONG,
    AT_ENDS,
    IN_PART,
    JUDGED,
    LINEAR,
    MEETS,
    NO_PUSH,
    PULL,
    PULLED,
    STRAINED,
    SURELY,
    TIGHT,
    TURNED,
    UNCHECKED,
    UNKNOWN,
)
from solver.observe.cautions import of_cases as _of_cases
from studies.grammar.formulas import size_of

from . import outcome_counts

if TYPE_CHECKING:
    from solver import Case, Rod
    from solver.orbits.shape_arrays import ShapeArrays


# those of `solver.observe.cautions` that others read here
__all__ = [
    "ALL_ALONG", "AT_ENDS", "IN_PART", "JUDGED", "MEETS", "PULLED", "SLIGHT", "TIGHT", "TURNED", "UNCHECKED", "UNKNOWN",
]  # fmt: skip

# key -> words for one rod, and for several
WORDS = {
    TIGHT: (
        "is bent tighter than its own radius (kappa a > 1)",
        "are bent tighter than their own radius (kappa a > 1)",
    ),
    MEETS: ("passes through itself", "pass through themselves"),
    TURNED: ("turns back against the direction of both its ends", "turn back against the direction of both their ends"),
    STRAINED: ("is strained", "are strained"),
    PULLED: ("would lift off the cylinder", "would lift off the cylinder"),
}
NUMBERS = dict(enumerate(("none", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")))
_POSSIBLE = (TURNED, STRAINED, AT_ENDS)  # what a real rod can do
NONE = "no real rod could keep"  # of all shapes of a file
BARRED = "a case whose shape no real rod could keep"  # in a legend: the cross of one that `is_barred`
_STRAIN = re.compile(r"\((.+?) %; (?:(metals) are )?linear to (.+?) %\)")
_EXTENT = re.compile(rf"\(((?:{NO_PUSH}|{PULL}) on .+? % of the length)(?: within (?:\S+ to )?(.+) an end)?\)")


def of_cases(
    sol: "ShapeArrays", observed: Mapping[str, Any] | None = None, units: Mapping[str, str] | None = None
) -> Any:
    """The caution of each case, (*cases) of str; units: "length" and "force" of the cases, where they are known."""
    if not units:
        return _of_cases(sol, observed)
    return _of_cases(sol, observed, units["length"], linear_strain(sol.case.rod, units))


def linear_strain(rod: "Rod", units: Mapping[str, str]) -> Any:
    """The strain up to which materials of a rod's modulus are surely linear, as its E; see `LINEAR`."""
    modulus = np.asarray(0.0 if rod.E is None else rod.E) / size_of("MPa", units)[0]
    return np.select([modulus >= least for least in LINEAR], list(LINEAR.values()), SURELY)


def parts(text: str) -> list[str]:
    """The parts of the caution of one case."""
    return [part for part in text.split(", ") if part]


def keys(text: str) -> list[str]:
    """The keys of `WORDS` and `UNCHECKED` in the caution of one case."""
    return [next((key for key in (PULLED, STRAINED) if part.startswith(key)), part) for part in parts(text)]


def is_barred(text: str) -> bool:
    """Whether no real rod takes the shape of a case with this caution: more than its ends would lift off."""
    return any(not part.startswith((UNKNOWN, *_POSSIBLE)) for part in parts(text))


def has_key(texts: Any, key: str) -> Any:
    """Whether a key is among those of each caution, (*cases) of bool."""
    texts = np.asarray(texts)
    each = texts.astype(str).ravel().tolist()
    holds = {text: key in keys(text) for text in set(each)}
    return np.array([holds[text] for text in each], dtype=bool).reshape(texts.shape)


def phrase(part: str, several: bool = False) -> str:
    """What a part says of one rod, or of several: "passes through itself", "pass through themselves"."""
    whose = "their" if several else "its"
    if part.startswith(UNKNOWN):
        return f"{'were' if several else 'was'} not checked for {part.removeprefix(UNKNOWN)}"
    if part.startswith(AT_ENDS):
        return f"would lift off next to {whose} ends alone: {_extent(part)}"
    if part.startswith(STRAINED) and (strain := _STRAIN.search(part)):
        beyond = f"{strain[2] or f'materials of {whose} modulus'} may be non-linear beyond {strain[3]} %"
        return f"{_words_of(part)[several]} by {strain[1]} %, but {beyond}"
    if part.startswith(PULLED):
        return WORDS[PULLED][several] + (f", {extent}" if (extent := _extent(part)) else "")
    return _words_of(part)[several]


def _words_of(part: str) -> tuple[str, str]:
    """What a part says of one rod and of several; a stored file may hold parts that are none of `WORDS`."""
    return WORDS.get(keys(part)[0], (f"is marked {part!r}", f"are marked {part!r}"))


def said(texts: Any) -> str:
    """The cautions of `of_cases` in sentences; empty where there is nothing to say."""
    return tell(Counter(np.atleast_1d(texts).astype(str).ravel().tolist()))


def tell(texts: Mapping[str, int]) -> str:
    """How often each caution stands, in sentences; empty where there is nothing to say."""
    cases, counts = sum(texts.values()), _parts(texts)
    known = {part: count for part, count in counts.items() if not part.startswith(UNKNOWN)}
    grave = {part: count for part, count in known.items() if not part.startswith(_POSSIBLE)}
    slight = {part: count for part, count in known.items() if part not in grave}
    unknown = {part.removeprefix(UNKNOWN): counts[part] for part in UNCHECKED if part in counts}
    return " ".join(words(cases, of) for words, of in ((_grave, grave), (_slight, slight), (_doubts, unknown)) if of)


def _parts(texts: Mapping[str, int]) -> dict[str, int]:
    """How often each part stands, those that differ in their numbers as one, with the ranges of the numbers."""
    counts: Counter[str] = Counter()
    for text, count in texts.items():
        for part in parts(text):
            counts[part] += count
    each = outcome_counts.group(counts)
    places = {key: place for place, key in enumerate([*WORDS, *UNCHECKED])}  # what is none of them stands last
    return dict(sorted(each.items(), key=lambda item: (places.get(keys(item[0])[0], len(places)), item[0])))


def _grave(cases: int, counts: Mapping[str, int]) -> str:
    if cases == 1:
        return f"The rod {_list([phrase(part) for part in counts])}: this shape is not physically realisable."
    facts = []
    for part, count in counts.items():
        extent = _extent(part)
        facts.append(f"{count} {_words_of(part)[min(count - 1, 1)]}" + (f" ({extent})" if extent else ""))
    return f"Of {cases} rods {_list(facts)}: such shapes are not physically realisable."


def _slight(cases: int, counts: Mapping[str, int]) -> str:
    """A sentence for each part: that on strain has a clause with "but"."""
    return " ".join(
        f"{'The rod' if cases == 1 else f'{count} of {cases} rods'} {phrase(part, count > 1)}."
        for part, count in counts.items()
    )


def _doubts(cases: int, counts: Mapping[str, int]) -> str:
    if cases == 1:
        return f"The rod was not checked for {_list(list(counts))}."
    return f"Not checked: {_list([f'{count} of {cases} for {what}' for what, count in counts.items()])}."


def _extent(part: str) -> str:
    """How much of the length is without push and where, as a part says it; "" where it does not."""
    match = _EXTENT.search(part)
    if match is None:
        return ""
    share, near = match.groups()
    return share + (f", all within {near} the ends" if near else "")


def _list(facts: list[str]) -> str:
    return facts[0] if len(facts) == 1 else f"{', '.join(facts[:-1])} and {facts[-1]}"


def possible_shapes(texts: Any, solved: Any, stable: Any = True) -> tuple[Any, Any]:
    """Which shapes a real rod could keep, and which it could only except next to its ends or if its material stays
    linear, (cases,) of bool each; texts, solved, stable: the caution of each case, and whether it is solved and stable.
    """
    texts = np.asarray(texts).astype(str).ravel()
    free = np.array([not is_barred(text) for text in texts.tolist()], dtype=bool)
    free &= np.ravel(solved).astype(bool) & np.ravel(np.broadcast_to(stable, np.shape(solved)))
    limited = np.array([AT_ENDS in text or STRAINED in text for text in texts.tolist()], dtype=bool)
    return free & ~limited, free & limited


def restable(texts: Any, solved: Any, stable: Any = True, which: str = "") -> str:
    """How many of the shapes of solved rods a real rod could keep, and how many more with a limit; empty where it could
    keep all without. The limits are those of `possible_shapes`.

    That shapes are unstable is said elsewhere: where no caution is against one there is nothing to say. which: the
    range of the axis where it could keep the first of these.

    Of a rod that was not checked for all that bars it nobody knows: then the number is the largest that it may be.
    """
    sound, limited = possible_shapes(texts, solved, stable)
    known, texts = np.ravel(solved).astype(bool), np.asarray(texts).astype(str).ravel()
    if not limited.any() and not any(map(is_barred, texts[known].tolist())):
        return ""
    if not (sound | limited).any():
        return f"{NONE} {'this shape' if texts.size == 1 else 'these shapes'}"
    whose = "its" if texts.size == 1 else "their"
    words = {AT_ENDS: f"except next to {whose} ends", STRAINED: f"if {whose} material stays linear"}
    holds = [[key in text for text in texts[limited].tolist()] for key in words]
    joint = " and " if all(map(all, holds)) else " or "
    limits = joint.join(said for said, of in zip(words.values(), holds, strict=True) if any(of))
    if texts.size == 1:
        return f"a real rod could keep this shape {limits}".rstrip()

    def count(mask: Any) -> str:
        unknown = any(UNKNOWN in text for text in texts[mask].tolist())
        return f"{'at most ' * unknown}{_number_in_words(int(mask.sum()))}"

    first, total = sound if sound.any() else limited, int(known.sum())
    shapes = "these" if first.sum() == total else f"{count(first)} of the {_number_in_words(total)}"
    more = f", and {count(limited)} more" * bool(sound.any() and limited.any())
    where = f" ({which})" * bool(which)
    return f"real rods could keep {shapes}{' solved' * (total < texts.size)} shapes{where}{more} {limits}".rstrip()


def _number_in_words(number: int) -> str:
    return NUMBERS.get(number, str(number))


NO_LOAD = "the curvature of the hole", "fluid flow", "temperature", "yielding"  # what no number of a case stands for


def model_leaves_out(given: Mapping[str, Any], *more: str) -> str:
    """What is left out where `given` holds weight, friction, sliding and contact, each if there is one, and more.

    given may also hold whether the rod is closed, and so has no ends. A picture has room for the first of them.
    """
    parts = [name for name in ("weight", "friction") if not np.any(given.get(name, 0))]
    if "friction" not in parts and given.get("sliding") != "rotating":
        parts.append("the moment of friction about the rod's own axis")
    held = not given.get("closed") and given.get("contact") != "unilateral"  # its ends, on the cylinder
    parts += ["joints", *["clearance at the ends"] * held, *more]
    return f"The model leaves out {', '.join(parts[:-1])}{',' * (len(parts) > 2)} and {parts[-1]}."


LEFT_OUT = model_leaves_out({})


def sentence_inside(case: "Case") -> str:
    """The sentence that belongs to a rod inside a cylinder; "" for one outside."""
    if case.cylinder.side != "inside":
        return ""
    wall = case.cylinder
    words = {"sliding": wall.sliding, "contact": wall.contact}
    return model_leaves_out({"weight": case.rod.weight, "friction": wall.friction, **words}, *NO_LOAD)
