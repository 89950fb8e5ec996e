"""Files that erlif writes and reads back: films, unfinished work, replaced outputs."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
