"""Transient Reynolds equation with mass-conserving cavitation: the film of an oscillating joint."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
