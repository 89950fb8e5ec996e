"""Designs and linkages for their reader: a page, a table, or a few lines of text."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
