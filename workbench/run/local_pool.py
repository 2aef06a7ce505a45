"""Who solves the chunks: this process, or several on this machine. The engine on a cluster is in `cluster`.

An engine yields each chunk with its packed results as they come, in any order; or with None, where it killed its worker
twice. A worker only solves: this process alone writes, so a worker that outlives a killed run can do no harm.
"""

import os
from collections import deque
from collections.abc import Iterable, Iterator
from multiprocessing.connection import wait

from studies import Study

from .block import Chunk, solved
from .worker_processes import Worker

Results = Iterator[tuple[Chunk, bytes | None]]

DEATHS = 2  # of workers at one chunk, after which it is given up


def serial(study: Study, chunks: Iterable[Chunk], block: int) -> Results:
    """In this process, one after the other."""
    for chunk in chunks:
        yield chunk, solved(study, chunk, block)


def cores() -> int:
    """How many this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def pool(study: Study, chunks: Iterable[Chunk], block: int, workers: int) -> Results:
    """In so many processes of this machine.

    A worker that dies is replaced, and its chunk solved again block by block; a block that kills another worker is
    given up. Raises `InputError` where workers cannot start.
    """
    waiting, again = iter(chunks), deque[Chunk]()
    crew: list[Worker] = []
    try:
        for _ in range(workers):  # each known at once, so that it is stopped where the next cannot start
            crew.append(Worker(study))
        for worker in crew:
            worker.check()
        while True:
            for worker in crew:
                if worker.chunk is None and (chunk := again.popleft() if again else next(waiting, None)):
                    worker.give(chunk, block)
            busy = {worker.pipe: worker for worker in crew if worker.chunk}
            if not busy:
                return
            for pipe in wait(list(busy)):
                worker = busy[pipe]  # type: ignore[index]
                chunk, results = worker.take()
                if results is None:
                    worker.replace()
                    if chunk.deaths + 1 < DEATHS:
                        again.extend(chunk.blocks(block, chunk.deaths + 1))
                        continue
                elif following := again.popleft() if again else next(waiting, None):
                    worker.give(following, block)  # before the results are stored
                yield chunk, results
    finally:
        for worker in crew:
            worker.stop()
