"""Endurance tests of bearings: log to friction, stages, onset of galling and load at failure."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
