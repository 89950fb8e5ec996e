"""Figures that cannot be drawn are refused, and the message names what is missing."""

import pytest
from scenes import film as scene
from scenes.motion import static_film

from erlif import compare
from erlif.core.errors import ErlifError
from erlif.show import plots

FILM = plots.example_film()
BARE = FILM.drop_vars([name for name in FILM if str(name).startswith("film_predicted")])
PLACELESS = FILM.drop_vars("pin_displacement")
PRESSURE = plots.example_pressure()
UNKNOWN = PRESSURE.assign(peak_pressure=float("nan") * PRESSURE.peak_pressure)


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda: plots.thickness_map(FILM, trigger=-1), "from 0 to 5"),
        (lambda: plots.prediction_map_figure(FILM, trigger=6), "a trigger from 0 to 5"),
        (lambda: plots.film_and_prediction(BARE), "prediction; this one has none"),
        (lambda: plots.predicted_map(BARE, trigger=0), "prediction; this one has none"),
        (
            lambda: plots.film_over_run(BARE, plots.example_frames()),
            "prediction; this one has none",
        ),
        (lambda: plots.pressure_map(PRESSURE, trigger=3), "Expected a trigger from 0 to 2"),
        (lambda: plots.pressure_figure(UNKNOWN), r"known at no trigger\. made by formula"),
        (lambda: plots.pin_orbit(PLACELESS), r"\[joint\]"),
        (lambda: plots.closest_film(scene.without_valid_pixels(FILM)), r"\[joint\]"),
        (lambda: plots.gap_curvature(FILM.isel(trigger=[0])), r"\[joint\]"),
        (lambda: plots.speed_against_angle(static_film()), "with a speed"),
        (lambda: plots.kinematics.linkage_cycle(static_film()), "no linkage"),
        (lambda: plots.control_chart_of(compare([FILM, FILM]), "patch"), "chart of the patch"),
        (
            lambda: plots.film_against_duty(compare([FILM, FILM]).drop_vars("duty")),
            "speed and load",
        ),
        (lambda: plots.cycle_movie(FILM, "a.avi"), ".gif or .mp4"),
        (lambda: plots.cycle_movie(FILM, "c.gif", frames_per_second=0), "0.1 to 60"),
    ],
)
def test_a_figure_that_cannot_be_drawn_is_refused(draw, message):
    with pytest.raises(ErlifError, match=message):
        draw()
