"""The version of erlif, in this one place: packaging, results and documentation read it here."""

__version__ = "0.1.0"
