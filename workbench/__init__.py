"""Runs, stores, draws, checks and reports studies; the command line.

`import workbench.accessor` gives datasets their accessor `ds.rod`; this package itself imports nothing heavy.
"""

__version__ = "0.3.0"
