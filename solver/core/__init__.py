"""The compiled core: C kernels in one shared library, and their calls on NumPy arrays."""
