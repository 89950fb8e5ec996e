"""The server as a process of its own."""

import os
import resource
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from concurrent.futures import ThreadPoolExecutor

import pytest

from erlif.core.errors import ErlifError
from erlif.show.view import handlers, serving


def test_a_missing_package_is_named_with_the_line_that_installs_it(monkeypatch):
    monkeypatch.setattr(serving, "find_spec", lambda name: None if name == "tornado" else name)
    with pytest.raises(ErlifError, match=r'tornado is not installed.*pip install "erlif\[view\]"'):
        serving.require_library()
    monkeypatch.setattr(serving, "find_spec", lambda name: None)
    with pytest.raises(ErlifError, match="tornado and tomlkit are not installed"):
        serving.require_library()


def test_a_port_in_use_is_refused(example_path, serve):
    access = serve(example_path)
    with pytest.raises(ErlifError, match=r"Expected port \d+ .* Choose another one with --port"):
        serving.serve_films([example_path], port=access.port)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows sends no SIGINT to one process")
def test_the_command_prints_its_address_and_ends_with_control_c(example_path):
    # a process started in the background of a shell ignores the signal unless it asks for it
    code = "import signal as s; s.signal(s.SIGINT, s.default_int_handler)"
    code += "; from erlif.commands.main import main; main(prog_name='erlif')"
    command = [sys.executable, "-c", code, "view", "--no-browser", str(example_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            address = process.stdout.readline().decode().split()[-1]
            with urllib.request.urlopen(address, timeout=20) as response:
                assert b"<title>erlif view</title>" in response.read()
            process.send_signal(signal.SIGINT)
            out, errors = process.communicate(timeout=20)
        finally:
            process.kill()
    assert process.returncode == 0
    assert out.decode().splitlines()[-1] == "The viewer has ended."
    assert not errors


@pytest.fixture
def many_files():
    """Allow this process as many open files as the system does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(2**14, hard), hard))
    yield
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def connect(address, count):
    port = int(address.split(":")[2].split("/")[0])
    return [socket.create_connection(("127.0.0.1", port), 10) for _ in range(count)]


def is_served(address):
    try:
        with urllib.request.urlopen(address, timeout=5) as response:
            return response.status == 200
    except OSError:
        return False


def test_idle_connections_of_others_take_few_handles_and_end(monkeypatch, caplog, many_files):
    monkeypatch.setattr(serving, "_IDLE", 0.5)
    with (
        ThreadPoolExecutor(1) as executor,
        serving.serving(port=0, films=[], executor=executor) as address,
    ):
        before, count = len(os.listdir("/proc/self/fd")), 4 * handlers.PageServer.most
        idle = connect(address, count)
        time.sleep(0.3)
        assert len(os.listdir("/proc/self/fd")) - before - count <= handlers.PageServer.most
        began = time.monotonic()
        while not is_served(address):
            time.sleep(0.1)
        assert time.monotonic() - began < 10
        for one in idle:
            one.close()
    assert not caplog.records


PROGRAM = """
import os, resource
from concurrent.futures import ThreadPoolExecutor
from erlif.show.view.serving import serving
with serving(port=0, films=[], executor=ThreadPoolExecutor(1)) as address:
    few = len(os.listdir("/proc/self/fd")) + 4
    resource.setrlimit(resource.RLIMIT_NOFILE, (few, few))
    print(address, flush=True)
    input()
"""


def test_a_server_without_a_free_handle_prints_its_fault_once():
    """The loop tries again without a pause: 401,972 lines were printed in a minute."""
    pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    with subprocess.Popen([sys.executable, "-c", PROGRAM], text=True, **pipes) as process:
        try:
            idle = connect(process.stdout.readline().strip(), 30)
            time.sleep(1)
            for one in idle:
                one.close()
            _, errors = process.communicate("\n", timeout=20)
        finally:
            process.kill()
    assert errors.count("Too many open files") == 1
    assert len(errors.splitlines()) < 40
