"""Workers of dask: order, several processes, lost and late workers, and what is refused."""

import contextlib
import importlib.util
import itertools
import logging
import os
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from scenes.workers import Checked, Deadly, Faulty, Squares

import erlif
from erlif.core.errors import ClusterError, FrameError
from erlif.io.files import ZarrMaps
from erlif.pipeline.engines import cluster as module
from erlif.pipeline.engines.cluster import Cluster
from erlif.pipeline.engines.engine import Threads, open_engine
from erlif.pipeline.engines.triggers import TriggerWork
from erlif.rig import RigSettings, simulate

distributed = pytest.importorskip("distributed")
dask = pytest.importorskip("dask")

SMALL = RigSettings(width=96, height=64, fixture_frames=3, dark_pages=4, flat_pages=3, bubbles=0)
"""Fifty triggers of 96 x 64 pixels."""


@pytest.fixture(scope="module")
def two_workers():
    with contextlib.closing(Cluster("local:2")) as engine:
        yield engine


@pytest.fixture
def address(two_workers):
    """Address of a scheduler with two workers."""
    collect(two_workers, Squares(), [1])
    return two_workers._client.scheduler.address


@pytest.fixture(scope="module")
def spare_workers(tmp_path_factory):
    """A cluster that tests may damage."""
    with (
        started_from_a_server(),
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
            local_directory=str(tmp_path_factory.mktemp("workers")),
        ) as workers,
    ):
        yield workers


@pytest.fixture
def own_workers(spare_workers):
    """The same with two workers, whatever an earlier test left of it."""
    with started_from_a_server():
        spare_workers.scale(2)
        for _ in range(600):
            if len(spare_workers.scheduler_info["workers"]) == 2:
                break
            time.sleep(0.1)
        else:
            pytest.fail("the cluster has not two workers")
        yield spare_workers


@contextlib.contextmanager
def started_from_a_server():
    """Start workers from a process that has loaded erlif, in a tenth of the time.

    All other workers of this file are started as those of a user.
    """
    with dask.config.set({"distributed.worker.multiprocessing-method": "forkserver"}):
        context = distributed.utils.get_mp_context()
        context.set_forkserver_preload(["distributed", "distributed.nanny", "erlif.pipeline.run"])
        yield


@contextlib.contextmanager
def connected(workers):
    with contextlib.closing(Cluster(workers.scheduler_address)) as engine:
        yield engine


def collect(engine, work, items):
    found = []
    engine.compute(work, items, lambda *result: found.append(result))
    return found


def test_results_are_collected_in_the_order_of_the_items(two_workers):
    found = collect(two_workers, Squares(), range(100))
    assert [(item, square) for item, (square, _) in found] == [(n, n**2) for n in range(100)]


def test_both_workers_take_part_and_this_process_does_not(two_workers):
    found = collect(two_workers, Squares(0.02), range(40))
    processes = [process for _, (_, process) in found]
    assert len(set(processes)) == 2
    assert os.getpid() not in processes
    assert min(processes.count(one) for one in set(processes)) > 10


def test_each_worker_checks_the_work_once(two_workers, tmp_path):
    processes = {process for _, process in collect(two_workers, Checked(tmp_path), range(40))}
    checked = {int(file.name): file.read_text() for file in tmp_path.iterdir()}
    assert checked == dict.fromkeys(processes, "checked\n")


@pytest.mark.parametrize("error", [FrameError("frame 7 is damaged"), TimeoutError("too slow")])
def test_an_error_of_the_work_is_that_of_the_caller(two_workers, error):
    with pytest.raises(type(error), match=str(error)):
        collect(two_workers, Faulty(7, error), range(20))


def test_an_error_of_the_collection_ends_the_work(two_workers):
    def refuse(item, result):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        two_workers.compute(Squares(), range(1000), refuse)
    assert len(collect(two_workers, Squares(), range(3))) == 3


# workers come and go


def test_items_of_a_lost_worker_are_computed_again(own_workers):
    with connected(own_workers) as engine:
        victim = own_workers.workers[0].pid
        killer = threading.Timer(1.0, os.kill, (victim, signal.SIGKILL))
        killer.start()
        found = collect(engine, Squares(0.02), range(200))
    assert [square for _, (square, _) in found] == [n**2 for n in range(200)]
    assert len({process for _, (_, process) in found}) >= 2


def test_a_late_worker_takes_part(own_workers):
    with connected(own_workers) as engine:
        adding = threading.Timer(0.5, own_workers.scale, (3,))
        adding.start()
        found = collect(engine, Squares(0.03), range(400))
    assert len({process for _, (_, process) in found}) >= 3


def test_work_waits_for_a_worker_and_reports_it(own_workers, monkeypatch, caplog):
    monkeypatch.setattr(module, "_LOOK", 0.5)

    def leave_and_return():
        own_workers.scale(0)
        # the worker returns once its absence was reported, however slow the machine is
        last = time.monotonic() + 60
        while time.monotonic() < last and not any(
            record.name == module.__name__ for record in caplog.records
        ):
            time.sleep(0.1)
        own_workers.scale(1)

    with connected(own_workers) as engine:
        threading.Timer(0.5, leave_and_return).start()
        found = collect(engine, Squares(0.03), range(200))
    assert [item for item, _ in found] == list(range(200))
    warnings = [record for record in caplog.records if record.levelname == "WARNING"]
    # dask warns as well where a worker ends late
    (line,) = [record.getMessage() for record in warnings if record.name.startswith("erlif.")]
    assert "has no worker any more" in line
    assert f"dask worker {own_workers.scheduler_address}" in line


def test_an_item_that_ends_every_worker_is_refused(own_workers, tmp_path):
    folder = tmp_path / "deaths"
    folder.mkdir()
    for n in range(10):
        (folder / str(n)).touch()
    with connected(own_workers) as engine, pytest.raises(ClusterError, match="lack of memory"):
        collect(engine, Deadly(folder), range(4))
    assert len(list(folder.iterdir())) == 6  # dask gives an item up after four lost workers


def test_a_lost_scheduler_is_reported(tmp_path):
    file = tmp_path / "scheduler.json"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    run = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--scheduler-file", str(file)]
    scheduler = subprocess.Popen(
        [*run, "--port", "0", "--dashboard-address", ":0"],
        stderr=subprocess.DEVNULL,
        env=environment,
    )
    run = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(file)]
    while not file.exists():
        time.sleep(0.1)
    worker = subprocess.Popen(
        [*run, "--no-nanny", "--no-dashboard", "--local-directory", str(tmp_path)],
        stderr=subprocess.DEVNULL,
        env=environment,
    )
    try:
        with contextlib.closing(Cluster(str(file))) as engine:
            found = []

            def kill_later(item, result):
                found.append(item)
                if len(found) == 10:
                    scheduler.kill()

            with pytest.raises(ClusterError, match=r"connection is lost.*resumes"):
                engine.compute(Squares(0.02), range(1000), kill_later)
    finally:
        for process in (worker, scheduler):
            process.kill()
            process.wait()


# what is refused


@pytest.mark.parametrize(
    "scheduler",
    ["", "local", "local:", "local:0", "local:two", "local:-1", "somewhere", "http://host:8786"],
)
def test_an_unknown_form_is_refused_with_the_known_ones(scheduler):
    with pytest.raises(ClusterError, match=r"local:N .* tcp://HOST:8786.*scheduler.json; got"):
        Cluster(scheduler)


def test_a_scheduler_file_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(ClusterError, match=r"--scheduler-file .*scheduler\.json"):
        Cluster(str(tmp_path / "scheduler.json"))


@pytest.mark.parametrize("scheduler", ["tcp://127.0.0.1:1", "127.0.0.1:1", "[::1]:1"])
def test_a_scheduler_out_of_reach_is_refused(scheduler, monkeypatch):
    monkeypatch.setattr(module, "_PATIENCE", 1)
    with pytest.raises(ClusterError, match="dask scheduler"):
        Cluster(scheduler)


@pytest.mark.parametrize("text", ["{", "[]", '{"id": 3}'])
def test_a_damaged_scheduler_file_is_refused(tmp_path, text):
    (tmp_path / "scheduler.json").write_text(text)
    with pytest.raises(ClusterError, match="Expected a scheduler file"):
        Cluster(str(tmp_path / "scheduler.json"))


def test_a_missing_library_is_named_with_the_way_to_install_it(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ClusterError, match=r'pip install "erlif\[cluster\]"'):
        Cluster("local:2")


def test_a_scheduler_without_workers_is_refused(own_workers, monkeypatch):
    monkeypatch.setattr(module, "_WAIT_FOR_WORKERS", 0.5)
    own_workers.scale(0)
    with connected(own_workers) as engine:
        while engine._client.nthreads():  # workers take their leave
            time.sleep(0.05)
        with pytest.raises(ClusterError, match=r"none came .* dask worker tcp://"):
            collect(engine, Squares(), [1])


def test_another_version_is_refused(two_workers, monkeypatch):
    """The scheduler is in this process, the workers are not."""
    monkeypatch.setattr(module, "__version__", "0.0.0")
    with pytest.raises(ClusterError, match=r"erlif 0\.0\.0, .* worker tcp://.* has \d.*install"):
        collect(two_workers, Squares(), [1])


# engines


def test_threads_are_the_engine_without_a_scheduler():
    with open_engine(workers=3) as engine:
        assert engine == Threads(3)


def test_threads_and_scheduler_together_are_refused():
    with pytest.raises(ClusterError, match="local:3"), open_engine(workers=3, scheduler="local:2"):
        pass


def test_dask_is_not_imported_without_a_scheduler():
    code = (
        "import sys, erlif.pipeline.run, erlif.pipeline.batch, erlif.show.report\n"
        "from erlif.pipeline.engines.engine import open_engine\n"
        "with open_engine(workers=1): pass\n"
        "print(*{name.split('.')[0] for name in sys.modules} & {'dask', 'distributed'})\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""


# runs


@pytest.fixture(scope="module")
def store(small_rig, tmp_path_factory):
    """film.zarr of the rig as a single thread makes it."""
    path = tmp_path_factory.mktemp("store") / "film.zarr"
    erlif.process(small_rig.run, output=path, workers=1).close()
    return path


def contents(path):
    """Bytes of a file, or of each file of a directory."""
    if path.is_file():
        return path.read_bytes()
    return {
        str(entry.relative_to(path)): entry.read_bytes()
        for entry in path.rglob("*")
        if entry.is_file()
    }


@pytest.mark.parametrize("name", ["film.nc", "film.zarr"])
def test_a_film_of_two_workers_is_that_of_one_thread(
    small_rig, film, store, tmp_path, monkeypatch, address, name
):
    """Relative paths are those of this process, the workers have another directory."""
    monkeypatch.chdir(small_rig.directory)
    output = os.path.relpath(tmp_path / name)
    scheduler = "local:2" if name == "film.nc" else address
    erlif.process("run", output=output, scheduler=scheduler).close()
    assert contents(tmp_path / name) == contents(film if name == "film.nc" else store)
    assert [entry.name for entry in tmp_path.iterdir()] == [name]


def test_a_film_that_threads_began_is_finished_by_workers(small_rig, store, tmp_path, address):
    def stop(what, done, total):
        if (what, done) == ("film", 2):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        erlif.process(small_rig.run, output=tmp_path / "film.zarr", workers=1, progress=stop)
    erlif.process(small_rig.run, output=tmp_path / "film.zarr", scheduler=address).close()
    assert contents(tmp_path / "film.zarr") == contents(store)


def test_a_worker_that_does_not_see_the_run_is_refused(two_workers, tmp_path):
    """What another machine reports, without a shared disk."""
    work = TriggerWork(
        print,
        [[0]],
        ZarrMaps(tmp_path, (), (1, 2, 3)),
        (tmp_path / "frame_0000.tif",),
    )
    with pytest.raises(ClusterError, match=r"frame_0000\.tif on every machine.* share"):
        collect(two_workers, work, [0])


@pytest.fixture(scope="module")
def long_run(tmp_path_factory):
    """A run of 50 triggers with its calibration, and its films as a single thread makes them."""
    folder = tmp_path_factory.mktemp("long")
    simulate(folder, seed=14, rig=SMALL)
    erlif.save_calibration(erlif.calibrate(folder / "fixture"), folder / "fixture/calibration.nc")
    for name in ("film.nc", "film.zarr"):
        erlif.process(folder / "run", output=folder / name, workers=1).close()
    return folder


class Killer:
    """Kills one of the workers at a random moment while a film is made, as its progress."""

    def __init__(self, workers, moments, *, between):
        self.workers, self.moments = workers, moments
        self.trigger = int(moments.integers(*between))
        self.timer = None

    def __call__(self, what, done, total):
        if what == "film" and done >= self.trigger and self.timer is None:
            self.timer = threading.Timer(self.moments.uniform(0, 0.1), self.kill)
            self.timer.start()

    def kill(self):
        """A worker that is not connected yet would be one of dask's own start."""
        connected = self.workers.scheduler_info["workers"]
        ready = [
            nanny for nanny in self.workers.workers.values() if nanny.worker_address in connected
        ]
        os.kill(self.moments.choice(ready).pid, signal.SIGKILL)


@pytest.mark.slow
def test_a_worker_killed_at_any_moment_leaves_the_film_unchanged(long_run, tmp_path, own_workers):
    """Early and late in a run of each kind of film, one of the two workers is killed.

    A fault that half of the moments bring out is missed by four with a probability of 6 %.
    """
    moments = np.random.default_rng(4)
    cases = itertools.product(((1, 23), (23, 45)), ("film.nc", "film.zarr"))
    for between, name in cases:
        killer = Killer(own_workers, moments, between=between)
        erlif.process(
            long_run / "run",
            output=tmp_path / "film" / name,
            scheduler=own_workers.scheduler_address,
            progress=killer,
        ).close()
        killer.timer.join()
        assert contents(tmp_path / "film" / name) == contents(long_run / name)
        assert [entry.name for entry in (tmp_path / "film").iterdir()] == [name]
        shutil.rmtree(tmp_path / "film")
