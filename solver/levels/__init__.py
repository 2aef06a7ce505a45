"""Every equilibrium between two end angles under dead loads: transit times, a grid of levels, brackets, roots."""
