"""Compile the core anew, in a checkout after a change of the C files: python -m solver.core.

With the word `wasm`, compile rod.wasm for browsers instead; this needs the package ziglang. With `sanitized FILE`,
compile a library FILE that checks every access and operation; .ci/run says how it is loaded.
"""

import sys
from pathlib import Path

from .build import SANITIZED, build, build_for_browsers

if __name__ == "__main__":
    if sys.argv[1:] == ["wasm"]:
        build_for_browsers()
    else:
        path, why = build(Path(sys.argv[2]), *SANITIZED) if sys.argv[1:2] == ["sanitized"] else build()
        if path is None:
            raise RuntimeError(why)
