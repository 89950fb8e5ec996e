"""A run seen from outside: audit before, budget after, comparison between runs."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, submodules=["check", "comparison"])
