"""The paper and the laboratory are tenants: in a copy without one of them all else is imported, listed and run."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOPS = ("solver", "studies", "workbench")
TENANTS = {
    "reproduce": ("studies/paper", "workbench/paper"),
    "trade": ("workbench/lab",),
}
PROGRAM = """
import importlib, pathlib, sys
for top in ("solver", "studies", "workbench"):
    for file in sorted(pathlib.Path(top).rglob("*.py")):
        if file.stem not in ("__main__", "__init__"):
            importlib.import_module(".".join(file.with_suffix("").parts))
from workbench import cli
print(*cli.COMMANDS)
from workbench.web.live import live_document, presets
assert live_document.text(presets.PRESETS, False)
cli.main(["run", "pole_greenhill", "--out", "pole.h5"])
"""


@pytest.mark.parametrize("command", TENANTS)
def test_a_copy_without_a_tenant_lacks_its_command_and_runs_a_study(command: str, tmp_path: Path) -> None:
    for top in TOPS:
        shutil.copytree(ROOT / top, tmp_path / top, ignore=shutil.ignore_patterns("__pycache__"))
    for folder in TENANTS[command]:
        shutil.rmtree(tmp_path / folder)
    ran = subprocess.run([sys.executable, "-c", PROGRAM], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    commands = ran.stdout.splitlines()[0].split()
    assert len(commands) == 18
    assert command not in commands
    assert (tmp_path / "pole.h5").is_file()
