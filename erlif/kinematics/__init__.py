"""Position and speed at every frame, from the encoder log: of a linkage, a disc or a slider."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
