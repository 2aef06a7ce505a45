"""Global influence: Sobol' indices of observables over the ranges of a sampled study, by SALib.

The first-order index of a field is the share of the variance of an observable that remains explained when this field
alone is known; the total index is the share that remains when all other fields are known. In a block of Saltelli's
design the samples belong together: A, A with one coordinate of B each, and B; where it was drawn for pairs also B with
one coordinate of A each. Where one of them has no value, the block is left out.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.problem.errors import InputError, choices
from studies.grammar.axes import SAMPLE
from studies.language.samples import block_of, blocks_of

from ..stored import chosen_cases
from ..stored.stored_study import StoredStudy

CONFIDENCE, SEED = 0.95, 1  # of the intervals; of the bootstrap, whose 0 would mean another each time
RESAMPLES, MOST_DRAWN = 200, 4_000_000  # of the bootstrap; blocks drawn in all, above which it has fewer resamples
FEWEST, FEW = 16, 128  # blocks: fewer are refused, fewer have a caution
MOST_LOST = 0.5  # share of the blocks that may be left out
NO_SALIB = "Sobol' indices need SALib: install the extra global, pip install 'rod-workbench[global]'"

Values = NDArray[np.float64]
_SAME = 1e-12  # relative: equal values, as a table may have printed them


@dataclass(frozen=True)
class Design:
    """The design of samples of some fields. blocks: their number. second: whether pairs of fields are told apart."""

    fields: int
    blocks: int
    second: bool

    @property
    def block(self) -> int:
        """The number of samples of a block."""
        return block_of(self.fields, self.second)


def design_of(samples: Values) -> Design | None:
    """The design of samples (n, fields), which are in the order of `[sample]`; None where they form no blocks."""
    n, d = samples.shape
    for second in (False, True):
        size = block_of(d, second)
        blocks = samples.reshape(-1, size, d) if n % size == 0 else np.full((1, size, d), np.nan)
        if np.allclose(blocks, blocks_of(blocks[:, 0], blocks[:, -1], second), rtol=_SAME, atol=0):
            return Design(d, n // size, second)
    return None


def sobol(
    ds: xr.Dataset,
    observables: Sequence[str] | None = None,
    at: Mapping[str, chosen_cases.Value] | None = None,
    confidence: float = CONFIDENCE,
    seed: int = SEED,
) -> xr.Dataset:
    """The Sobol' indices of a stored study whose samples are of Saltelli's design.

    Parameters
    ----------
    ds : Dataset
        The study. An axis that it has beside its samples is held.
    observables : sequence of str, optional
        Stored observables. Default: all.
    at : mapping, optional
        Where axes are held, as of `chosen_cases.case`.
    confidence, seed
        Of the intervals by bootstrap; the seed is positive.

    Returns
    -------
    Dataset
        As `analyse` returns it; the observables in rows, in their attributes what they are called.

    Raises
    ------
    InputError
        For samples that are of another design, for too few of them, for too many that are not solved, for an unknown
        observable; and without SALib.
    """
    stored = StoredStudy(ds)
    fields = stored.sampled
    if SAMPLE not in stored.axes or not fields:
        raise InputError(f"Sobol' indices need a study of samples, got {_axes(stored)}; {_how(max(len(fields), 3))}")
    samples = np.stack([stored[name].values.astype(float) for name in fields], axis=1)
    design = design_of(samples)
    if design is None:
        sampling = str(stored.attrs.get("sampling", "")) or f"{samples.shape[0]} samples"
        raise InputError(f"the samples are of no Saltelli design: {sampling}; {_how(len(fields))}")
    if SAMPLE in (at or {}):
        raise InputError("sample is not held: the indices are those of all samples")
    held = {axis: i for axis, i in stored.place(at).items() if axis != SAMPLE}
    section = stored.select(held)
    names = section.names_of(observables) if observables else section.all_observables
    if not names:
        raise InputError("the file stores no observable: give the study observables, and run it again")
    solved = section["solved"].values.astype(bool)
    values = np.stack([np.where(solved, section[name].values.astype(float), np.nan) for name in names], axis=1)
    result = analyse(design, values, fields, names, confidence, seed)
    labels = {name: {"symbol": name, "units": "1", **stored[name].attrs} for name in map(str, [*fields, *names])}
    attributes = {key: stored.attrs.get(key, "") for key in ("title", "reading", "sampling")}
    attributes |= {f"at {axis}": float(stored[axis][i]) for axis, i in held.items()}
    words = {"unsolved": int((~solved).sum()), "samples": samples.shape[0]}
    texts = {key: ("observable", [str(labels[name][key]) for name in names]) for key in ("symbol", "units")}
    return (
        result.assign(texts)
        .assign_coords(field_symbol=("field", [str(labels[n]["symbol"]) for n in fields]))
        .assign_attrs({**attributes, **words})
    )


def _axes(stored: StoredStudy) -> str:
    axes = stored.axes
    return f"the axes {choices(axes)}" if axes else "one case"


def _how(fields: int) -> str:
    block = fields + 2
    return f"""sample it with [sample] method = "saltelli" and a size of {256 * block} (256 blocks of {block})"""


def analyse(
    design: Design,
    values: Values,
    fields: Sequence[str],
    observables: Sequence[str],
    confidence: float = CONFIDENCE,
    seed: int = SEED,
) -> xr.Dataset:
    """The Sobol' indices of values on a design.

    Parameters
    ----------
    design : Design
        That of the samples (`design_of`), with d fields.
    values : array, (samples, m)
        The observables on the samples, in their order; NaN where there is none.
    fields, observables : sequence of str
        The names of the d fields and the m observables.
    confidence : float
        Of the intervals, above 0 and below 1.
    seed : int
        Of the bootstrap, positive.

    Returns
    -------
    Dataset
        Dimensions observable (m) and field (d). first, total: (m, d), the indices. first_conf, total_conf: (m, d), half
        the widths of their intervals: the normal quantile times the standard deviation of the bootstrap. second,
        second_conf: (m, d, other) where the design tells pairs apart, above the diagonal. blocks: (m,), those that were
        used. lost: (m,), the share that was left out. remark: (m,), what that means, or why there are no indices; "".

    Raises
    ------
    InputError
        For too few blocks, for too many that are left out, for an invalid confidence or seed; and without SALib.
    """
    if not 0 < confidence < 1:
        raise InputError(f"the confidence must be above 0 and below 1, got {confidence:g}")
    if seed < 1:
        raise InputError(f"the seed of the bootstrap must be a positive whole number, got {seed}")
    if design.blocks < FEWEST:
        raise InputError(
            f"Sobol' indices need at least {FEWEST} blocks of {design.block} samples, better 256, got {design.blocks}"
        )
    m, d = values.shape[1], design.fields
    columns: dict[str, Any] = {name: np.full((m, d), np.nan) for name in ("first", "first_conf", "total", "total_conf")}
    pairs = {name: np.full((m, d, d), np.nan) for name in (("second", "second_conf") if design.second else ())}
    blocks, lost, remarks = np.zeros(m, dtype=int), np.zeros(m), [""] * m
    for i, name in enumerate(observables):
        kept, lost[i] = _whole_blocks(design, values[:, i], name)
        blocks[i], remarks[i] = len(kept), _remark(design, len(kept))
        if np.ptp(kept) == 0:
            remarks[i] = "no index: the observable has one value on all samples"
            continue
        for key, index in _indices(design, kept, confidence, seed).items():
            (pairs if key in pairs else columns)[key][i] = index
    rows: dict[str, Any] = {key: (("observable", "field"), value) for key, value in columns.items()}
    rows |= {key: (("observable", "field", "other"), value) for key, value in pairs.items()}
    rows |= {"blocks": ("observable", blocks), "lost": ("observable", lost), "remark": ("observable", remarks)}
    coords = {"observable": list(observables), "field": list(fields)} | ({"other": list(fields)} if pairs else {})
    return xr.Dataset(rows, coords, {"confidence": confidence, "seed": seed, "resamples": _resamples(design.blocks)})


def _whole_blocks(design: Design, values: Values, name: str) -> tuple[Values, float]:
    """The values of the blocks that have all of them, (blocks, size), and the share of the others."""
    rows = values.reshape(design.blocks, design.block)
    whole = np.isfinite(rows).all(axis=1)
    lost = 1 - whole.mean()
    if lost > MOST_LOST or whole.sum() < FEWEST:
        missing = int((~np.isfinite(values)).sum())
        raise InputError(
            f"{missing} of {values.size} samples have no {name}, so {int((~whole).sum())} of {design.blocks} blocks "
            f"cannot be used, and {int(whole.sum())} are left; at most {100 * MOST_LOST:g} % may be left out, and at "
            f"least {FEWEST} are needed: narrow the ranges to where the cases are solved, or take another observable"
        )
    return rows[whole], float(lost)


def _remark(design: Design, kept: int) -> str:
    said = []
    if kept < design.blocks:
        share = 100 * (1 - kept / design.blocks)
        said.append(
            f"{design.blocks - kept} of {design.blocks} blocks ({share:.2g} %) are left out, as one of their "
            "samples has no value: the indices are those of the other blocks, and not of the whole ranges"
        )
    if kept < FEW:
        said.append(f"the intervals are rough: {kept} blocks are used, {FEW} or more are better")
    return "; ".join(said)


def _resamples(blocks: int) -> int:
    return max(50, min(RESAMPLES, MOST_DRAWN // blocks))


def _indices(design: Design, blocks: Values, confidence: float, seed: int) -> dict[str, Values]:
    try:
        from SALib.analyze.sobol import analyze
    except ImportError:
        raise InputError(NO_SALIB) from None
    problem = {"num_vars": design.fields, "names": [str(i) for i in range(design.fields)]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # where a resample has one value: its index is 0
        answer = analyze(problem, blocks.reshape(-1), design.second, _resamples(len(blocks)), confidence, seed=seed)
    names = {"first": "S1", "first_conf": "S1_conf", "total": "ST", "total_conf": "ST_conf"}
    names |= {"second": "S2", "second_conf": "S2_conf"} if design.second else {}
    return {name: np.asarray(answer[key], dtype=float) for name, key in names.items()}


def sentences(found: xr.Dataset) -> list[str]:
    """What the indices say beside their numbers, one sentence each."""
    share = f"{100 * found.attrs['confidence']:g} %"
    said = [
        f"first: share of the variance that the field alone explains; total: with all its interactions. ±: half the "
        f"interval of {share} confidence ({found.attrs['resamples']} resamples, seed {found.attrs['seed']})."
    ]
    names = [str(name) for name in found["observable"].values]
    remarks = dict(zip(names, map(str, found["remark"].values), strict=True))
    for text in dict.fromkeys(remarks.values()):
        if text:
            said.append(f"{', '.join(name for name in names if remarks[name] == text)}: {text}.")
    return said
