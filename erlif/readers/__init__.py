"""Readers of the files that cameras write."""

from erlif.readers.base import Format, FrameFile, FrameKind
from erlif.readers.registry import borrow_frames, open_frames

__all__ = ["Format", "FrameFile", "FrameKind", "borrow_frames", "open_frames"]
