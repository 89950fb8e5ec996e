"""Four-bar linkages by their four lengths: class, swing, strokes, speed, transmission, space."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
