"""Whether the compiled kernels can be loaded: they need the package numba (the extra `fast`)."""

from importlib.util import find_spec

INSTALLED = find_spec("numba") is not None
