"""Engines that compute the triggers: threads of this process, or workers of dask."""
