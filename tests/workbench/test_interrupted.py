"""`trade`, with and without `--extremes`, shows how far it is and, interrupted, keeps what it finished; status 130."""

import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from workbench.stored import reading

ROOT = Path(__file__).parents[2]
SECOND = r"([2-9]|\d\d+) of "  # progress is not said for each case


def stopped(after: str, *args: str) -> tuple[int, str]:
    """The command's status and stderr, interrupted once a line begins with the expression `after`."""
    run = subprocess.Popen(
        [sys.executable, "-m", "workbench", *args], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT
    )
    assert run.stderr is not None
    said = ""
    for line in run.stderr:
        said += line
        if re.match(after, line):
            run.send_signal(signal.SIGINT)
            break
    said += run.communicate(timeout=60)[1]
    return run.returncode, said


def finished(said: str) -> int:
    """How many cases were finished, as the command says."""
    return int(said.partition("workbench: interrupted; ")[2].partition(" of ")[0])


@pytest.mark.slow
def test_trade_keeps_the_cases_it_finished(tmp_path: Path) -> None:
    status, said = stopped(SECOND, "trade", "--methods", "orbit,dop853", "--out", str(tmp_path))
    assert status == 130, said
    count = finished(said)
    assert count >= 1
    assert not (tmp_path / "trade.h5").exists()
    ds = reading.read(tmp_path / "trade_interrupted.h5", study=False)
    assert ds.sizes["case"] == count
    assert (tmp_path / "trade_interrupted_seconds.png").stat().st_size > 10_000


@pytest.mark.slow
def test_extremes_keep_what_is_finished_and_leave_no_process(tmp_path: Path) -> None:
    status, said = stopped(SECOND, "trade", "--extremes", "--out", str(tmp_path))
    assert status == 130, said
    assert "Traceback" not in said
    count = finished(said)
    assert count >= 2
    assert not (tmp_path / "extremes.h5").exists()
    ds = reading.read(tmp_path / "extremes_interrupted.h5", study=False)
    assert ds.sizes["extreme"] == count
    assert (tmp_path / "extremes_interrupted.png").stat().st_size > 10_000
