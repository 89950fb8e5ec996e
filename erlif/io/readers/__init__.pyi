from .base import Format as Format
from .base import FrameFile as FrameFile
from .base import FrameKind as FrameKind
from .registry import borrow_frames as borrow_frames
from .registry import open_frames as open_frames
