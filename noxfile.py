#!/usr/bin/env -S uv run --script
# /// script
# dependencies = ["nox>=2025.5"]
# ///
"""Tasks of developers: `nox -l` lists them, `nox` runs the tests and the checks."""

import nox

nox.needs_version = ">=2025.5"
nox.options.default_venv_backend = "uv|venv"
PINNED = ("-c", "constraints.txt")


@nox.session
def tests(session: nox.Session) -> None:
    """The default tests; arguments after -- go to pytest."""
    session.install(*PINNED, "-e", ".[test]")
    session.run("pytest", "-n", "auto", "--dist", "loadfile", *session.posargs)


@nox.session(default=False)
def slow(session: nox.Session) -> None:
    """The longer tests."""
    session.install(*PINNED, "-e", ".[test,taylor]")
    session.run("pytest", "-n", "auto", "--dist", "loadfile", "-m", "slow", *session.posargs)


@nox.session(default=False)
def coverage(session: nox.Session) -> None:
    """The default tests, with the share of lines that they run; not counted is what other processes run."""
    session.install(*PINNED, "-e", ".[test]", "pytest-cov>=6")
    session.run("pytest", "-n", "auto", "--dist", "loadfile", "--cov", *session.posargs)


@nox.session
def checks(session: nox.Session) -> None:
    """Style and types."""
    session.install(*PINNED, "-e", ".[test]")
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")
    session.run("mypy")


@nox.session(default=False)
def docs(session: nox.Session) -> None:
    """The documentation site, in build/docs/html; a wheel made afterwards carries it."""
    session.install(*PINNED, "-c", "docs/constraints.txt", "-e", ".[docs]")
    session.run("python", "-m", "docs.build")


@nox.session(default=False)
def wheel(session: nox.Session) -> None:
    """A wheel with the compiled core, in dist."""
    session.install("build")
    session.run("python", "-m", "build", "--wheel", "--outdir", "dist")


if __name__ == "__main__":
    nox.main()
