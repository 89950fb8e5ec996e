"""run.toml, fixture.toml and plan.toml as frozen, checked tables with descriptions."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
