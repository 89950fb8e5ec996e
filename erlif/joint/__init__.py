"""The joint on a desk and in a test log: sizing, friction, endurance."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submodules=["endurance", "friction", "models", "rig", "settings", "sizing"]
)
