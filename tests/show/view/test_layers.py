"""Layers and their colours."""

from erlif.show.view.layers import DIFFERENCE, LAYERS, palette


def test_stored_layers_are_variables_of_a_film():
    stored = [layer.name for layer in LAYERS.values() if layer.stored]
    assert stored == ["thickness", "thickness_std", "thickness_std_shared"]
    colours = palette(DIFFERENCE.palette)
    middle = [int(colours[6 * 128 + n : 6 * 128 + n + 2], 16) for n in (0, 2, 4)]
    assert min(middle) > 200  # light at zero
