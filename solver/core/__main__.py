"""Compile the core anew, in a checkout after a change of the C files: python -m solver.core."""

from .build import build

if __name__ == "__main__":
    path, why = build()
    if path is None:
        raise RuntimeError(why)
