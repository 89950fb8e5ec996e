"""A pin joint as the guide designs it: Strand (2005), chapter 2, from load and motion to sizes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
