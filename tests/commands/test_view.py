"""``erlif view``."""

import importlib
import re
import stat
import time
import webbrowser
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

view = importlib.import_module("erlif.commands.view")  # the package exports the command


def test_the_browser_gets_a_file_that_only_its_owner_reads(command, film, monkeypatch):
    """The command line of a browser is seen by all; the real server is interrupted at once."""
    opened = []

    def interrupt(given):
        page = Path(url2pathname(urlsplit(given).path))
        modes = [stat.S_IMODE(path.stat().st_mode) for path in (page, page.parent)]
        opened.append((given, page, page.read_text(), modes))
        raise KeyboardInterrupt

    monkeypatch.setattr(webbrowser, "open", interrupt)
    result = command("view", film)
    ((given, page, text, modes),) = opened
    address = re.search(r"http://127\.0\.0\.1:\d+/[^/]+/", result.output)[0]
    assert given.startswith("file:")
    assert address.split("/")[3] not in given
    assert f'content="0; url={address}"' in text
    assert modes == [0o600, 0o700]
    assert not page.parent.exists()  # removed at the end
    assert result.output.endswith("The viewer has ended.\n")


def test_the_file_that_opens_the_browser_is_removed_after_a_while(monkeypatch):
    monkeypatch.setattr(view, "_KEPT", 0.01)
    with view.leading_to("http://127.0.0.1:1/token/") as page:
        for _ in range(500):
            if not page.exists():
                break
            time.sleep(0.01)
        assert not page.exists()
