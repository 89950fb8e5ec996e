"""The table of refusals of the region, the position of the pin and the theory."""

from erlif.core.errors import ConfigError
from erlif.trend.refusals import refusal


def test_a_refusal_names_the_image_and_the_region():
    error = refusal("small_region", least=32, x=4.0, y=3.1, across=(1, 1.2), down=(0, 3))
    assert type(error) is ConfigError
    assert str(error) == (
        "Expected a region of interest of at least 32 x 32 pixels within the image, x 0 to "
        "4.00 mm and y 0 to 3.10 mm; [thickness] roi is x = [1, 1.2], y = [0, 3]. Correct roi, or "
        "pixel_pitch in [optics]."
    )
