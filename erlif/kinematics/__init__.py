"""Position and speed at every frame, from the encoder log: of a linkage, a disc or a slider."""

from erlif.kinematics.clock import ClockOffset, find_clock_offset
from erlif.kinematics.encoder import Encoder, Mechanism, read_link_angle
from erlif.kinematics.folding import fold_frames
from erlif.kinematics.locate import encoder_notes, entrained_stroke, locate_frames
from erlif.kinematics.motion import (
    Rotation,
    Sinusoid,
    locate_logged,
    locate_rotation,
    locate_slider,
)

__all__ = [
    "ClockOffset",
    "Encoder",
    "Mechanism",
    "Rotation",
    "Sinusoid",
    "encoder_notes",
    "entrained_stroke",
    "find_clock_offset",
    "fold_frames",
    "locate_frames",
    "locate_logged",
    "locate_rotation",
    "locate_slider",
    "read_link_angle",
]
