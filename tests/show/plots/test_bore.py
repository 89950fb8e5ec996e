"""The film along the axis of a bore with edges."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif import plots
from erlif.core.errors import ConfigError
from erlif.io.files import settings_of


@pytest.fixture
def edged():
    """The example film with a minimum in its middle, in a joint whose ends are in the image."""
    film = plots.example_film()
    middle = {f"film_min_{axis}": film.sizes[axis] / 2 for axis in "xy"}
    film = film.assign(
        {k: ("trigger", np.full(film.sizes["trigger"], v)) for k, v in middle.items()}
    )
    length = float(film.y[-1])
    bore = f'[joint.bore]\nedge_length = "{length / 4} mm"\nedge_depth = "2 um"\n'
    text = film.attrs["settings"].replace('length = "237 mm"', f'length = "{length} mm"')
    return film.assign_attrs(settings=text + bore)


def test_bore_and_film_are_drawn_against_the_axial_place(edged):
    assert settings_of(edged).joint.bore is not None
    measured, _, _, _, bore, predicted = plots.film_along_axis(edged, trigger=2)
    npt.assert_array_equal(measured.get_xdata(), edged.y)
    height = bore.get_ydata() - edged.film_min.values[2]  # a minimum of the straight part
    y = edged.y.values - edged.y.values[-1] / 2
    share = (np.abs(y) - 0.25 * edged.y.values[-1]) / (0.25 * edged.y.values[-1])
    npt.assert_allclose(height, 2 * np.maximum(share, 0) ** 2, atol=1e-3)
    npt.assert_allclose(predicted.get_ydata() - predicted.get_ydata().min(), height, atol=1e-3)
    assert measured.axes.get_xlabel() == "y (axial) [mm]"


def test_a_straight_bore_has_no_such_figure():
    with pytest.raises(ConfigError, match="the bore is straight"):
        plots.film_along_axis(plots.example_film(), trigger=1)
