"""Readers of the files that cameras write."""

from erlif.io.readers.base import Format, FrameFile, FrameKind
from erlif.io.readers.registry import borrow_frames, open_frames

__all__ = ["Format", "FrameFile", "FrameKind", "borrow_frames", "open_frames"]
