"""Pressure at the edges and lobes of a bearing, bodies elastic, without friction."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
