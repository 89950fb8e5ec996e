"""``erlif view``."""

import webbrowser

from erlif.view import serving


def test_a_missing_film_is_refused(refused, tmp_path):
    message = refused("view", tmp_path / "film.nc")
    assert message.startswith("Expected a film file;")


def test_a_missing_package_is_one_message(refused, tmp_path, monkeypatch):
    monkeypatch.setattr(serving, "find_spec", lambda name: None)
    message = refused("view", tmp_path / "film.nc")
    assert 'pip install "erlif[view]"' in message


def test_the_browser_is_opened_with_the_address(command, film, monkeypatch):
    """The real server, interrupted as soon as its address is known."""
    opened = []

    def interrupt(address):
        opened.append(address)
        raise KeyboardInterrupt

    monkeypatch.setattr(webbrowser, "open", interrupt)
    result = command("view", film)
    assert opened[0].startswith("http://127.0.0.1:")
    assert opened[0] in result.output
    assert result.output.endswith("The viewer has ended.\n")
