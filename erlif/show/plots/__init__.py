"""Figures of finished products: a film or a calibration and axes in, artists out.

A function that draws one panel takes ``ax``, and makes a figure of one journal column without it.
Functions whose names end in ``_figure`` combine panels; they take ``figure``, an empty figure or
subfigure to draw in, and make a new one without it. ``film`` is a film as `erlif.process` returns
it, and ``trigger`` the number of one of its triggers, counted from 0; `ErlifError` is raised where
the film has no such trigger. matplotlib is used through its objects alone: no function opens a
window or changes a setting of the caller.

A function whose name begins with ``write_`` or ends in ``_movie`` takes the path of the file or
folder. It returns what it has written, and raises `OutputError` where it cannot be written.
"""

import lazy_loader

__getattr__, _list_all, __all__ = lazy_loader.attach_stub(__name__, __file__)

# beginnings of names that draw nothing: examples, names of files, and their saving
_NO_FIGURE = ("example_", "find_", "missing_", "name_", "predicted_map", "save_")


def __dir__() -> list[str]:
    """List the functions that draw, which a notebook completes; the others are importable."""
    return [name for name in _list_all() if not name.startswith(_NO_FIGURE)]
