"""The band of the predicted film, against pure squeeze of an infinitely long joint.

A pin at rest sinks as eps / sqrt(1 - eps^2) = first + t W / K, K = 12 pi eta L R^3 / c^2.
"""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import xarray as xr
from scipy.optimize import least_squares

from erlif.core.errors import ModelError
from erlif.models.reynolds import Journal, Motion
from erlif.prediction import FrameMotion, GivenErrors, ImageLine, find_band, predict_triggers

LOAD, CLEARANCE = 222.4, 230e-6
JOINT = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
GIVEN = GivenErrors(viscosity=0.04, load=0.02, clearance=3e-6)
STEPS = np.arange(10, 201, 10)
VIEW = ImageLine(np.linspace(-0.01, 0.01, 501), slice(501))


def at_rest(load=LOAD):
    time = np.linspace(0.0, 4.0, 201)
    return FrameMotion(Motion(time, 0 * time, load), STEPS, time, 0.12)


def sunken(start, *, viscosity=0.12, load=LOAD, clearance=CLEARANCE):
    """Films of the frames by the closed form. [um]"""
    first = (eccentric := 1 - start / clearance) / np.sqrt(1 - eccentric**2)
    stiffness = 12 * np.pi * viscosity * 0.237 * np.sqrt(0.03336 * 0.03359) ** 3 / clearance**2
    ratio = first + at_rest().motion.time[STEPS] * load / stiffness
    return 1e6 * clearance * (1 - ratio / np.hypot(1, ratio))


def spread(follow):
    """Root of the sum of squares of what one standard deviation of each input changes."""
    ends = ({"viscosity": 0.12 * 0.04}, {"load": LOAD * 0.02}, {"clearance": 3e-6})
    given = {"viscosity": 0.12, "load": LOAD, "clearance": CLEARANCE}
    off = [
        [
            follow(**{name: given[name] + sign * std for name, std in one.items()})
            for sign in (1, -1)
        ]
        for one in ends
    ]
    return np.sqrt(sum(((high - low) / 2) ** 2 for high, low in off))


def predict(film=None, **options):
    film = xr.Dataset() if film is None else film
    trigger = np.arange(STEPS.size)
    return predict_triggers(film, JOINT, at_rest(), trigger=trigger, view=VIEW, **options)


def test_a_given_start_film_leaves_the_whole_errors():
    found = predict(start_film=60e-6, given=GIVEN)
    expected = spread(lambda **given: sunken(60e-6, **given))
    npt.assert_allclose(found.film_predicted_min_std, expected, rtol=0.02, atol=1e-3)
    npt.assert_array_equal(found.film_predicted_min_std_frame, found.film_predicted_min_std)
    assert "film_predicted_min_std" not in predict(start_film=60e-6)


def test_a_fitted_start_film_takes_up_its_part():
    measured = sunken(60e-6)
    std = 0.01 * measured
    columns = {"film_min": ("trigger", measured), "film_min_std": ("trigger", std)}

    def refitted(**given):
        def off(start):
            return np.log(sunken(1e-6 * start[0], **given) / measured)

        return sunken(1e-6 * least_squares(off, [60.0], x_scale=[60.0]).x[0], **given)

    found, kept = predict(xr.Dataset(columns), given=GIVEN), predict(start_film=60e-6, given=GIVEN)
    npt.assert_allclose(found.film_predicted_min_std, spread(refitted), rtol=0.03, atol=0.01)
    relative = [
        (one.film_predicted_min_std / one.film_predicted_min).values for one in (found, kept)
    ]
    assert np.mean(relative[0] ** 2) < np.mean(relative[1] ** 2) / 2


def test_the_load_of_a_film_with_cavities_has_a_film_of_its_own():
    """Half the difference of two films with the load a standard deviation up and down.

    By the similarity of a full film, the error would be twice as large.
    """
    time = np.linspace(0.0, 1.0, 101)
    swing = Motion(time, 0.2 * np.sin(4 * np.pi * time), LOAD)
    moved, joint = FrameMotion(swing, STEPS[:10], time, 0.12), replace(JOINT, long=False)
    options = {"trigger": np.arange(10), "view": VIEW, "sideways": "guided", "start_film": 30e-6}

    def film(load, **more):
        one = replace(moved, motion=replace(swing, load=load + 0 * time))
        return predict_triggers(xr.Dataset(), joint, one, cells=(128, 4), **options, **more)

    low, high = (film(LOAD * (1 + part)).film_predicted_min for part in (-0.02, 0.02))
    found = film(LOAD, given=GivenErrors(load=0.02)).film_predicted_min_std
    npt.assert_allclose(found, abs(high - low) / 2, rtol=0.05, atol=1e-3)
    assert found.max() > 0.1


def test_a_changed_film_that_cannot_be_followed_leaves_the_prediction():
    def minima(start, clearance=1.0, **times):
        if clearance != 1:
            raise ModelError("no film carries the load")
        return np.full(3, start)

    assert np.isnan(find_band(minima, 5e-6, GIVEN, clearance=CLEARANCE, full=True)).all()
