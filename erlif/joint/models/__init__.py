"""Theory of the joint on a desk and in a test log: SI numbers in, SI numbers out.

The functions take and refuse arguments as those of `erlif.models` do.

>>> import erlif.joint
>>> round(erlif.joint.models.friction.STEADY_WEAR_TORQUE_RATIO, 3)
1.273
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
