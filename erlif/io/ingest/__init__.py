"""A directory to counts: recordings, image formats, pairing of the cameras, the encoder log."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
