"""Light of two cameras to the logarithm of their ratio, with its variance."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
