"""Layers of a map in the viewer: title, unit and colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cmap
import numpy as np

from erlif.core.flags import FLAG_COLOURS
from erlif.core.tables import read_table

_COLOURS = 256  # of a palette


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
    """

    name: str
    title: str
    unit: str
    palette: str


_TABLES = read_table("erlif.show.view", "page.toml")

# Layers by their names, in the order of the page.
LAYERS = {name: Layer(name, **row) for name, row in _TABLES["layers"].items()}

# Second map of film thickness less the first, in um and in standard deviations of a pixel.
DIFFERENCE, SIGNIFICANCE = (Layer(name, **row) for name, row in _TABLES["differences"].items())


def palette(name: str) -> str:
    """Colours of a colour map in six hexadecimal digits each.

    Examples
    --------
    >>> palette("gray")[:6], palette("gray")[-6:], len(palette("batlow"))
    ('000000', 'ffffff', 1536)
    """
    colours = np.asarray(cmap.Colormap(name)(np.linspace(0, 1, _COLOURS)))[:, :3]
    return "".join(f"{part:02x}" for part in np.rint(255 * colours).astype(int).ravel().tolist())


def describe_layers(layers: Sequence[Layer]) -> dict[str, Any]:
    """Layers, their palettes, and bit, name and colour of each flag, for the script of a page."""
    return {
        "layers": [vars(layer) for layer in layers],
        "palettes": {layer.palette: palette(layer.palette) for layer in layers},
        "flags": [
            {"bit": int(flag), "name": flag.title, "colour": colour}
            for flag, colour in FLAG_COLOURS.items()
        ],
    }
