"""Position and speed of a linkage at every frame, from the encoder log."""

from erlif.kinematics.encoder import Encoder, Mechanism, read_link_angle
from erlif.kinematics.folding import fold_frames
from erlif.kinematics.locate import encoder_notes, entrained_stroke, locate_frames

__all__ = [
    "Encoder",
    "Mechanism",
    "encoder_notes",
    "entrained_stroke",
    "fold_frames",
    "locate_frames",
    "read_link_angle",
]
