"""Finished products to what people look at: figures, pages, the viewer, notebooks."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submodules=["notebook", "plots", "report"]
)
