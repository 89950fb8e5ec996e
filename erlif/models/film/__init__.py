"""Film formulas for line and elliptical contacts, the regime maps and the film parameter."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
