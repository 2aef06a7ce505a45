"""One equilibrium as a root: its numbers, which of them are given, their exact derivatives, charts, Morse index."""
