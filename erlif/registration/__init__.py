"""Camera 2 on the pixels of camera 1: the map, the drift of each frame, and the alignment.

`register_frames` finds one map for a run, `estimate_drift` the translation of a frame on top of it,
and `align_frames` samples camera 2 accordingly, with its noise and its flags.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
