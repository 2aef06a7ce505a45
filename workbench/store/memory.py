"""Freed memory kept by a process for its next array, in place of returning it to the system."""

import ctypes
import sys

# Of malloc.h. The sizes are the largest that glibc itself would choose after such arrays were freed.
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
_KEPT, _LARGEST = 64 * 2**20, 32 * 2**20


def keep() -> None:
    """Keep up to 64 MB of freed memory in this process, where the C library (glibc) has that setting.

    Otherwise the system provides each temporary array of a block page by page, which costs a sixth of the time; Dask
    starts its workers with that setting off. The setting holds for the whole process, so it is for our own only.
    """
    if sys.platform != "linux":
        return
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_MMAP_THRESHOLD, _LARGEST)
        mallopt(_TRIM_THRESHOLD, _KEPT)
