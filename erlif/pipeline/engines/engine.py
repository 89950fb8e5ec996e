"""Interface of the engines that compute triggers, and the engine of local threads."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing, contextmanager
from dataclasses import dataclass
from typing import ClassVar, Protocol, TypeVar

from threadpoolctl import threadpool_limits

from erlif.core.errors import ClusterError
from erlif.pipeline.chain import one_thread_per_frame
from erlif.pipeline.engines.cluster import Cluster, Collect, Work

_Result = TypeVar("_Result")

# Items that wait, or whose results do, beside those in work: one for the thread that becomes free
# while results are collected, one in reserve. More would only take memory.
_AHEAD = 2


class Engine(Protocol):
    """Computes the items of a piece of work, several at a time.

    Attributes
    ----------
    elsewhere : bool
        Whether other processes compute the items, perhaps on other machines.
    """

    elsewhere: ClassVar[bool]

    def compute(self, work: Work[_Result], items: Sequence[int], collect: Collect[_Result]) -> None:
        """Compute all items and collect their results.

        Parameters
        ----------
        work : callable
            Number of an item to its result; called for several items at the same time.
        items : sequence of int
            Numbers of the items.
        collect : callable
            Receives number and result of each item, in the order of `items`, in the calling thread.

        Raises
        ------
        Exception
            What `work` or `collect` raise; items that are not begun yet are then left out.
        """
        ...


@dataclass(frozen=True)
class Threads:
    """Threads of this process.

    Attributes
    ----------
    elsewhere : bool
        As for `Engine`.
    workers : int | None
        Number of threads; default: one per processor.

    Examples
    --------
    >>> squares = {}
    >>> Threads(2).compute(lambda n: n**2, [1, 2, 3], squares.__setitem__)
    >>> squares
    {1: 1, 2: 4, 3: 9}
    """

    elsewhere: ClassVar[bool] = False
    workers: int | None = None

    def compute(self, work: Work[_Result], items: Sequence[int], collect: Collect[_Result]) -> None:
        """As `Engine.compute`."""
        threads = self.workers or os.cpu_count() or 1
        jobs: deque[tuple[int, Future[_Result]]] = deque()

        def collect_first() -> None:
            item, job = jobs.popleft()
            collect(item, job.result())

        with one_thread_per_frame(), ThreadPoolExecutor(threads) as pool:
            try:
                for item in items:
                    if len(jobs) >= threads + _AHEAD:
                        collect_first()
                    jobs.append((item, pool.submit(work, item)))
                while jobs:
                    collect_first()
            except BaseException:
                for _, job in jobs:
                    job.cancel()
                raise


@contextmanager
def open_engine(*, workers: int | None = None, scheduler: str | None = None) -> Iterator[Engine]:
    """Make the engine that the user asks for, for one run or for many.

    Parameters
    ----------
    workers : int, optional
        Threads; default: one per processor.
    scheduler : str, optional
        Scheduler of dask whose workers compute, as for
        `erlif.pipeline.engines.cluster.Cluster`; default: threads of this process.

    Returns
    -------
    context manager
        Gives the engine.

    Raises
    ------
    ClusterError
        If both are given, or the scheduler cannot be used.
    """
    if scheduler is not None and workers is not None:
        raise ClusterError(
            "Expected workers for threads of this process, or scheduler for workers of dask; got "
            f"both. With local:{workers} the scheduler starts as many workers."
        )
    # threads of OpenBLAS spin for 25 ms after each call; the matrices of a pair are small, and its
    # processor time was twice as long (docs/performance.md). Their number also decides the last
    # digit of a sum, which is the same with every engine
    with threadpool_limits(1, user_api="blas"):
        if scheduler is None:
            yield Threads(workers)
            return
        with closing(Cluster(scheduler)) as cluster:
            yield cluster
