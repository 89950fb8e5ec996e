"""Readers of the files that cameras write."""

from erlif.readers.base import Format, FrameFile, FrameKind

__all__ = ["Format", "FrameFile", "FrameKind"]
