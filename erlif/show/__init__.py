"""Finished products to what people look at: figures, pages, the viewer, notebooks."""
