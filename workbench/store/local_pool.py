"""Chunks solved in this process, or by several workers on this machine (on a cluster: `dask_engine`).

An engine yields each chunk with its packed results, in any order; or with the outcome of its cases, where two workers
died at it. Workers only solve, and this process alone writes.
"""

import os
from collections import deque
from collections.abc import Iterable, Iterator
from multiprocessing.connection import wait

from studies import Study

from .block import Chunk, solve_chunk
from .worker_processes import Worker

Results = Iterator[tuple[Chunk, bytes | str]]

DEATHS = 2  # of workers at one block, after which it is given up
KILLED = "failed: the process that solved it ended twice without an answer"


def serial(study: Study, chunks: Iterable[Chunk], block: int) -> Results:
    """In this process, one after the other."""
    for chunk in chunks:
        yield chunk, solve_chunk(study, chunk, block)


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def pool(study: Study, chunks: Iterable[Chunk], block: int, workers: int) -> Results:
    """Solve the chunks in so many processes of this machine.

    A worker that dies is replaced, and its chunk is solved again block by block; a block at which a second worker dies
    is given up. Raises `InputError` where workers cannot start.
    """
    waiting, again = iter(chunks), deque[Chunk]()
    started: list[Worker] = []
    try:
        for _ in range(workers):  # each is listed at once, so that it is stopped where the next cannot start
            started.append(Worker(study))
        for worker in started:
            worker.check()
        while True:
            for worker in started:
                if worker.chunk is None and (chunk := again.popleft() if again else next(waiting, None)):
                    worker.give(chunk, block)
            busy = {worker.pipe: worker for worker in started if worker.chunk}
            if not busy:
                return
            for pipe in wait(list(busy)):
                worker = busy[pipe]  # type: ignore[index]
                chunk, results = worker.take()
                if results is None:
                    how = worker.end_reason()
                    worker.replace()
                    if chunk.deaths + 1 < DEATHS:
                        again.extend(chunk.blocks(block, chunk.deaths + 1))
                    else:
                        yield chunk, f"{KILLED} ({how})"
                    continue
                if following := again.popleft() if again else next(waiting, None):
                    worker.give(following, block)  # before the results are stored
                yield chunk, results
    finally:
        for worker in started:
            worker.stop()
