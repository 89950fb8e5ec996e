"""Triggers computed by the workers of a scheduler of dask, on this machine or on others.

dask.distributed is imported where a cluster is used, and nowhere else.
"""

from __future__ import annotations

import asyncio
import importlib.util
import json
import logging
import pickle
import re
import tempfile
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager
from itertools import islice
from pathlib import Path
from typing import Any, ClassVar, TypeAlias, TypeVar

import cv2
from threadpoolctl import threadpool_limits

from erlif.core.bounded import read_bounded
from erlif.core.errors import ClusterError
from erlif.core.speed.memory import keep_memory
from erlif.core.version import version_and_sources

_Result = TypeVar("_Result")

# Number of an item to its result.
Work: TypeAlias = Callable[[int], _Result]

# Receives number and result of an item.
Collect: TypeAlias = Callable[[int, _Result], None]

_logger = logging.getLogger(__name__)

# Size of a scheduler file that is read; dask writes a few kilobytes. [byte]
_LARGEST_FILE = 2**20

# Workers on this machine, with their number.
_LOCAL = re.compile(r"local:([1-9]\d*)")

# Address of a scheduler; without a protocol dask takes tcp.
_ADDRESS = re.compile(r"((tcp|tls|ws|wss|ucx|ucxx)://)?(\[[0-9a-fA-F:.]+\]|[^\s/:\[\]]+):\d{1,5}/?")

# Of the client: as the default of dask it would also serve the locks with which xarray writes.
_OPTIONS = {"set_as_default": False}

# Of scheduler and workers on this machine.
_NO_PAGES: dict[str, list[str]] = {
    f"distributed.{place}.http.routes": [] for place in ("scheduler", "worker")
}

# Time in which a scheduler must be reached. [s]
_PATIENCE = 10

# Time in which the first worker must come. [s]
_WAIT_FOR_WORKERS = 60

# Time between two looks at the workers while a result is waited for. [s]
_LOOK = 5

# Items in work or waiting for each thread of the workers: a worker gets its next item before it
# asks, and uncollected results do not grow with the run.
_AHEAD = 4


class Cluster:
    """Workers of a scheduler of dask as an engine.

    The scheduler assigns items to workers. Items of a worker that is lost are computed again by
    another one, and a worker that comes late takes part. A piece of work is sent to each worker
    once.

    Parameters
    ----------
    scheduler : str
        ``local:N``, the address of a scheduler, or its scheduler file.

    Raises
    ------
    ClusterError
        If the form is unknown, dask.distributed is not installed, or the scheduler cannot be
        reached.

    Examples
    --------
    >>> Cluster("local:none")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.ClusterError: Expected --scheduler local:N for N workers on this machine, ...
    """

    elsewhere: ClassVar[bool] = True

    def __init__(self, scheduler: str) -> None:
        self.scheduler = scheduler
        """The scheduler as the user named it."""
        self._open = ExitStack()
        self._client: Any = None
        _check_form(scheduler)
        for package in ("distributed", "cryptography"):
            if importlib.util.find_spec(package) is None:
                raise ClusterError(
                    f"Expected {package} for --scheduler; it is not installed. Install it on all "
                    'machines with: pip install "erlif[cluster]"'
                )
        # workers of our own start with the first work, so that bad input is refused at once
        if not _LOCAL.fullmatch(scheduler):
            self._connect()

    def close(self) -> None:
        """Close the connection to the scheduler; workers that were started here end."""
        self._open.close()
        self._client = None

    def compute(self, work: Work[_Result], items: Sequence[int], collect: Collect[_Result]) -> None:
        """As `erlif.pipeline.engines.engine.Engine.compute`; `work` must be picklable.

        Where `work` has a method ``check``, each worker calls it before its first item.

        Raises
        ------
        ClusterError
            If there is no worker, workers cannot use the work, or the scheduler is lost.
        """
        if not items:
            return
        if self._client is None:
            self._connect()
        self._check_scheduler()
        with _translated(self.scheduler):
            self._compute(work, items, collect)

    def _compute(
        self, work: Work[_Result], items: Sequence[int], collect: Collect[_Result]
    ) -> None:
        name = uuid.uuid4().hex
        sent = self._send(work, name)
        waiting = iter(items)
        jobs: deque[tuple[int, Any]] = deque()
        looked, ahead = 0.0, 0
        try:
            while True:
                # workers come and go: their number decides how much is submitted
                if time.monotonic() - looked > _LOOK:
                    ahead = _AHEAD * max(1, sum(self._client.nthreads().values()))
                    looked = time.monotonic()
                for item in islice(waiting, max(ahead - len(jobs), 0)):
                    key = (f"trigger-{name}", item)
                    job = self._client.submit(
                        _call, sent, name, version_and_sources(), item, key=key
                    )
                    jobs.append((item, job))
                if not jobs:
                    return

                # in the order of the items; one that is lost with its worker is computed again
                item, job = jobs.popleft()
                collect(item, self._obtain(job))
        finally:
            self._client.cancel([job for _, job in jobs], force=True)

    def _send(self, work: Callable[[int], Any], name: str) -> Any:
        """Load the work on one worker; the others fetch it from there.

        The scheduler keeps the pickled work, so that it survives the loss of every worker.
        """
        import dask

        packed = pickle.dumps(work, protocol=pickle.HIGHEST_PROTOCOL)
        _logger.info("%.0f MB are sent to each worker", len(packed) / 1e6)

        # dask warns of large arguments, as most of them would be sent with every item
        with dask.config.set({"distributed.admin.large-graph-warning-threshold": "1TB"}):
            return self._client.submit(
                _unpack_work, packed, version_and_sources(), key=f"work-{name}"
            )

    def _obtain(self, job: Any) -> Any:
        """The result of a job; a warning where there is no worker to compute it."""

        async def fetch() -> Any:
            return await self._client.gather(job, asynchronous=True)

        # asked for once: a large result takes longer than a look to arrive
        fetched = asyncio.run_coroutine_threadsafe(fetch(), self._client.loop.asyncio_loop)
        warned = False
        while True:
            try:
                return fetched.result(timeout=_LOOK)
            except TimeoutError:
                if fetched.done():  # an error of the work itself
                    raise
            if not warned and not self._client.nthreads():
                warned = True
                _logger.warning(
                    "%s has no worker any more; the run goes on when one comes: %s",
                    self.scheduler,
                    self._start_a_worker(),
                )

    def _connect(self) -> None:
        """Connect to the scheduler, or start one with workers on this machine."""
        import dask
        from distributed import Client, LocalCluster

        local = _LOCAL.fullmatch(self.scheduler)
        if local:
            folder = self._open.enter_context(tempfile.TemporaryDirectory(prefix="erlif-workers-"))
            # other users of this machine reach it too: they have no certificate of this start, and
            # are shown no pages about the run
            self._open.enter_context(dask.config.set(_NO_PAGES))
            own = self._open.enter_context(
                LocalCluster(
                    n_workers=int(local[1]),
                    threads_per_worker=1,
                    processes=True,
                    security=True,
                    dashboard_address="127.0.0.1:0",
                    memory_limit=0,  # erlif bounds its memory itself
                    local_directory=folder,
                    silence_logs=logging.CRITICAL,
                )
            )
            self._client = self._open.enter_context(Client(own, **_OPTIONS))
            return

        address = self.scheduler
        if address.endswith(".json"):
            address = _read_address(Path(address))
        try:
            self._client = self._open.enter_context(Client(address, timeout=_PATIENCE, **_OPTIONS))
        except (OSError, ValueError) as error:
            raise ClusterError(
                f"Expected a scheduler of dask at {address}; there is no connection within "
                f"{_PATIENCE} s ({type(error).__name__}). Start one with: dask scheduler"
            ) from error

    def _check_scheduler(self) -> None:
        """Refuse a scheduler without workers, or with another version of erlif."""
        try:
            self._client.wait_for_workers(1, timeout=_WAIT_FOR_WORKERS)
        except TimeoutError as error:
            raise ClusterError(
                f"Expected workers at {self.scheduler}; none came within {_WAIT_FOR_WORKERS} s. "
                f"Start one with: {self._start_a_worker()}"
            ) from error

        try:
            version = self._client.run_on_scheduler(version_and_sources)
        except Exception as error:  # whatever the loading of an unknown module raises there
            raise ClusterError(
                f"Expected erlif {version_and_sources()} at the scheduler {self.scheduler}; it "
                f"cannot be loaded there ({error}). Scheduler and workers need the environment of "
                "this machine: install the same versions."
            ) from error
        _check_version("the scheduler", version, version_and_sources())

    def _start_a_worker(self) -> str:
        return f"dask worker {self._client.scheduler.address} --nthreads 1"


def _check_form(scheduler: str) -> None:
    """Refuse text that names no scheduler."""
    is_address = _ADDRESS.fullmatch(scheduler) and not scheduler.startswith("local:")
    if not (_LOCAL.fullmatch(scheduler) or is_address or scheduler.endswith(".json")):
        raise ClusterError(
            "Expected --scheduler local:N for N workers on this machine, the address of a "
            "scheduler such as tcp://HOST:8786, or the scheduler file that dask wrote, such as "
            f"scheduler.json; got {scheduler!r}. Give one of these."
        )


def _read_address(path: Path) -> str:
    """Address of the scheduler that wrote a file."""
    try:
        return str(json.loads(read_bounded(path, largest=_LARGEST_FILE))["address"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise ClusterError(
            f"Expected a scheduler file in {path}; there is none ({error}). dask writes it with: "
            f"dask scheduler --scheduler-file {path}"
        ) from error


@contextmanager
def _translated(scheduler: str) -> Iterator[None]:
    """Errors of dask as errors of erlif; those of the work itself pass."""
    from distributed.comm import CommClosedError
    from distributed.scheduler import KilledWorker

    try:
        yield
    except KilledWorker as error:
        raise ClusterError(
            f"Expected workers that finish an item; {error.allowed_failures + 1} workers of "
            f"{scheduler} ended while they computed the same one. Their log has the reason, often "
            "a lack of memory. The same command resumes."
        ) from error
    except (CancelledError, CommClosedError) as error:
        raise ClusterError(
            f"Expected the scheduler {scheduler} until the end of the run; the connection is lost. "
            "Finished triggers are kept; the same command resumes."
        ) from error


# on the workers

# Works that this process has checked.
_checked: set[str] = set()


def _unpack_work(packed: bytes, version: str) -> Any:
    """The work that was sent, on a worker."""
    _check_version(_this_worker(), version_and_sources(), version)
    return pickle.loads(packed)


def _call(work: Callable[[int], _Result], name: str, version: str, item: int) -> _Result:
    """One item, on a worker."""
    if name not in _checked:
        _check_version(_this_worker(), version_and_sources(), version)
        cv2.setNumThreads(1)  # the threads of a worker compute different items
        threadpool_limits(1, user_api="blas")
        keep_memory()
        check = getattr(work, "check", None)
        if check is not None:
            check()
        _checked.add(name)
    return work(item)


def _check_version(place: str, version: str, expected: str) -> None:
    if version != expected:
        raise ClusterError(
            f"Expected erlif {expected}, as here; {place} has {version}. Scheduler and workers "
            "need the environment of this machine: install the same versions."
        )


def _this_worker() -> str:
    from distributed import get_worker

    return f"the worker {get_worker().address}"
