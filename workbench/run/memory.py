"""What a process does with memory that an array has left: keep it for the next one."""

import ctypes
import sys

# Of malloc.h. The sizes are those up to which glibc itself goes, once it has seen such arrays come and go.
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
_KEPT, _LARGEST = 64 * 2**20, 32 * 2**20


def keep() -> None:
    """Let this process keep up to 64 MB of what arrays leave, where the C library can be told so (glibc).

    Otherwise each temporary array of a block is fetched from the system page by page, which costs a sixth of the time;
    a worker of Dask is even started so that it always does. For processes of our own only: it holds for the whole one.
    """
    if sys.platform != "linux":
        return
    tell = getattr(ctypes.CDLL(None), "mallopt", None)
    if tell is not None:
        tell(_MMAP_THRESHOLD, _LARGEST)
        tell(_TRIM_THRESHOLD, _KEPT)
