"""Figures of the joint: designs, linkages, contacts, wear, endurance tests and torque logs.

They take and return what the figures of `erlif.plots` do.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
