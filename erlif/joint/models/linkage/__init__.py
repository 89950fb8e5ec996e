"""Design of a crank-rocker: links for a wanted motion, what the motion costs, what the links bear.

After Farzaneh (2002), appendix A. Lengths are distances of joint centres in m, angles in rad,
counted as in `erlif.models.mechanism.CrankRocker`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
