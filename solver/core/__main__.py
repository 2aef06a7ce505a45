"""Compile the core anew, in a checkout after a change of the C files: python -m solver.core.

With the word `wasm`, compile rod.wasm for browsers instead; this needs the package ziglang.
"""

import sys

from .build import build, build_for_browsers

if __name__ == "__main__":
    if sys.argv[1:] == ["wasm"]:
        build_for_browsers()
    else:
        path, why = build()
        if path is None:
            raise RuntimeError(why)
