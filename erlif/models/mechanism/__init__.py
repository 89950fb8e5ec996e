"""The linkages that move the joint: encoder angle to position, speed, acceleration and back.

The crank-rocker is the rig of Farzaneh (2002), appendix A.2, the slider-crank that of Mukras et al.
(2008); the positions, their time derivatives and the inverse maps are exact.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
