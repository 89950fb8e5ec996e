"""The movie of a cycle: its frames, its order, its files."""

import stat
import sys

import numpy as np
import numpy.testing as npt
import pytest
from PIL import Image
from scenes import film as scene
from scenes.motion import slider_film, static_film
from scenes.pictures import picture, without_texts

from erlif.core.errors import OutputError
from erlif.show import plots
from erlif.show.plots.movie import MOST_FRAMES, order_of_cycle


def test_frame_shows_the_trigger(film):
    view = plots.cycle_view(film, trigger=1)
    view.show(4)
    npt.assert_array_equal(np.ma.filled(view.image.get_array(), np.nan), film.thickness.values[4])
    assert view.image.axes.get_title().startswith("trigger 4, ")
    assert view.marker.get_xdata() == [film.crank_angle.values[4]] * 2


@pytest.mark.parametrize("make", [slider_film, static_film])
def test_other_motions_have_a_frame(make):
    view = plots.cycle_view(make(), trigger=0)
    assert (view.mechanism is None) == (make is static_film)
    view.show(1)


def test_long_cycles_are_thinned_and_the_frames_state_it(film):
    many = film.isel(trigger=np.resize(np.arange(scene.TRIGGERS), 90), x=slice(0, 8), y=slice(0, 6))
    assert len(order_of_cycle(many)) == MOST_FRAMES
    figure = plots.cycle_view(many, trigger=0).figure
    assert figure.get_suptitle().endswith("; 60 of 90 triggers")


def test_gif_has_a_frame_for_each_trigger_and_is_the_same_twice(film, tmp_path):
    seen = []
    film = film.isel(trigger=[0, 3])
    one = plots.cycle_movie(
        film, tmp_path / "a.gif", frames_per_second=5, progress=lambda *step: seen.append(step)
    )
    two = plots.cycle_movie(film, tmp_path / "b.gif", frames_per_second=5)
    assert one.read_bytes() == two.read_bytes()
    assert seen[-1] == ("movie", 2, 2)
    with Image.open(one) as movie:
        assert (movie.n_frames, movie.width, movie.info["duration"]) == (2, 960, 200)
    with pytest.raises(OutputError, match="--overwrite"):
        plots.cycle_movie(film, tmp_path / "a.gif")


def test_mp4_is_what_ffmpeg_gives(film, tmp_path, monkeypatch):
    """A program in its place states how many bytes of pixels it was given."""
    program = tmp_path / "ffmpeg"
    program.write_text(
        f"#!{sys.executable}\nimport sys\nprint(len(sys.stdin.buffer.read()), *sys.argv[1:])\n"
    )
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(tmp_path))
    text = plots.cycle_movie(film.isel(trigger=[0, 1]), tmp_path / "cycle.mp4").read_text()
    pixels, *options = text.split()
    width, height = map(int, options[options.index("-s") + 1].split("x"))
    assert width % 2 == height % 2 == 0
    assert int(pixels) == 2 * 3 * width * height


def test_ffmpeg_that_is_missing_or_fails_is_one_message(film, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(OutputError, match="ffmpeg for a movie in MP4; it is not installed"):
        plots.cycle_movie(film, tmp_path / "cycle.mp4")
    program = tmp_path / "ffmpeg"
    program.write_text("#!/bin/sh\necho Unknown encoder libx264 >&2\nexit 1\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    with pytest.raises(OutputError, match="Unknown encoder"):
        plots.cycle_movie(film.isel(trigger=[0, 1]), tmp_path / "cycle.mp4")
    assert not (tmp_path / "cycle.mp4").exists()


@picture
def test_frame_of_the_movie(film):
    return without_texts(plots.cycle_view(film, trigger=1).figure)
