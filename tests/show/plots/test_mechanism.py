"""The mechanism drawn at a trigger: true positions and direction of motion."""

import numpy as np
import numpy.testing as npt
from scenes import film as scene
from scenes.motion import DISC, film_of, slider_film, static_film

from erlif.show.plots import draw_mechanism


def test_rocker_has_the_angle_of_the_scene(film):
    """The rocker angle is counted from the ground link at the pivot of the rocker."""
    view = draw_mechanism(film, trigger=2)
    x, y = view.links.get_data()
    angle = np.degrees(np.arctan2(y[2] - y[3], x[3] - x[2]))
    npt.assert_allclose(angle, scene.INNER_ANGLE + film.encoder_angle.values[2], atol=0.01)


def test_arrow_points_where_the_joint_moves(film):
    """A rising rocker angle takes the rocker pin away from the crank."""
    view = draw_mechanism(film, trigger=0)
    for trigger, speed in enumerate(scene.rocker_speed(scene.CRANK)):
        view.show(trigger)
        assert np.sign(view.arrow.U[0]) == np.sign(speed)


def test_slider_and_disc_are_drawn_simply_and_a_film_at_rest_not():
    slider = draw_mechanism(slider_film(), trigger=0)
    npt.assert_allclose(slider.links.get_xdata(), 5e-3 * np.sin(np.radians(20)))
    disc = draw_mechanism(film_of(DISC), trigger=0)
    npt.assert_allclose(np.hypot(*np.array(disc.links.get_data())), [0, 0.02], atol=1e-12)
    assert draw_mechanism(static_film(), trigger=0) is None


def test_slider_of_a_slider_crank_is_at_the_end_of_its_coupler():
    links = {"kind": "slider-crank", "crank": "5 cm", "coupler": "20 cm", "crank_speed": "60 rpm"}
    view = draw_mechanism(film_of(links, crank_angle=np.full(6, 40.0)), trigger=0)
    x, y = view.links.get_data()
    turned = np.radians(40)
    slider = 0.05 * np.cos(turned) + np.sqrt(0.2**2 - (0.05 * np.sin(turned)) ** 2)
    npt.assert_allclose(x, [0, 0.05 * np.cos(turned), slider], atol=1e-12)
    npt.assert_allclose(y, [0, 0.05 * np.sin(turned), 0], atol=1e-12)
