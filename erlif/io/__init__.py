"""Directories, files and formats: what erlif reads and writes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submodules=["conversion", "files", "ingest", "readers", "settings"]
)
