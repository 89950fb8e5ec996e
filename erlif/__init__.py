"""Oil-film thickness maps with honest error bars from two-camera laser-induced fluorescence."""

__version__ = "0.1.0"
