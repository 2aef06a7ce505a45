"""Versions of packages, as results keep them. Needs no xarray."""

from functools import cache
from importlib.metadata import PackageNotFoundError, version


@cache  # reading it takes a millisecond, and a process keeps the packages that it has imported
def version_of(package: str) -> str:
    """The installed version of a package, or that it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
