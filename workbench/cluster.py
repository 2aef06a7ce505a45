"""Who solves the chunks: the workers of a Dask cluster that is there already (extra `cluster`).

Results come back to this process, which alone writes; so the workers need the packages, and no folder in common.
"""

import itertools
from collections.abc import Iterable
from typing import Any

from solver.errors import InputError
from studies import Study

from .chunks import Chunk, solved
from .engines import DEATHS, Results
from .plan import Plan, check_worker, code_version

MISSING = "--scheduler needs the packages dask and distributed: pip install 'rod-workbench[cluster]'"
PATIENCE = 20.0  # seconds to wait for a scheduler, and for its first worker
AHEAD = 2  # chunks handed out for each thread of a worker: one to work on, one to come


def cluster(work: Plan, missing: Iterable[tuple[int, int]], address: str, asked: int | None) -> Results:
    """On the cluster of that address (tcp://host:port).

    Dask itself solves a chunk again whose worker died, as often as its scheduler allows; a chunk that kills more is
    solved block by block, and a block that does is given up. Raises `InputError` where there is no such cluster, no
    worker, or one with other code.
    """
    try:
        from distributed import Client
    except ImportError:
        raise InputError(MISSING) from None
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
    return solved(study, chunk, block)


def _handed_out(client: Any, work: Plan, chunks: Iterable[Chunk]) -> Results:
    """Chunks in, results out; a few are under way for each thread, so that no side holds many."""
    from distributed import KilledWorker, as_completed

    waiting, code = iter(chunks), code_version()
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

    fill()
    while under_way:
        future = next(done)
        chunk = under_way.pop(future.key)
        error = future.exception() if future.status == "error" else None
        if isinstance(error, KilledWorker):
            if chunk.deaths + 1 < DEATHS:
                for block in chunk.blocks(work.block, chunk.deaths + 1):
                    hand_out(block)
                continue
            fill()
            yield chunk, None
        elif error is not None:
            raise error
        elif future.status != "finished":
            raise InputError("the Dask scheduler went away; what is finished is kept, and the same command goes on")
        else:
            results = future.result()
            future.release()
            fill()
            yield chunk, results
