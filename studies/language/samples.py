"""Samples of several fields at once: how they are drawn, and from which distributions.

A sampler of `scipy.stats.qmc` (or NumPy's generator) gives points in the unit cube, one coordinate a field in the order
of the study; the inverse of a field's distribution function turns its coordinate into values.
"""

from collections.abc import Callable
from functools import cached_property, partial
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from solver.problem.errors import choices, near

from ..grammar.axes import MAX_COUNT, SAMPLE, STRICT, Dimension, Misplaced, Values, is_angle, one_of

Cube = NDArray[np.float64]  # points in the unit cube, (size, fields)

REACH = 6.0  # standard deviations at which a normal distribution is always cut: 2 in 10^9 values lie beyond


def _sobol(size: int, fields: int, seed: int) -> Cube:
    """The first points of the scrambled Sobol' sequence; drawn as a power of two, as its balance needs."""
    from scipy.stats import qmc

    points: Cube = qmc.Sobol(fields, rng=seed).random_base2((size - 1).bit_length())
    return points[:size]


def _latin(size: int, fields: int, seed: int) -> Cube:
    """A Latin hypercube: of each field one value in each of `size` equal shares of the probability."""
    from scipy.stats import qmc

    return qmc.LatinHypercube(fields, rng=seed).random(size)


def _random(size: int, fields: int, seed: int) -> Cube:
    """Independent points."""
    return np.random.default_rng(seed).random((size, fields))


def _saltelli(size: int, fields: int, seed: int, second: bool = False) -> Cube:
    """Blocks of points A, A with one coordinate of B each, B; with `second` also B with one coordinate of A each.

    A and B are the halves of the points of a scrambled Sobol' sequence in twice as many dimensions (Saltelli 2002).
    """
    cube = _sobol(size // block_of(fields, second), 2 * fields, seed)
    return blocks_of(cube[:, :fields], cube[:, fields:], second).reshape(size, fields)


def blocks_of(a: Cube, b: Cube, second: bool = False) -> Cube:
    """The blocks of Saltelli's design, (blocks, samples, fields), of the points A and B, (blocks, fields)."""
    a, b, mixed = a[:, None], b[:, None], np.eye(a.shape[1], dtype=bool)
    return np.concatenate([a, np.where(mixed, b, a), *([np.where(mixed, a, b)] if second else []), b], axis=1)


def block_of(fields: int, second: bool = False) -> int:
    """The number of samples of a block of Saltelli's design."""
    return (2 * fields if second else fields) + 2


METHODS: dict[str, tuple[Callable[[int, int, int], Cube], str]] = {  # name -> sampler, and its name in sentences
    "sobol": (_sobol, "scrambled Sobol' sequence"),
    "latin-hypercube": (_latin, "Latin hypercube"),
    "random": (_random, "independent random numbers"),
    "saltelli": (_saltelli, "Saltelli's design"),
    "saltelli-second-order": (partial(_saltelli, second=True), "Saltelli's design for pairs of fields"),
}
BLOCKS = {"saltelli": False, "saltelli-second-order": True}  # the methods that draw blocks: whether for pairs too
# name -> the keys that it needs, and those that it may have
DISTRIBUTIONS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "uniform": (("from", "to"), ()),
    "log-uniform": (("from", "to"), ()),
    "normal": (("mean", "std"), ("from", "to")),
}


class Distribution(BaseModel):
    """The distribution of one sampled field.

    uniform: from, to. log-uniform: from, to, of one sign; the logarithm is uniform. normal: mean, std, and from and to
    where it is truncated. unit: "deg" for an angle in degrees; default: the unit of the study.
    """

    model_config = STRICT

    distribution: Annotated[str, one_of("distribution", DISTRIBUTIONS)] = "uniform"
    from_: float | None = Field(None, alias="from")
    to: float | None = None
    mean: float | None = None
    std: float | None = None
    unit: str | None = None

    @model_validator(mode="after")
    def _complete(self) -> "Distribution":
        needed, allowed = DISTRIBUTIONS[self.distribution]
        given = self._numbers
        if missing := [name for name in needed if name not in given]:
            raise ValueError(f"a {self.distribution} distribution needs {' and '.join(needed)}: no {missing[0]} given")
        for name in given:
            if name not in (*needed, *allowed):
                raise Misplaced(f"a {self.distribution} distribution has no {name}; it needs {choices(needed)}", name)
        if {"from", "to"} <= set(given):
            low, high = given["from"], given["to"]
            if not low < high:
                raise Misplaced(f"from must be less than to, got from = {low:g} and to = {high:g}", "to")
            if not np.isfinite(high - low):
                raise Misplaced(f"the range from {low:g} to {high:g} is too wide for floating-point numbers", "to")
            if self.distribution == "log-uniform" and not low * high > 0:
                why = f"a log-uniform distribution needs from and to of one sign and not 0, got {low:g} and {high:g}"
                raise Misplaced(why, "from")
        if self.std is not None and not self.std > 0:
            raise Misplaced(f"std must be positive, got {self.std:g}", "std")
        if self.distribution == "normal":
            self._check_truncation()
        return self

    @property
    def _numbers(self) -> dict[str, float]:
        """The numbers that are given, by their keys."""
        return self.model_dump(by_alias=True, include={"from_", "to", "mean", "std"}, exclude_none=True)

    def _check_truncation(self) -> None:
        low, high = self._in_deviations()
        if not (np.isfinite(low) and np.isfinite(high) and low < REACH and high > -REACH):
            where = " and ".join(f"{name} = {v:g}" for name, v in self._numbers.items() if name in ("from", "to"))
            far = f"more than {REACH:g} standard deviations from its mean"
            raise Misplaced(f"{where or 'the normal distribution'} leaves no value of it: all lie {far}", "mean")

    def _in_deviations(self) -> tuple[float, float]:
        """The ends of a normal distribution in standard deviations from its mean."""
        given = self._numbers
        ends = {name: (given[name] - given["mean"]) / given["std"] for name in ("from", "to") if name in given}
        return max(ends.get("from", -REACH), -REACH), min(ends.get("to", REACH), REACH)

    @property
    def support(self) -> tuple[float, float]:
        """The least and the greatest value that can be drawn, angles in rad."""
        given = self._numbers
        if self.distribution == "normal":
            low, high = (given["mean"] + given["std"] * z for z in self._in_deviations())
        else:
            low, high = given["from"], given["to"]
        return self._in_rad(low), self._in_rad(high)

    def values(self, share: Values) -> Values:
        """The values below which these shares of the distribution lie, (n,), angles in rad."""
        low, high = self.support
        if self.distribution == "uniform":
            value = low + (high - low) * share
        elif self.distribution == "log-uniform":
            a, b = np.log(abs(low)), np.log(abs(high))
            value = np.sign(low) * np.exp(a + (b - a) * share)
        else:
            from scipy.stats import truncnorm

            mean, std = (self._in_rad(self._numbers[name]) for name in ("mean", "std"))
            value = mean + std * truncnorm.ppf(share, *self._in_deviations())
        return np.clip(value, low, high)

    def _in_rad(self, value: float) -> float:
        return float(np.deg2rad(value)) if self.unit == "deg" else value

    def words(self, field: str) -> str:
        """``E uniform from 5000 to 40000``; angles in degrees."""
        angle = is_angle(field)
        said = {
            name: f"{np.rad2deg(self._in_rad(v)):g} deg" if angle else f"{v:g}" for name, v in self._numbers.items()
        }
        ends = " ".join(f"{name} {said[name]}" for name in ("from", "to") if name in said)
        if self.distribution != "normal":
            return f"{field} {self.distribution} {ends}"
        cut = f", truncated {ends}" if ends else ""
        return f"{field} normal with mean {said['mean']} and std {said['std']}{cut}"

    def reach(self, field: str) -> str:
        """The distribution, and how to restrict what it reaches."""
        normal = self.distribution == "normal"
        return self.words(field) + (f" is cut at {REACH:g} std from the mean, or at from and to" if normal else "")


class Sample(BaseModel):
    """The samples of a study: a method, a size, a seed, and a distribution for each field, by its name.

    method: the design by which they are drawn. seed: of the random numbers; one seed always gives the same samples.
    """

    model_config = ConfigDict(extra="allow", strict=True, frozen=True, allow_inf_nan=False)
    __pydantic_extra__: dict[str, Distribution] = Field(init=False)

    method: Annotated[str, one_of("method of sampling", METHODS)] = "sobol"
    size: int
    seed: int = Field(0, ge=0, lt=2**63)

    @model_validator(mode="before")
    @classmethod
    def _keys(cls, given: Any) -> Any:
        """Refuse an unknown key that is no table: a misspelled key, not a field."""
        for key, value in given.items() if isinstance(given, dict) else ():
            if key not in cls.model_fields and not isinstance(value, dict):
                known = [*cls.model_fields]
                why = f"no key {str(key)[:60]!r} in sample{near(key, known)}; choose from {choices(known)}, or give"
                raise Misplaced(f"{why} a field its own table [sample.FIELD]", key)
        return given

    @model_validator(mode="after")
    def _fits(self) -> "Sample":
        if self.size < 1:
            raise Misplaced(f"the sample is empty: size must be at least 1, got {self.size}", "size")
        if self.size > MAX_COUNT:
            raise Misplaced(f"{self.size} samples, more than the limit of {MAX_COUNT}", "size")
        if not self.fields:
            raise ValueError("sample has no field: give at least one a table, such as [sample.E]")
        if self.size % self.block:
            whole = self.size // self.block * self.block or self.block
            raise Misplaced(
                f"{METHODS[self.method][1]} of {len(self.fields)} fields has blocks of {self.block} samples: size must "
                f"be a multiple of {self.block}, such as {whole} or {256 * self.block} (256 blocks), got {self.size}",
                "size",
            )
        return self

    @property
    def block(self) -> int:
        """The number of samples that belong together: those of a block of Saltelli's design; else 1."""
        return block_of(len(self.fields), BLOCKS[self.method]) if self.method in BLOCKS else 1

    @property
    def fields(self) -> dict[str, Distribution]:
        """The sampled fields and their distributions, in order."""
        return self.__pydantic_extra__

    @cached_property
    def points(self) -> Dimension:
        """The samples, angles in rad, drawn when they are first needed."""
        cube = METHODS[self.method][0](self.size, len(self.fields), self.seed)
        every = enumerate(self.fields.items())
        return Dimension(SAMPLE, {name: distribution.values(cube[:, i]) for i, (name, distribution) in every})

    @property
    def sentence(self) -> str:
        """How the samples are drawn, in one sentence."""
        each = "; ".join(distribution.words(name) for name, distribution in self.fields.items())
        return f"{METHODS[self.method][1]}, seed {self.seed}: {each}"

    @property
    def caution(self) -> str:
        """A sentence where the number of points of a Sobol' sequence is no power of two; else nothing."""
        points = self.size // self.block
        if self.method not in ("sobol", *BLOCKS) or points & (points - 1) == 0:
            return ""
        below, what = 1 << (points.bit_length() - 1), "blocks" if self.method in BLOCKS else "samples"
        return (
            f"{points} {what} of a Sobol' sequence are not a power of two, and are spread less evenly than "
            f"{below} or {2 * below} are"
        )
