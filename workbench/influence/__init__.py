"""What matters: how the observables of a case answer its fields, and which sampled field decides an observable."""

from .derivatives import local
from .sobol_indices import analyse, sobol

__all__ = ["analyse", "local", "sobol"]
