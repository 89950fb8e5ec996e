"""Layers and their colours."""

from erlif.show.view.layers import DIFFERENCE, LAYERS, palette


def test_differences_have_colours_about_zero():
    assert [layer.name for layer in LAYERS.values() if layer.palette == "vik"] == ["residual"]
    colours = palette(DIFFERENCE.palette)
    middle = [int(colours[6 * 128 + n : 6 * 128 + n + 2], 16) for n in (0, 2, 4)]
    assert min(middle) > 200  # light at zero
