"""Who computes the triggers: threads of this process, or the workers of dask."""
