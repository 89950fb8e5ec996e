"""Friction of bearings from logs of load and torque: over a test, and from reversals."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
