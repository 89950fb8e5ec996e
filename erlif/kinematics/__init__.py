"""Position and speed of a linkage at every frame, from the encoder log."""

from erlif.kinematics.clock import ClockOffset, find_clock_offset
from erlif.kinematics.encoder import Encoder, Mechanism, read_link_angle
from erlif.kinematics.folding import fold_frames
from erlif.kinematics.locate import encoder_notes, entrained_stroke, locate_frames

__all__ = [
    "ClockOffset",
    "Encoder",
    "Mechanism",
    "encoder_notes",
    "entrained_stroke",
    "find_clock_offset",
    "fold_frames",
    "locate_frames",
    "read_link_angle",
]
