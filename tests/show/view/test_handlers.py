"""Requests over the wire: what is refused, and what never leaves."""

import http.client
import json
import socket

import pytest

from erlif.show.view import handlers
from erlif.show.view.access import HEADERS
from erlif.show.view.handlers import FILES


@pytest.fixture(scope="module")
def access(serve, example_path):
    return serve(example_path)


@pytest.fixture
def send(access):
    """A request with the right token and host, or others; gives status, headers and body."""

    def request(path, *, method="GET", token=None, headers=None, body=None):
        connection = http.client.HTTPConnection("127.0.0.1", access.port, timeout=10)
        try:
            connection.request(
                method, f"/{token or access.token}/{path}", body=body, headers=headers or {}
            )
            response = connection.getresponse()
            return response.status, dict(response.getheaders()), response.read()
        finally:
            connection.close()

    return request


def test_the_page_comes_with_headers_that_keep_it_here_and_names_no_other_place(send):
    for name in FILES:
        status, headers, body = send(name)
        assert status == 200
        assert body
        assert HEADERS.items() <= headers.items()
        assert "Access-Control-Allow-Origin" not in headers
        assert name.startswith("uPlot") or b"//" not in body.replace(b"// ", b"")


def test_the_rule_of_access_holds_for_every_path(send):
    websocket = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13"}
    wrong = [{"token": "wrong"}, {"token": "%00"}, {"headers": websocket}]
    wrong += [{"headers": {"Host": "evil.example"}}, {"headers": {"Sec-Fetch-Site": "cross-site"}}]
    for request in wrong:
        for method, path in (("GET", "films"), ("POST", "settings"), ("GET", ""), ("GET", "none")):
            status, _, body = send(path, method=method, body="{}", **request)
            assert status == 403
            assert b"example film" not in body


def test_no_other_file_is_served(send):
    for path in (
        *("../films.py", "..%2fhandlers.py", "%2e%2e/%2e%2e/pyproject.toml", "index.html"),
        *("page/index.html", "/etc/passwd", "%2fetc%2fpasswd", "view.js/", "uPlot.LICENSE"),
    ):
        status, _, body = send(path)
        assert status in (403, 404)
        assert b"import" not in body
        assert b"root:" not in body


def test_bad_values_are_refused_in_a_sentence_and_not_logged(send, caplog):
    status, _, body = send("map?film=7&trigger=0&layer=thickness&window=0,0,1,1&room=9,9")
    assert status == 400
    assert "Expected a film from 0 to 0" in json.loads(body)["message"]
    assert not caplog.records


def test_a_defect_shows_nothing_of_this_machine_and_is_logged_without_the_token(
    send, access, monkeypatch, caplog
):
    def fail(request):
        raise RuntimeError("/home/secret")

    monkeypatch.setitem(handlers.READING, "films", fail)
    for _ in range(3):  # the page asks again and again
        status, _, body = send("films")
    assert len(caplog.records) == 1
    assert status == 500
    assert b"secret" not in body
    assert b"Traceback" not in body
    assert "RuntimeError" in caplog.text
    assert access.token not in caplog.text


def test_methods_and_queries_that_are_not_served_are_no_defects(send, caplog):
    for method in ("PUT", "DELETE", "HEAD", "OPTIONS", "PATCH", "TRACE", "NONE", "POST"):
        for path in ("films", "none", "view.js", ""):
            status, _, body = send(path, method=method)
            assert 400 <= status < 500
            assert b"defect" not in body
    for path in ("films?a=%ff", "map?film=%00", "settings", "none"):
        status, _, body = send(path)
        assert 400 <= status < 500
        assert b"defect" not in body
    for body in ("[" * 60_000, '{"region": {}}', '{"film": 0, "region": [1e999, 1, 1, 1]}'):
        assert send("settings", method="POST", body=body)[0] == 400
    assert not caplog.records


def test_a_large_body_is_refused(send):
    try:
        status = send("settings", method="POST", body="x" * 2**17)[0]
    except OSError:  # the connection is closed while the body is sent
        status = 400
    assert status == 400


def test_the_viewer_listens_on_the_loopback_alone(access):
    """The address of this machine on its network is found without sending a packet."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("10.255.255.255", 1))
        except OSError:
            pytest.skip("this machine has no network address")
        address = probe.getsockname()[0]
    if address.startswith("127."):
        pytest.skip("this machine has no network address")
    with pytest.raises(OSError, match=r"."):
        socket.create_connection((address, access.port), 2)
