"""Who solves the chunks: the workers of a Dask cluster that is there already (extra `cluster`).

Results come back to this process, which alone writes; so the workers need the packages, and no folder in common.
"""

import itertools
import traceback
from collections import deque
from collections.abc import Iterable
from typing import Any
from urllib.parse import urlsplit

from solver.problem.errors import InputError
from studies import Study

from . import memory
from .block import Chunk, solved
from .local_pool import DEATHS, KILLED, Results
from .plan import Plan
from .recipe import check_worker, code_version

MISSING = "--scheduler needs the packages dask and distributed: pip install 'rod-workbench[cluster]'"
PATIENCE = 20.0  # seconds to wait for a scheduler, and for its first worker
AHEAD = 2  # chunks handed out for each thread of a worker: one to work on, one to come


def cluster(work: Plan, missing: Iterable[tuple[int, int]], address: str, asked: int | None) -> Results:
    """On the cluster of that address (tcp://host:port).

    Dask itself solves a chunk again whose worker died, as often as its scheduler allows. Beyond that it blames all that
    the worker had, so the blocks of what it blames are solved in the end, one at a time; a block that kills workers
    even then is given up. Raises `InputError` where there is no such cluster, no worker, or one with other code.
    """
    try:
        from distributed import Client
    except ImportError:
        raise InputError(MISSING) from None
    _check_address(address)
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        why = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"no Dask scheduler answers at {address}: {why}") from None
    try:
        _check_workers(client, work.light)
        threads = sum(client.nthreads().values())
        size = work.chunk_size(threads) if asked is None else work.block * max(1, round(asked / work.block))
        yield from _handed_out(client, work, work.chunks(missing, size))
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


def _solved(study: Study, chunk: Chunk, block: int, code: str) -> bytes:
    """In a worker, which may have come later than the others."""
    check_worker(study, code)
    memory.keep()
    try:
        return solved(study, chunk, block)
    except InputError:
        raise
    except Exception:
        wrong = traceback.format_exc()
    # Not inside the handler: Dask sends what an exception was raised from too, and waits for ever where it cannot.
    raise RuntimeError(f"in a worker of the cluster:\n{wrong}")


def _handed_out(client: Any, work: Plan, chunks: Iterable[Chunk]) -> Results:
    """Chunks in, results out; a few are under way for each thread, so that no side holds many."""
    from distributed import CancelledError, KilledWorker, as_completed
    from distributed.comm.core import CommClosedError

    waiting, suspects, code = iter(chunks), deque[Chunk](), code_version()
    under_way: dict[str, Chunk] = {}
    done = as_completed(loop=client.loop)

    def hand_out(chunk: Chunk) -> None:
        future = client.submit(_solved, work.light, chunk, work.block, code, pure=False)
        under_way[future.key] = chunk
        done.add(future)

    def fill() -> None:
        room = AHEAD * max(1, sum(client.nthreads().values())) - len(under_way)
        for chunk in itertools.islice(waiting, max(0, room)):
            hand_out(chunk)
        if suspects and not under_way:
            hand_out(suspects.popleft())

    fill()
    while under_way:
        future = next(done)
        chunk = under_way.pop(future.key)
        try:
            results = future.result()  # solved again where the worker that held them died before they were fetched
        except KilledWorker:
            if chunk.deaths + 1 < DEATHS:
                suspects.extend(chunk.blocks(work.block, chunk.deaths + 1))
                fill()
                continue
            results = KILLED
        except (CancelledError, CommClosedError):
            raise InputError(
                "the Dask scheduler went away; what is finished is kept, and the same command goes on from there"
            ) from None
        future.release()
        fill()
        yield chunk, results
