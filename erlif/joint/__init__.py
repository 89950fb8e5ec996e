"""The joint on a desk and in a test log: models, sizing, friction, endurance, their figures.

Nothing of the film imports it (docs/architecture.md).
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
