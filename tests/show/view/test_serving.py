"""The server as a process of its own."""

import signal
import subprocess
import sys
import urllib.request

import pytest

from erlif.core.errors import ErlifError
from erlif.show.view import serving


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
