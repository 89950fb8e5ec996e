"""Log ratio to film thickness, and the range in which it is measurable."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
