"""What a map of the viewer can show: title, unit and colours of each layer."""

from __future__ import annotations

from dataclasses import dataclass

import cmap
import numpy as np

_COLOURS = 256
"""Colours of a palette."""


@dataclass(frozen=True)
class Layer:
    """One of the quantities that a map can show.

    Attributes
    ----------
    name : str
        Name in addresses.
    title : str
        Name on the page.
    unit : str
        Unit of the values.
    palette : str
        Colour map after Crameri (2018), or grey.
    stored : bool
        Whether the film holds it; the others are computed again from the run.
    """

    name: str
    title: str
    unit: str
    palette: str
    stored: bool = True


LAYERS = {
    layer.name: layer
    for layer in (
        Layer("thickness", "film thickness", "µm", "batlow"),
        Layer("thickness_std", "standard deviation, random", "µm", "lapaz"),
        Layer("thickness_std_shared", "standard deviation, shared", "µm", "lapaz"),
        Layer("log_ratio", "logarithm of the ratio", "1", "batlow", stored=False),
        Layer("camera1", "light of camera 1", "DN", "gray", stored=False),
        Layer("camera2", "light of camera 2", "DN", "gray", stored=False),
    )
}
"""Layers by their names, in the order of the page."""

DIFFERENCE = Layer("difference", "difference, second − first", "µm", "vik")
"""Second map of film thickness less the first."""

SIGNIFICANCE = Layer(
    "significance", "second − first over its random standard deviation", "1", "vik"
)
"""The same in standard deviations of single pixels."""


def palette(name: str) -> str:
    """Colours of a colour map in six hexadecimal digits each.

    Parameters
    ----------
    name : str
        A colour map that the package cmap knows.

    Returns
    -------
    str
        256 colours from the lowest value to the highest.

    Examples
    --------
    >>> palette("gray")[:6], palette("gray")[-6:], len(palette("batlow"))
    ('000000', 'ffffff', 1536)
    """
    colours = np.asarray(cmap.Colormap(name)(np.linspace(0, 1, _COLOURS)))[:, :3]
    return "".join(f"{part:02x}" for part in np.rint(255 * colours).astype(int).ravel().tolist())
