"""Settings for every test: nothing is timed, nothing is drawn at random twice, nothing opens a window."""

import os

from hypothesis import settings

# Set before any test imports a drawing library, and inherited by the commands that tests run.
os.environ.setdefault("MPLBACKEND", "Agg")
os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")

# A deadline would be a timed test; derandomized, a failure seen once is seen again.
settings.register_profile("rod", deadline=None, derandomize=True)
settings.load_profile("rod")
