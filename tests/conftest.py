"""Settings for every test: nothing is timed, nothing is drawn at random twice, nothing opens a window."""

import gc
import os

from hypothesis import HealthCheck, given, settings
from hypothesis.strategies import none

# Set before any test imports a drawing library, and inherited by the commands that tests run.
os.environ.setdefault("MPLBACKEND", "Agg")
os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")
# One thread of BLAS, as workers have: two that wait for each other took half the time of tests with dense matrices.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# The tests start many processes of Python, and without bytecode each would compile all modules of the project.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# A deadline would be a timed test, and so is the health check of how long it takes to draw examples: on a busy machine
# any take long. Derandomized, a failure seen once is seen again.
settings.register_profile("rod", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("rod")


def pytest_collection_finish() -> None:
    """Leave all that was imported out of the later searches for garbage, which took a seventh of the suite's time."""
    _registered()
    gc.collect()
    gc.freeze()


@given(none())
def _registered(_: None) -> None:
    """Have Hypothesis register what draws at random: with Python 3.14 it searches for what refers to that."""
