"""The film that theory predicts for an oscillating joint, at every frame and trigger."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
