"""Maps of the predicted film: the gap of two circles, from a run and from its film."""

import numpy as np
import numpy.testing as npt
import pytest

import erlif
from erlif.core.errors import ErlifError
from erlif.io.files import open_netcdf


@pytest.fixture(scope="module")
def prediction(film):
    return erlif.predict(film)


def test_a_map_is_the_gap_of_circles_at_the_predicted_position(prediction):
    """c - e cos(phi - attitude), written out."""
    x = 1e-3 * (prediction.x.values - prediction.attitude.attrs["load_line"])
    angle = x / np.sqrt(0.03336 * 0.03359)
    for k in range(6):
        one = prediction.isel(trigger=k)
        turned = angle - np.radians(float(one.attitude))
        expected = 230 * (1 - float(one.eccentricity) * np.cos(turned))
        assert one.film_predicted.shape == (96, 128)
        npt.assert_allclose(one.film_predicted, np.broadcast_to(expected, (96, 128)), rtol=1e-4)


def test_the_prediction_of_a_film_is_the_one_that_it_holds(prediction, film):
    with erlif.open_film(film) as measured:
        npt.assert_allclose(prediction.film_predicted_min, measured.film_predicted_min, rtol=1e-12)
        npt.assert_array_equal(prediction.film_min, measured.film_min)


def test_a_run_is_predicted_with_its_present_settings(lab, film, prediction):
    lab.film.write_bytes(film.read_bytes())
    npt.assert_array_equal(erlif.predict(lab.run).film_predicted, prediction.film_predicted)

    lab.edit("run/run.toml", ("[joint]", '[prediction]\nsideways = "guided"\n[joint]'))
    guided = erlif.predict(lab.run)
    npt.assert_allclose(guided.attitude, 0.0, atol=1e-9)
    assert guided.attrs["model"] == "transient Reynolds, pin guided"


def test_a_start_film_of_the_settings_needs_no_film(lab):
    with pytest.raises(ErlifError, match=r"Expected film.nc in .* or give start_film"):
        erlif.predict(lab.run)
    lab.edit("run/run.toml", ("[joint]", '[prediction]\nstart_film = "20 um"\n[joint]'))
    found = erlif.predict(lab.run)
    assert float(found.film_predicted_min[0]) == pytest.approx(20.0)
    assert "film_min" not in found


def test_frames_of_several_cycles_keep_their_own_film(two_cycles, tmp_path):
    """The pin sinks, so that the second cycle is thinner, and the trigger is the mean of both."""
    settings = (two_cycles.run / "run.toml").read_text(encoding="utf-8")
    run = tmp_path / "run"
    run.mkdir()
    for path in two_cycles.run.iterdir():
        if path.name != "run.toml":
            (run / path.name).symlink_to(path)
    options = '[prediction]\nstart_film = "20 um"\n[joint]'
    (run / "run.toml").write_text(settings.replace("[joint]", options, 1), encoding="utf-8")
    erlif.predict(run, output=tmp_path / "prediction.nc", allow_outside=True).close()
    with open_netcdf(tmp_path / "prediction.nc") as triggers:
        mean = triggers.film_predicted_min.values
    with open_netcdf(tmp_path / "prediction.nc", group="frames") as frames:
        each = frames.load()
    first, second = (each.film_predicted_min.values[each["cycle"] == k] for k in (0, 1))
    assert (second < first).all()
    npt.assert_allclose(mean, (first + second) / 2, rtol=1e-3)
    turned = each.elapsed_cycles.values
    npt.assert_allclose(turned[each["cycle"] == 1] - turned[each["cycle"] == 0], 1.0, atol=0.02)


def test_an_interrupted_prediction_is_resumed_with_the_same_bytes(film, tmp_path):
    whole, cut = tmp_path / "whole.nc", tmp_path / "cut.nc"
    erlif.predict(film, output=whole).close()

    def stop(work, done, total):
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        erlif.predict(film, output=cut, progress=stop)
    assert not cut.exists()
    erlif.predict(film, output=cut).close()
    assert cut.read_bytes() == whole.read_bytes()
