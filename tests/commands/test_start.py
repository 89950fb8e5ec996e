"""``erlif start``."""

import re
import webbrowser


def test_the_page_is_opened_and_ends_with_an_interrupt(command, tmp_path, monkeypatch):
    def interrupt(given):
        raise KeyboardInterrupt

    monkeypatch.setattr(webbrowser, "open", interrupt)
    result = command("start", tmp_path)
    assert re.search(r"The page is at http://127\.0\.0\.1:\d+/[^/]+/\n", result.output)
    assert result.output.endswith("The page has ended.\n")


def test_a_directory_that_is_none_is_refused(refused, tmp_path):
    assert "Expected a folder" in refused("start", tmp_path / "none", "--no-browser")
