"""Chunks solved by the workers of a Dask cluster (extra `cluster`).

Workers only solve, and the process of the run alone writes: a cluster needs the packages, but no shared folder.
"""

import traceback
from collections.abc import Iterable
from typing import Any
from urllib.parse import urlsplit

from solver.problem.errors import InputError
from studies import Study

from .block import Chunk, keep_memory, solve_chunk
from .plan import Plan
from .recipe import check_worker, code_version
from .worker_processes import KILLED, Answer, Results, hand_out

MISSING = "--scheduler needs the packages dask and distributed: pip install 'rod-workbench[cluster]'"
PATIENCE = 20.0  # seconds to wait for a scheduler, and for its first worker
AHEAD = 2  # chunks submitted for each thread of a worker: one to solve, one to wait


def solve(work: Plan, missing: Iterable[tuple[int, int]], address: str, chunk_size: int | None) -> Results:
    """Solve the missing cases on the cluster at that address (tcp://host:port).

    A few chunks are submitted for each thread, so that neither side holds many. Where a worker dies, Dask solves its
    chunks again, as often as its scheduler allows, and then gives up all of them. Raises `InputError` where there is no
    such cluster, no worker, or a worker with other code, and `OSError` where the scheduler goes away.
    """
    try:
        from distributed import CancelledError, Client, KilledWorker, as_completed
        from distributed.comm.core import CommClosedError
    except ImportError:
        raise InputError(MISSING) from None
    _check_address(address)
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        why = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"no Dask scheduler answers at {address}: {why}") from None
    done, code = as_completed(loop=client.loop), code_version()
    under_way: dict[Any, Chunk] = {}

    def threads() -> int:
        return sum(client.nthreads().values())

    def give(chunk: Chunk) -> None:
        future = client.submit(_solve, work.light, chunk, work.block, code, pure=False)
        under_way[future.key] = chunk
        done.add(future)

    def take() -> tuple[Chunk, Answer]:
        future = next(done)
        chunk = under_way.pop(future.key)
        try:
            answer = future.result()  # Dask solves it again where the worker died before the results were fetched
        except KilledWorker:
            return chunk, KILLED
        except (CancelledError, CommClosedError):
            raise ConnectionError("the Dask scheduler no longer answers") from None
        future.release()
        return chunk, answer

    try:
        _check_workers(client, work.light)
        chunks = work.chunks(missing, work.chunk_size(threads(), chunk_size))
        yield from hand_out(work, chunks, lambda: AHEAD * max(1, threads()) - len(under_way), give, take)
    finally:
        client.close(timeout=2)


def _check_address(address: str) -> None:
    try:
        parts = urlsplit(address)
        if parts.scheme in ("tcp", "tls") and parts.hostname and parts.port:
            return
    except ValueError:  # a port that is no number
        pass
    raise InputError(f"--scheduler must be tcp://host:port or tls://host:port, got {address!r}")


def _check_workers(client: Any, study: Study) -> None:
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        raise InputError(f"the cluster has no worker after {PATIENCE:g} s; start one with dask worker") from None
    try:
        client.run(check_worker, study, code_version())
    except ImportError as error:
        raise InputError(f"a worker lacks what this run needs: {error}") from None


def _solve(study: Study, chunk: Chunk, block: int, code: str) -> tuple[int, bytes]:
    """Solve a chunk or its first part (`solve_chunk`) in a worker, which may have joined later than the others."""
    check_worker(study, code)
    keep_memory()
    try:
        return solve_chunk(study, chunk, block)
    except InputError:
        raise
    except Exception:
        wrong = traceback.format_exc()
    # Outside the handler: Dask also sends the exception's context, and waits for ever where it cannot be sent.
    raise RuntimeError(f"in a worker of the cluster:\n{wrong}")
