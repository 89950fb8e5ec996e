from .base import Format, FrameFile, FrameKind
from .registry import borrow_frames, open_frames

__all__ = ["Format", "FrameFile", "FrameKind", "borrow_frames", "open_frames"]
