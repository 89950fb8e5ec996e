"""Access to the viewer: only by the page opened with the token, on this machine."""

from __future__ import annotations

import hmac
import secrets
from dataclasses import dataclass, field

from erlif.core.tables import read_table

_NAMES = ("127.0.0.1", "localhost")  # of this machine, under which the viewer is reached

# Headers of everything that is sent.
HEADERS: dict[str, str] = read_table("erlif.show.view", "page.toml")["headers"]


@dataclass(frozen=True)
class AccessRule:
    """The conditions under which a request is served.

    Attributes
    ----------
    port : int
        Port at which the viewer listens.
    token : str
        Secret that every path of the page begins with.

    Examples
    --------
    >>> access = AccessRule(8000, token="secret")
    >>> access.address
    'http://127.0.0.1:8000/secret/'
    >>> access.refusal("/secret/films", {"Host": "127.0.0.1:8000"})
    ''
    >>> access.refusal("/guess/films", {"Host": "127.0.0.1:8000"})
    'the token is wrong'
    """

    port: int
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24), repr=False)

    @property
    def address(self) -> str:
        """Address of the page."""
        return f"http://{_NAMES[0]}:{self.port}/{self.token}/"

    def refusal(self, path: str, headers: dict[str, str]) -> str:
        """Find the reason not to serve a request.

        A page of another origin may send requests to this machine, and a name server may give it
        the address of this machine under its own name; neither knows the token.

        Parameters
        ----------
        path : str
            Path of the request.
        headers : dict of str to str
            Its headers, by the names "Host", "Origin", "Sec-Fetch-Site", "Sec-Fetch-Mode",
            "Sec-Fetch-Dest" and "Upgrade".

        Returns
        -------
        str
            Empty where the request is served.
        """
        hosts = {f"{name}:{self.port}" for name in _NAMES}
        if headers.get("Host", "") not in hosts:
            return "the host is not this machine"
        if headers.get("Origin", "") not in {"", *(f"http://{host}" for host in hosts)}:
            return "the origin is another page"
        # the file that opens the viewer is another page; it may lead here, and not load anything
        leads = headers.get("Sec-Fetch-Mode") == "navigate"
        leads = leads and headers.get("Sec-Fetch-Dest") == "document" and path.count("/") == 2
        leads = leads and path.endswith("/")
        if headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin") and not leads:
            return "the request comes from another page"
        if "Upgrade" in headers:
            return "there is no websocket"

        given = path.split("/", 2)[1] if path.startswith("/") else ""
        if not hmac.compare_digest(given.encode(), self.token.encode()):
            return "the token is wrong"
        return ""
