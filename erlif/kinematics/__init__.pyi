from .clock import ClockOffset, find_clock_offset
from .encoder import Encoder, Mechanism, choose_link, read_link_angle
from .folding import fold_frames
from .locate import encoder_notes, entrained_stroke, joint_speed, locate_frames
from .motion import Sinusoid, TurningDisc, locate_logged, locate_rotation, locate_slider

__all__ = [
    "ClockOffset",
    "Encoder",
    "Mechanism",
    "Sinusoid",
    "TurningDisc",
    "choose_link",
    "encoder_notes",
    "entrained_stroke",
    "find_clock_offset",
    "fold_frames",
    "joint_speed",
    "locate_frames",
    "locate_logged",
    "locate_rotation",
    "locate_slider",
    "read_link_angle",
]
