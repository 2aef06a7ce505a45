"""Compilation of the kernels by numba (the extra `fast`), and their cache on disk."""

from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

INSTALLED = find_spec("numba") is not None


def compiled(function: Any) -> Any:
    """The function as machine code, cached on disk; where no folder can be written, compiled in each process."""
    from numba import njit

    options: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}, "nogil": True}
    try:
        kernel = njit(cache=True, **options)(function)
    except RuntimeError:  # numba found no place for its cache
        return njit(**options)(function)
    drop_stale_cache(Path(kernel.stats.cache_path), Path(__file__).parent)
    return kernel


@cache
def drop_stale_cache(cache: Path, sources: Path) -> None:
    """Delete the cached kernels that are older than a source of this package.

    numba compares a cached function with the file of that function alone, and not with the files of the functions that
    it calls.
    """
    newest = max(file.stat().st_mtime for file in sources.glob("*.py"))
    for index in cache.glob("*.nbi"):
        try:
            if index.stat().st_mtime < newest:
                index.unlink()
        except OSError:  # another process deleted it, or the folder is read-only
            continue
