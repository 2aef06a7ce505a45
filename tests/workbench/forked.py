"""`run` does what `subprocess.run` does with `python -m MODULE ...` or `python SCRIPT ...`, but starts at once.

On Linux the process is forked from one that has imported what most commands import; each process of pytest has one
such server, which ends with it. What tests how Python starts or what it imports takes `subprocess` instead.
"""

import atexit
import contextlib
import functools
import gc
import importlib
import json
import os
import runpy
import signal
import socket
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
IMPORTED = (
    "workbench.cli", "workbench.stored.stored_verdicts", "workbench.run.writing",
    "workbench.run.run_and_resume", "workbench.run.file_merge", "workbench.commands.run_study",
    "solver.methods.half_period", "rich.table", "rich.console",
    "pydantic.type_adapter", "scipy.integrate", "scipy.interpolate", "scipy.optimize", "h5netcdf.legacyapi",
    "dask.array", "distributed",
)  # fmt: skip


def run(*words: object, cwd: Path = ROOT, timeout: float = 600) -> subprocess.CompletedProcess[str]:
    """The exit status of such a process (of a signal its negative number) and what it wrote."""
    asked, env = [str(word) for word in words], {**os.environ, "PYTHONPATH": str(ROOT)}
    if sys.platform != "linux":
        command = [sys.executable, *asked]
        return subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, timeout=timeout, check=False)
    told, theirs = socket.socketpair(type=socket.SOCK_SEQPACKET)
    with told, tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        handles = [theirs.fileno(), out.fileno(), err.fileno()]
        socket.send_fds(_server(), [json.dumps([asked, str(cwd), env]).encode()], handles)
        theirs.close()
        pid = int(told.recv(16))
        told.settimeout(timeout)
        try:
            status = int(told.recv(16))
        except TimeoutError:
            os.kill(pid, signal.SIGKILL)
            raise
        texts = [os.pread(file.fileno(), 2**26, 0).decode() for file in (out, err)]
    return subprocess.CompletedProcess(asked, status, *texts)


@functools.cache
def _server() -> socket.socket:
    """The socket to which a process is asked for; the server ends when it closes."""
    ours, theirs = socket.socketpair(type=socket.SOCK_SEQPACKET)
    env = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}  # one thread: it is safe to fork
    command = [sys.executable, "-m", __name__]
    server = subprocess.Popen(command, stdin=theirs, stdout=subprocess.DEVNULL, env=env, cwd=ROOT, process_group=0)
    theirs.close()
    atexit.register(server.wait)
    atexit.register(ours.close)  # called first
    return ours


def _asked() -> list[str]:
    """Fork for each request and return in the new process with its words; end this one when nobody asks any more."""
    requests = socket.socket(fileno=os.dup(0))
    while True:
        request, handles, _, _ = socket.recv_fds(requests, 2**20, 3)
        with contextlib.suppress(ChildProcessError):  # there is none
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        if not request:
            sys.exit()
        if os.fork() == 0:
            requests.close()
            return _forked(*json.loads(request), *handles)
        for handle in handles:
            os.close(handle)


def _forked(words: list[str], folder: str, env: dict[str, Any], told: int, out: int, err: int) -> list[str]:
    """Fork once more and return there; this process waits for the end of that one and tells its status."""
    child = os.fork()
    if child:
        os.write(told, str(child).encode())
        os.write(told, str(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])).encode())
        os._exit(0)
    for target, handle in enumerate((os.open(os.devnull, os.O_RDONLY), out, err)):
        os.dup2(handle, target)
    os.closerange(3, max(told, out, err) + 2)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(env)
    return words


if __name__ == "__main__":
    for name in IMPORTED:
        if find_spec(name.partition(".")[0]):
            importlib.import_module(name)
    gc.freeze()  # a forked process, which ends soon, need not look through what was imported
    first, *others = _asked()
    if first == "-m":
        sys.argv, sys.path[0] = others, os.getcwd()
        runpy.run_module(others[0], run_name="__main__", alter_sys=True)
    else:
        sys.argv, sys.path[0] = [first, *others], str(Path(first).parent)
        runpy.run_path(first, run_name="__main__")
