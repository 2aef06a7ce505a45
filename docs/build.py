"""Build the documentation site: `python -m docs.build`, from the folder that holds docs; needs the extra `docs`.

The pages of docs are copied to build/docs/source. Beside them come pages that the code itself knows best: the Python
reference, the commands, the keys of a study, the variables of a file. Sphinx makes build/docs/html of all. A warning
ends the build with status 1. `workbench docs` opens the site; a wheel made afterwards carries it.
"""

import shutil
import subprocess
import sys
from pathlib import Path

from docs.website import api_pages, command_pages, dataset_page, live_page, results, sources, study_page

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build" / "docs"


def write_sources(folder: Path) -> None:
    """Write every source of the site to an empty folder."""
    sources.copy(ROOT, folder)
    for part in (api_pages, command_pages, study_page, dataset_page, live_page):
        part.write(folder)
    results.write(folder, BUILD / results.PAGE)
    sources.add_contents(folder)


def main() -> int:
    """Build the site and return the exit status of Sphinx."""
    for old in (BUILD / "source", BUILD / "html"):
        shutil.rmtree(old, ignore_errors=True)
    source = BUILD / "source"
    source.mkdir(parents=True)
    write_sources(source)
    settings = Path(__file__).parent / "website"
    # -E: read every page; -W --keep-going: each warning is printed, and any is an error; -n: unknown references too
    options = ["-q", "-E", "-W", "--keep-going", "-n", "-b", "html", "-c", str(settings), "-d", str(BUILD / "doctrees")]
    options += ["-D", f"html_static_path={source / '_static'}"]
    command = [sys.executable, "-m", "sphinx", *options, str(source), str(BUILD / "html")]
    status = subprocess.run(command, cwd=ROOT, check=False).returncode
    if status == 0:
        print(f"the site is {BUILD / 'html' / 'index.html'}")
    return status


if __name__ == "__main__":
    sys.exit(main())
