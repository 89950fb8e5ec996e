"""Deflate, the compression of TIFF strips and LaVision images, with a bound on what comes out."""

from __future__ import annotations

from erlif.core.errors import FrameError

try:
    from isal import isal_zlib as inflater
except ImportError:  # a machine for which there is no isal: the same bytes in twice the time
    import zlib as inflater  # type: ignore[no-redef]


def inflate(data: bytes | memoryview, most: int) -> bytes:
    """Expand a stream of deflate.

    A damaged stream may expand to a thousand times its size, so that the caller states how much of
    it is of use.

    Parameters
    ----------
    data : bytes
        The stream with its header and checksum, as zlib writes it.
    most : int
        Bytes after which the rest is ignored.

    Returns
    -------
    bytes
        Fewer than `most` where the stream ends before; its checksum is then verified.

    Raises
    ------
    FrameError
        With the bare reason, if the stream is damaged or cut.

    Examples
    --------
    >>> import zlib
    >>> inflate(zlib.compress(bytes(1_000_000)), 3)
    b'\\x00\\x00\\x00'
    """
    expander = inflater.decompressobj()
    try:
        found = bytes(expander.decompress(data, most))
    except Exception as error:  # isal does not declare the type of its own
        raise FrameError(f"deflate: {error}") from error
    if len(found) < most and not expander.eof:
        raise FrameError("deflate: the stream was cut")
    return found
