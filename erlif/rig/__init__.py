"""The virtual rig: a known film, photographed by two virtual cameras.

It shares no code with the stages that measure the film.
"""

import lazy_loader

# the commands import the settings before numpy is loaded
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
