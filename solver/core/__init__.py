"""The compiled march of periodic orbits, and the loader of its kernels."""
