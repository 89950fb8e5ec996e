"""A film or a calibration for its reader: one page with a viewer, or a few lines of text."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
