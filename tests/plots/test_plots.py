"""Figures: what is drawn is the data, named with units, and the files do not change with the day."""

from __future__ import annotations

import logging
import subprocess
import sys

import matplotlib
import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from matplotlib.figure import Figure
from scenes import film as scene

from erlif import plots
from erlif.calibration import Calibration, Profile, calibration_of
from erlif.core.errors import ErlifError, FrameError, OutputError
from erlif.core.flags import Flag
from erlif.files import open_film
from erlif.plots import files as plot_files
from erlif.plots.maps import first_reason
from erlif.plots.style import FLAG_COLOURS
from erlif.trend import average_across_sliding, rigid_gap


@pytest.fixture(scope="module")
def film_path(tmp_path_factory):
    return scene.make_film(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="module")
def film(film_path):
    with open_film(film_path) as film:
        yield film


@pytest.fixture(scope="module")
def calibration():
    thickness = np.linspace(0.3, 15.5, 40)
    residual = 1e-3 * np.cos(np.arange(40))
    ratio = scene.true_ratio(thickness) + residual
    curve = xr.Dataset(
        {
            "curve_thickness": ("bin", thickness),
            "curve_ratio": ("bin", ratio),
            "curve_ratio_std": ("bin", np.full(40, 1e-3)),
            "curve_residual": ("bin", residual),
        }
    )
    covariance = np.diag([1e-3, 2e-3, 1e-3]) ** 2
    return Calibration(
        scene.K,
        scene.P,
        scene.Q,
        covariance,
        (0.3, 15.5),
        (580, 610),
        curve,
        1.1,
        "known wedge",
        ("a note",),
    )


def axes_of(artist):
    return artist.axes


def test_speed_curve_is_the_linkage_and_goes_through_the_triggers(film):
    curve, outward, back = plots.speed_against_angle(film)
    angle, speed = curve.get_data()
    npt.assert_allclose(np.ptp(angle), 24.4260, atol=2e-3)  # swing by two other linkage programs
    npt.assert_allclose(
        [speed.max(), -speed.min()], [2.552104, 2.540492], rtol=1e-5
    )  # the interior angle runs the other way
    for points in (outward, back):
        for x, y in zip(*points.get_data(), strict=True):
            assert np.hypot((angle - x) / 24, (speed - y) / 5).min() < 5e-3
    assert len(outward.get_xdata()) + len(back.get_xdata()) == scene.TRIGGERS


def test_second_axis_is_the_sliding_speed(film):
    ax = axes_of(plots.speed_against_angle(film)[0])
    (second,) = ax.child_axes
    figure = ax.get_figure()
    figure.draw_without_rendering()
    npt.assert_allclose(second.get_ylim(), np.array(ax.get_ylim()) * 33.36, rtol=1e-12)
    assert "mm/s" in second.get_ylabel()


def test_profile_finds_the_gap_within_its_error_bars(film):
    for trigger in range(scene.TRIGGERS):
        profile = average_across_sliding(film, trigger=trigger)
        inside = (scene.PITCH * np.arange(scene.ROWS) >= 1) & (
            scene.PITCH * np.arange(scene.ROWS) <= 11
        )
        truth = scene.true_film()[trigger][inside].mean(axis=0)
        pull = ((profile.thickness - truth) / profile.thickness_std).values
        pull = pull[np.isfinite(pull)]
        assert pull.size > 40
        assert abs(pull.mean()) < 4 / np.sqrt(pull.size)
        assert 0.7 < pull.std() < 1.3
        assert np.isnan(profile.thickness.values[:3]).all()  # outside the overlap
        npt.assert_allclose(profile.thickness_std_shared.values[20], 0.02, rtol=1e-3)


def test_rigid_gap_returns_radius_place_and_least_film(film):
    for trigger in (1, 4):
        gap = rigid_gap(average_across_sliding(film, trigger=trigger), film)
        npt.assert_allclose(gap.radius, scene.RADIUS, rtol=1e-6)
        npt.assert_allclose(gap.place, scene.PLACE, atol=0.1)
        npt.assert_allclose(gap.least, scene.least_film()[trigger], atol=0.05)
        assert abs(gap.curvature - 0.20525) < 4 * gap.curvature_std  # 1/R of 4.872 m
        assert gap.curvature_std < 0.02


def test_a_profile_cut_by_the_range_is_not_shown(film):
    cut = (
        film[["thickness", "thickness_std", "thickness_std_shared", "flags"]].load().copy(deep=True)
    )
    cut.attrs = film.attrs
    cut.flags.values[0, 8:12, 30] = Flag.ABOVE_RANGE
    cut.flags.values[0, 8:12, 31] = Flag.NO_FILM
    profile = average_across_sliding(cut, trigger=0)
    assert np.isnan(profile.thickness.values[30])
    assert np.isfinite(profile.thickness.values[31])


def test_map_shows_the_film_and_the_reasons(film):
    image = plots.thickness_map(film, trigger=2)
    npt.assert_array_equal(
        np.ma.filled(image.get_array(), np.nan), film.thickness.isel(trigger=2).values
    )
    ax = axes_of(image)
    assert ax.get_xlabel() == "x (sliding) [mm]"
    assert ax.get_ylabel() == "y (axial) [mm]"
    left, right, bottom, top = image.get_extent()
    npt.assert_allclose([left, right, top, bottom], [-0.1, 15.9, -0.1, 12.7])
    overlay = ax.images[1].get_array()
    shown = list(FLAG_COLOURS)
    assert overlay[30, 1] == 1 + shown.index(Flag.OUTSIDE_OVERLAP)
    assert overlay[5, 40] == 1 + shown.index(Flag.BAD_PIXEL)
    assert overlay[30, 30] == 0
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert any(text.startswith("outside overlap, 3.75 %") for text in words)  # 3 of 80 columns
    assert "film thickness [µm]" in [child.get_ylabel() for child in ax.child_axes]


def test_every_flag_has_a_colour_of_its_own():
    assert set(FLAG_COLOURS) == set(Flag)
    assert len(set(FLAG_COLOURS.values())) == len(Flag)
    for flag in Flag:
        assert first_reason(np.array([int(flag)], np.uint8))[0] > 0


def test_profile_and_residual_draw_what_was_averaged(film):
    line, *_, gap = plots.sliding_profile(film, trigger=1)
    profile = average_across_sliding(film, trigger=1)
    npt.assert_array_equal(line.get_ydata(), profile.thickness.values)
    residual = plots.profile_residual(film, trigger=1)[0]
    npt.assert_allclose(residual.get_ydata(), line.get_ydata() - gap.get_ydata(), atol=1e-12)
    assert "[µm]" in axes_of(line).get_ylabel()
    assert "[mm]" in axes_of(line).get_xlabel()


def test_drawn_power_goes_through_the_films(film):
    *_, line = plots.film_against_speed(film)
    x, y = line.get_data()
    npt.assert_allclose(np.polyfit(np.log(x), np.log(y), 1)[0], scene.POWER, rtol=1e-6)
    speed = 1e3 * np.abs(scene.rocker_speed(scene.CRANK)) / scene.LOAD
    drawn = np.exp(np.interp(np.log(np.sort(speed)), np.log(x), np.log(y)))
    npt.assert_allclose(drawn, np.sort(scene.least_film()), rtol=1e-6)
    ax = axes_of(line)
    assert "rad s⁻¹ N⁻¹" in ax.get_xlabel()
    assert "[µm]" in ax.get_ylabel()
    assert "n = 0.600 ± 0.010" in [
        text.get_text().split(", ")[-1] for text in ax.get_legend().get_texts()
    ]


def test_slow_triggers_are_drawn_apart(film):
    slow = film.load().copy(deep=True)
    slow.rocker_speed.values[0] *= 0.02
    colours = {artist.get_color() for artist in plots.film_against_speed(slow)[:-2]}
    assert len(colours) == 3  # mean, least, and grey for what the fit leaves out


def test_theory_is_drawn_with_the_film(film):
    *_, theory, formula = plots.film_and_theory(film)
    order = np.argsort(np.abs(scene.rocker_speed(scene.CRANK)))
    npt.assert_allclose(theory.get_ydata(), 20 * scene.least_film()[order])
    npt.assert_allclose(formula.get_ydata(), 0.3 * scene.least_film()[order])
    assert "isoviscous-rigid" in theory.get_label()


def test_calibration_points_lie_on_the_curve_but_for_their_residuals(calibration):
    fit, _, points = plots.ratio_against_thickness(calibration)
    t, r = fit.get_data()
    npt.assert_allclose(r, scene.true_ratio(t), rtol=1e-9)
    npt.assert_allclose(
        points.get_ydata() - scene.true_ratio(points.get_xdata()),
        calibration.curve.curve_residual,
        atol=1e-12,
    )
    below = plots.ratio_residuals(calibration)[-1]
    expected = (
        100 * calibration.curve.curve_residual / scene.true_ratio(calibration.curve.curve_thickness)
    )
    npt.assert_allclose(below.get_ydata(), expected, rtol=1e-9)
    assert axes_of(fit).get_xlabel() == "thickness [µm]"
    assert axes_of(fit).get_ylabel() == "ratio 610 nm / 580 nm [1]"
    assert "%" in axes_of(below).get_ylabel()


def test_band_of_the_fit_holds_the_scatter_of_its_parameters(calibration):
    rng = np.random.default_rng(3)
    drawn = rng.multivariate_normal([scene.K, scene.P, scene.Q], calibration.covariance, 4000)
    k, p, q = (drawn[:, n, None] for n in range(3))
    t = np.array([1.0, 5.0, 15.0])
    ratio = k * (p / q) * (1 - np.exp(-q * t)) / (1 - np.exp(-p * t))
    vertices = plots.ratio_against_thickness(calibration)[1].get_paths()[0].vertices
    for n, thickness in enumerate(t):
        closest = vertices[np.argmin(np.abs(vertices[:, 0] - thickness)), 0]
        half = np.ptp(vertices[vertices[:, 0] == closest, 1]) / 2
        npt.assert_allclose(half, 1.96 * ratio[:, n].std(), rtol=0.06)


def test_fixture_profile_as_line_and_as_surface(calibration):
    line = Profile(np.linspace(0, 10, 9), np.linspace(0, 8, 9), np.full(9, 0.1))
    drawn = plots.fixture_profile(line, calibration=calibration)
    npt.assert_array_equal(drawn[0].get_xdata(), line.position)
    npt.assert_array_equal(drawn[0].get_ydata(), line.thickness)
    assert axes_of(drawn[0]).get_ylabel() == "thickness by CMM [µm]"
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(4.0), np.arange(3.0)))
    surface = Profile(np.stack([x, y], axis=1), x + y, None)
    (points,) = plots.fixture_profile(surface)
    npt.assert_array_equal(points.get_offsets(), surface.position)
    npt.assert_array_equal(points.get_array(), surface.thickness)


def test_film_over_the_cycle_is_in_the_order_of_the_crank(film):
    ax = axes_of(plots.film_over_cycle(film)[0])
    drawn = [line for line in ax.lines if line.get_linestyle() != "None"]
    for line in drawn:
        assert (np.diff(line.get_xdata()) > 0).all()
    assert ax.get_xlabel() == "crank angle [°]"
    curve = plots.speed_over_cycle(film)[0]
    crank, speed = curve.get_data()
    npt.assert_allclose(
        np.interp(scene.CRANK, crank, speed), scene.rocker_speed(scene.CRANK), atol=1e-3
    )


def test_registration_shows_displacement_and_drift(film_path):
    with (
        open_film(film_path, group="registration") as registration,
        open_film(film_path, group="frames") as frames,
    ):
        registration, frames = registration.load(), frames.load()
    registration["displacement_x"] = (
        registration.displacement_x + 3 + 0.01 * (np.arange(scene.COLUMNS) - 39.5)
    )
    image = plots.displacement_map(registration, component="x")
    npt.assert_allclose(np.ptp(image.get_array()), 0.79, rtol=1e-4)
    npt.assert_allclose(image.get_array().mean(), 0, atol=1e-6)
    assert "= +3.00 px" in axes_of(image).get_title()
    drift, _ = plots.drift_of_frames(frames)
    assert axes_of(drift).get_ylabel() == "drift of camera 2 [px]"
    assert isinstance(plots.registration_figure(registration, frames), Figure)


def test_restored_ratio_is_that_of_the_film(film_path, film):
    restored = plots.restore_frames(film_path, film_path.parent, trigger=3)
    valid = np.isfinite(restored.ratio.values)
    assert valid.mean() > 0.9
    assert not valid[:, :3].any()
    # one count of a thousand, in both bands, and the correction of the logarithm's bias
    npt.assert_allclose(
        restored.ratio.values[valid], scene.true_ratio(scene.true_film()[3])[valid], rtol=2e-3
    )
    npt.assert_allclose(restored.signal.values[0], 1000, atol=0.5)
    image = plots.band_images(restored, film, camera=2)
    npt.assert_array_equal(np.ma.filled(image.get_array(), np.nan), restored.signal.values[1])
    assert "610 nm" in axes_of(image).get_title()
    ratio = plots.ratio_image(restored, film)
    assert any(
        "ratio 610 nm / 580 nm [1]" in child.get_ylabel() for child in axes_of(ratio).child_axes
    )


def test_another_run_is_refused(film_path, tmp_path):
    scene.make_run(tmp_path / "other")
    for camera in (1, 2):
        (tmp_path / "other" / f"camera{camera}" / "frame_05.tif").unlink()
    log = (tmp_path / "other" / "encoder.csv").read_text().splitlines()[:-1]
    (tmp_path / "other" / "encoder.csv").write_text("\n".join(log) + "\n")
    with pytest.raises(FrameError, match="6 frames of 80 x 64"):
        plots.restore_frames(film_path, tmp_path / "other", trigger=0)


@pytest.mark.parametrize("trigger", [-1, scene.TRIGGERS])
def test_a_trigger_that_is_not_there_is_named(film, trigger):
    with pytest.raises(ErlifError, match="from 0 to 5"):
        plots.thickness_map(film, trigger=trigger)


def test_all_axes_name_their_units(film_path, film, calibration):
    restored = plots.restore_frames(film_path, film_path.parent, trigger=0)
    figures = [
        plots.cycle_figure(film),
        plots.speed_figure(film),
        plots.thickness_figure(film, trigger=0),
        plots.calibration_figure(calibration),
        plots.band_images_figure(restored, film, trigger=0),
    ]
    for figure in figures:
        labels = [
            label for ax in figure.axes for label in (ax.get_xlabel(), ax.get_ylabel()) if label
        ]
        assert labels
        assert all("[" in label and "]" in label for label in labels), labels


@pytest.mark.slow
def test_figures_are_written_twice_alike(film_path, tmp_path):
    first = plots.write_figures(film_path, tmp_path / "a", formats=("png",))
    assert [path.stem for path in first] == [
        "speed_against_angle",
        "processed_images",
        "ratio_image",
        "calibration",
        "thickness_map",
        "film_against_speed",
        "map_sheet",
        "film_over_cycle",
        "registration",
    ]
    for path in first:
        assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    again = plots.write_figures(film_path, tmp_path / "b", formats=("png",))
    assert [path.read_bytes() for path in again] == [path.read_bytes() for path in first]


@pytest.mark.parametrize("kind", ["pdf", "svg"])
def test_one_figure_is_the_same_in_other_formats_twice(calibration, tmp_path, kind):
    one, two = (plots.write_calibration_figure(calibration, tmp_path / f"{n}.{kind}") for n in "ab")
    assert one.read_bytes() == two.read_bytes()
    assert b"CreationDate" not in one.read_bytes()
    assert one.stat().st_size > 5000


def test_without_the_run_the_rest_is_drawn_and_the_log_says_why(
    film_path, tmp_path, caplog, monkeypatch
):
    alone = tmp_path / "film.nc"
    alone.write_bytes(film_path.read_bytes())
    missing = plots.missing_figures(alone)
    assert set(missing) == {"fixture_profile", "processed_images", "ratio_image"}
    assert "run directory" in missing["ratio_image"]
    assert set(plots.missing_figures(alone, run_dir=film_path.parent)) == {"fixture_profile"}
    few = {
        name: draw
        for name, draw in plot_files.DRAWN.items()
        if name in {*missing, "speed_against_angle"}
    }
    monkeypatch.setattr(plot_files, "DRAWN", few)
    with caplog.at_level(logging.WARNING, logger="erlif"):
        written = plots.write_figures(alone, tmp_path, formats=("svg",))
    assert [path.name for path in written] == ["speed_against_angle.svg"]
    assert all(any(name in message for message in caplog.messages) for name in missing)


def test_a_directory_of_another_run_beside_the_film_is_not_taken_for_its_own(
    film_path, film, tmp_path
):
    (tmp_path / "run.toml").write_text(scene.RUN_TOML.replace("known", "other"))
    assert plots.find_run(tmp_path / "film.nc", film) is None
    assert plots.find_run(film_path, film) == film_path.parent


def test_a_film_without_answers_is_drawn_as_such(film):
    mute = scene.without_answers(film)
    image = plots.thickness_map(mute, trigger=0)
    assert (
        axes_of(image).images[1].get_array() == 1 + list(FLAG_COLOURS).index(Flag.ABOVE_RANGE)
    ).all()
    assert rigid_gap(average_across_sliding(mute, trigger=0), mute) is None
    for draw in (plots.map_sheet_figure, plots.cycle_figure, plots.speed_figure):
        assert isinstance(draw(mute), Figure)


def test_existing_figures_are_kept_unless_told_otherwise(film_path, tmp_path):
    (tmp_path / "calibration.svg").write_text("mine")
    with pytest.raises(OutputError, match="--overwrite"):
        plots.write_figures(film_path, tmp_path, formats=("svg",))
    assert [path.name for path in tmp_path.iterdir()] == ["calibration.svg"]
    assert (tmp_path / "calibration.svg").read_text() == "mine"
    with pytest.raises(OutputError, match="gif"):
        plots.write_figures(film_path, tmp_path, formats=("gif",))


def test_the_callers_settings_are_left_alone(film):
    before = dict(matplotlib.rcParams)
    ax = Figure().add_subplot()
    image = plots.thickness_map(film, trigger=0, ax=ax)
    assert axes_of(image) is ax
    assert dict(matplotlib.rcParams) == before


def test_drawing_is_loaded_only_when_asked_for_and_never_opens_pyplot():
    code = (
        "import sys, erlif, erlif.pipeline\n"
        "assert 'matplotlib' not in sys.modules\n"
        "import erlif.plots, erlif.report\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_calibration_figures_of_a_film_without_its_calibration_draw_the_curve_alone(film):
    """A film moved away from its fixture keeps the curve and its range, and no points."""
    kept = calibration_of(film)
    fit, *_ = plots.ratio_against_thickness(kept)
    npt.assert_allclose(fit.get_ydata(), kept.predict(fit.get_xdata()))
    assert isinstance(plots.calibration_figure(kept), Figure)
