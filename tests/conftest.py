"""Settings for every test: nothing is timed, nothing is drawn at random twice, nothing opens a window."""

import os

from hypothesis import HealthCheck, settings

# Set before any test imports a drawing library, and inherited by the commands that tests run.
os.environ.setdefault("MPLBACKEND", "Agg")
os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")
# The tests start many processes of Python, and without bytecode each would compile all modules of the project.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# A deadline would be a timed test, and so is the health check of how long it takes to draw examples: on a busy machine
# any take long. Derandomized, a failure seen once is seen again.
settings.register_profile("rod", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("rod")
