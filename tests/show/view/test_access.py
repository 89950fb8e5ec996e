"""Who is refused."""

import pytest

from erlif.show.view.access import AccessRule

DOOR = AccessRule(4321, token="right")
HOST = {"Host": "127.0.0.1:4321"}


@pytest.mark.parametrize(
    "headers",
    [
        HOST,
        {"Host": "localhost:4321"},
        {**HOST, "Origin": "http://127.0.0.1:4321", "Sec-Fetch-Site": "same-origin"},
    ],
)
def test_the_page_itself_is_served(headers):
    assert DOOR.refusal("/right/map", headers) == ""


LED = {
    **HOST,
    "Sec-Fetch-Site": "cross-site",
    "Sec-Fetch-Mode": "navigate",
    "Sec-Fetch-Dest": "document",
}


def test_a_file_may_lead_to_the_page():
    assert DOOR.refusal("/right/", LED) == ""


@pytest.mark.parametrize(
    ("path", "headers"),
    [
        ("/wrong/", LED),
        ("/right/map", LED),
        ("/right/", {**LED, "Sec-Fetch-Dest": "iframe"}),
        ("/right/", {**LED, "Sec-Fetch-Mode": "no-cors"}),
        ("/wrong/map", HOST),
        ("/", HOST),
        ("", HOST),
        ("/righ", HOST),
        ("/rightt/", HOST),
        ("/right\u00e4/", HOST),
        ("//right/", HOST),
        ("/right/", {}),
        ("/right/", {"Host": "evil.example:4321"}),
        ("/right/", {"Host": "127.0.0.1:80"}),
        ("/right/", {"Host": "127.0.0.1"}),
        ("/right/", {**HOST, "Origin": "http://evil.example"}),
        ("/right/", {**HOST, "Origin": "http://127.0.0.1:4322"}),
        ("/right/", {**HOST, "Origin": "https://127.0.0.1:4321"}),
        ("/right/", {**HOST, "Origin": "null"}),
        ("/right/", {**HOST, "Sec-Fetch-Site": "cross-site"}),
        ("/right/", {**HOST, "Sec-Fetch-Site": "same-site"}),
        ("/right/", {**HOST, "Upgrade": "websocket"}),
    ],
)
def test_all_others_are_refused(path, headers):
    assert DOOR.refusal(path, headers)


def test_every_viewer_has_another_token_which_its_text_does_not_show():
    one, other = AccessRule(1), AccessRule(1)
    assert one.token != other.token
    assert len(one.token) >= 32
    assert one.token not in repr(one)
