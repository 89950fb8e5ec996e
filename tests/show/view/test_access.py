"""Who is refused."""

import pytest

from erlif.show.view.access import AccessRule

DOOR = AccessRule(4321, token="right")
HOST = {"Host": "127.0.0.1:4321"}


LED = HOST | {
    "Sec-Fetch-Site": "cross-site",
    "Sec-Fetch-Mode": "navigate",
    "Sec-Fetch-Dest": "document",
}


def test_the_page_itself_is_served_and_a_file_may_lead_to_it():
    own = {"Origin": "http://127.0.0.1:4321", "Sec-Fetch-Site": "same-origin"}
    for headers in (HOST, {"Host": "localhost:4321"}, HOST | own):
        assert DOOR.refusal("/right/map", headers) == ""
    assert DOOR.refusal("/right/", LED) == ""


@pytest.mark.parametrize(
    ("path", "headers"),
    [
        *((path, HOST) for path in ("/wrong/map", "/", "", "/righ", "/rightt/", "//right/")),
        *((path, LED) for path in ("/wrong/", "/right/map")),
        ("/right\u00e4/", HOST),
        ("/right/", LED | {"Sec-Fetch-Dest": "iframe"}),
        ("/right/", LED | {"Sec-Fetch-Mode": "no-cors"}),
        ("/right/", {}),
        *(
            ("/right/", {"Host": host})
            for host in ("evil.example:4321", "127.0.0.1:80", "127.0.0.1")
        ),
        *(
            ("/right/", HOST | {"Origin": origin})
            for origin in (
                *("http://evil.example", "http://127.0.0.1:4322"),
                *("https://127.0.0.1:4321", "null"),
            )
        ),
        *(("/right/", HOST | {"Sec-Fetch-Site": site}) for site in ("cross-site", "same-site")),
        ("/right/", HOST | {"Upgrade": "websocket"}),
    ],
)
def test_all_others_are_refused(path, headers):
    assert DOOR.refusal(path, headers)


def test_every_viewer_has_another_token_which_its_text_does_not_show():
    one, other = AccessRule(1), AccessRule(1)
    assert one.token != other.token
    assert len(one.token) >= 32
    assert one.token not in repr(one)
