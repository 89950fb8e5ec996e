"""The ratio of a film of known thickness: fit, file and inverse.

A fixture whose gap a coordinate measuring machine (CMM) has measured gives thickness and ratio
side by side. The reabsorption model of `erlif.models.fluorescence` is fitted to them with errors
in both, because the CMM's is usually the larger one: orthogonal distance regression, each CMM
point counted once. The pose of the fixture is refined with it where the profile has form. A
spline is added to the model where the residuals require one. Two calibrations can be compared.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
