"""The version of erlif, in this one place: packaging, results and documentation read it here."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

__version__ = "0.1.0"


@cache
def digest_of_sources() -> str:
    """Digest of the code and tables of erlif, by which two checkouts of one version differ.

    Examples
    --------
    >>> len(digest_of_sources())
    12
    """
    root, digest = Path(__file__).parents[1], hashlib.sha256()
    for path in sorted(root.rglob("*.*")):
        if path.suffix in (".py", ".toml"):
            # line breaks are those of the checkout
            text = path.read_bytes().replace(b"\r\n", b"\n")
            digest.update(path.relative_to(root).as_posix().encode() + b"\0" + text + b"\0")
    return digest.hexdigest()[:12]


def version_and_sources() -> str:
    """Version with the digest of its sources, such as "0.1.0 (sources 3f8a01c29b7d)"."""
    return f"{__version__} (sources {digest_of_sources()})"
