"""The set of figures: which are drawn, from which directories, and what is written."""

import logging
import re
import shutil
import tomllib
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene
from scenes.fixture import walled
from scenes.motion import film_of
from scenes.pictures import picture, without_texts

import erlif
from erlif.calibration import save_calibration
from erlif.core.errors import ErlifError, OutputError
from erlif.io.settings import RunSettings, to_toml
from erlif.show import plots
from erlif.show.plots import files as plot_files
from erlif.show.plots.files import DRAWN, FigureSource, find_source, reason_missing
from erlif.show.plots.style import figure_bytes, in_style
from erlif.show.report.captions import CAPTIONS

STRAIGHT = [name for name in DRAWN if name != "film_along_axis"]
"""Figures of a bore that is straight."""

NEED_A_DIRECTORY = {"fixture_profile", "processed_images", "ratio_image"}


@pytest.fixture
def alone(film_path, tmp_path):
    """The film without its run directory."""
    return shutil.copy(film_path, tmp_path / "film.nc")


def write_fixture(directory):
    """Write a fixture directory as far as the figures read it."""
    directory.mkdir()
    cameras = "".join(
        f'[camera{n}]\nfiles = "camera{n}/*.tif"\nband = "{band} nm"\noffset = "64 DN"\n'
        for n, band in ((1, 580), (2, 610))
    )
    (directory / "fixture.toml").write_text(
        '[fixture]\nname = "known wedge"\nprofile = "profile.csv"\n'
        + cameras
        + '[optics]\npixel_pitch = "200 um"\n'
    )
    rows = "".join(f"{x:.1f},{0.8 * x:.2f},0.05\n" for x in np.linspace(0, 20, 41))
    (directory / "profile.csv").write_text(f"x_mm,thickness_um,uncertainty_um\n{rows}")
    return directory


@pytest.fixture
def fixture_dir(tmp_path):
    """A fixture directory that a test may change."""
    return write_fixture(tmp_path / "fixture")


@pytest.fixture(scope="module")
def all_drawn(film_path, tmp_path_factory):
    """All figures by name, and their files at 50 dpi, which fix the layout."""
    folder = tmp_path_factory.mktemp("all")
    figures = {}

    def keeping(name):
        def draw(source):
            figures[name] = DRAWN[name](source)
            return figures[name]

        return draw

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plot_files, "DRAWN", {name: keeping(name) for name in DRAWN})
        directories = {"fixture_dir": write_fixture(folder / "fixture")}
        paths = plots.write_figures(film_path, folder, formats=("png",), dpi=50, **directories)
    return figures, paths


def without_tables(film, *names):
    """A film whose settings lack some tables."""
    raw = {k: v for k, v in tomllib.loads(film.attrs["settings"]).items() if k not in names}
    return film.assign_attrs(settings=to_toml(RunSettings.model_validate(raw)))


def few(monkeypatch, *names):
    """Draw some of the figures only."""
    monkeypatch.setattr(plot_files, "DRAWN", {name: DRAWN[name] for name in names})


def source_of(film_path, film, **directories):
    options = {"run_dir": None, "fixture_dir": None} | directories
    return find_source(film_path, film, None, options["run_dir"], options["fixture_dir"])


@pytest.fixture(scope="module")
def second_source(film_path, film):
    """The film of the scene, with the run directory."""
    return source_of(film_path, film)


@pytest.mark.parametrize("name", ["thickness_map", "speed_against_angle", "processed_images"])
def test_a_figure_that_is_drawn_again_has_the_same_bytes(second_source, name, all_drawn):
    """A map, lines with a legend, and images that are read again."""
    (path,) = (path for path in all_drawn[1] if path.stem == name)
    assert figure_bytes(DRAWN[name](second_source), kind="png", dpi=50) == path.read_bytes()


def test_captions_name_the_panels_that_are_drawn(all_drawn):
    figures, _ = all_drawn
    for name, figure in figures.items():
        titles = " ".join(ax.get_title(loc="left") for ax in figure.axes)
        drawn = set(re.findall(r"\(([a-d])\)", titles.replace(r"$\mathbf{", "").replace("}$", "")))
        groups = re.findall(r"\(([a-d](?:, [a-d])*)\)", CAPTIONS[name].text)
        named = {letter for group in groups for letter in group.split(", ")}
        assert named in (set(), drawn), name


def test_all_axes_name_their_units_and_no_label_is_cut_off(all_drawn):
    """Text of titles, axes and legends lies within the figure."""
    figures, _ = all_drawn
    assert list(figures) == STRAIGHT
    for name, figure in figures.items():
        figure.draw_without_rendering()
        width, height = figure.bbox.width, figure.bbox.height
        panels = [child for ax in figure.axes for child in (ax, *ax.child_axes)]
        labels = {label for ax in panels for label in (ax.get_xlabel(), ax.get_ylabel()) if label}
        labels -= {"outward", "return", "mean"} if name.startswith("map_sheet") else set()
        assert labels
        assert all("[" in label and "]" in label for label in labels), labels

        texts = [t for ax in panels for t in (ax.title, ax.xaxis.label, ax.yaxis.label)]
        texts += [t for legend in figure.legends for t in legend.get_texts()]
        for text in texts:
            if text.get_text() and text.get_visible():
                box = text.get_window_extent()
                inside = box.x0 > -1 and box.y0 > -1 and box.x1 < width + 1 and box.y1 < height + 1
                assert inside, (name, text.get_text())


@pytest.mark.parametrize("name", [name for name in STRAIGHT if name != "fixture_profile"])
@picture
def test_figure(name, all_drawn):
    """A figure has the look of the stored picture; the last test that needs its texts is above."""
    return without_texts(all_drawn[0][name])


def test_without_the_run_the_rest_is_drawn_and_the_log_gives_the_reason(
    alone, tmp_path, caplog, monkeypatch
):
    few(monkeypatch, *NEED_A_DIRECTORY, "speed_against_angle")
    with caplog.at_level(logging.WARNING, logger="erlif"):
        written = plots.write_figures(alone, tmp_path, formats=("svg",))
    assert [path.name for path in written] == ["speed_against_angle.svg"]
    assert all(any(name in message for message in caplog.messages) for name in NEED_A_DIRECTORY)


def test_missing_figures_have_reasons(alone, film_path, fixture_dir):
    missing = plots.missing_figures(alone)
    assert set(missing) == NEED_A_DIRECTORY
    assert "run directory" in missing["ratio_image"]
    assert "fixture directory" in missing["fixture_profile"]
    assert set(plots.missing_figures(alone, run_dir=film_path.parent)) == {"fixture_profile"}
    given = {"run_dir": film_path.parent, "fixture_dir": fixture_dir}
    assert plots.missing_figures(alone, **given) == {}


@pytest.mark.parametrize(
    ("name", "change", "reason"),
    [
        ("film_over_cycle", lambda film: film.isel(trigger=[0]), "a single trigger"),
        ("pin_orbit", lambda film: film.drop_vars("pin_displacement"), "it needs [joint]"),
        ("prediction_map", lambda film: film.drop_vars("film_predicted_min"), "a note of the film"),
        (
            "film_and_prediction",
            lambda _: film_of(None, without=["film_predicted_min"]),
            "of a crank-rocker alone",
        ),
        (
            "film_and_prediction",
            lambda film: without_tables(film.drop_vars("film_predicted_min"), "oil"),
            "run.toml has no [oil], which",
        ),
    ],
)
def test_figures_without_their_variables_have_reasons(name, change, reason):
    film = change(plots.example_film())
    assert reason in reason_missing(name, FigureSource(Path("film.nc"), film, 0, None, None))


def test_frames_of_another_run_are_the_reason_of_their_figures(film_path, film, tmp_path):
    scene.make_run(tmp_path / "other")
    for camera in (1, 2):
        (tmp_path / "other" / f"camera{camera}" / "frame_05.tif").unlink()
    log = (tmp_path / "other" / "encoder.csv").read_text().splitlines()[:-1]
    (tmp_path / "other" / "encoder.csv").write_text("\n".join(log) + "\n")
    source = source_of(film_path, film, run_dir=tmp_path / "other")
    assert "could not be read again" in reason_missing("processed_images", source)


def test_run_directory_is_recognised_by_the_name_of_the_run(film_path, film, tmp_path):
    assert plots.find_run(film_path, film) == film_path.parent
    assert plots.find_run(tmp_path / "film.nc", film) is None
    (tmp_path / "run.toml").write_text(scene.RUN_TOML.replace("known", "other"))
    assert plots.find_run(tmp_path / "film.nc", film) is None


def test_fixture_is_found_where_the_settings_name_its_calibration(with_settings, tmp_path):
    named = with_settings(("[run]", 'calibration = "../wedge/calibration.nc"\n\n[run]'))
    run = tmp_path / "run"
    run.mkdir()
    assert plots.find_fixture(named, run) is None  # no such directory
    (tmp_path / "wedge").mkdir()
    (tmp_path / "wedge" / "fixture.toml").write_text("")
    assert plots.find_fixture(named, run).resolve() == tmp_path / "wedge"
    assert plots.find_fixture(named, None) is None


def test_profile_outside_the_fixture_is_not_read(film_path, film, fixture_dir, tmp_path):
    profile = tmp_path / "secret.csv"
    (fixture_dir / "profile.csv").rename(profile)
    (fixture_dir / "profile.csv").symlink_to(profile)
    source = source_of(film_path, film, fixture_dir=fixture_dir)
    assert "--allow-outside" in reason_missing("fixture_profile", source)
    assert reason_missing("fixture_profile", replace(source, allow_outside=True)) is None


def test_points_of_the_calibration_are_drawn_if_it_is_that_of_the_film(
    film_path, film, fixture_dir, calibration, caplog
):
    """Not where the fixture was calibrated again after the film, or the file is damaged."""
    path = fixture_dir / "calibration.nc"

    def found():
        return source_of(film_path, film, fixture_dir=fixture_dir).calibration

    save_calibration(calibration, path)
    npt.assert_array_equal(found().curve.curve_ratio, calibration.curve.curve_ratio)
    path.unlink()
    save_calibration(replace(calibration, ratio_at_zero=0.7), path)
    with caplog.at_level(logging.WARNING, logger="erlif"):
        assert "curve_ratio" not in found().curve
        assert "not the calibration that the film was made with" in caplog.text
        path.unlink()
        save_calibration(walled(calibration), path)  # of more parameters
        assert "curve_ratio" not in found().curve
        path.write_bytes(b"no calibration")
        npt.assert_allclose(found().parameters, [scene.K, scene.P, scene.Q])

    # a damaged profile is the reason of its figure
    (fixture_dir / "profile.csv").write_text("nothing of use\n")
    source = source_of(film_path, film, fixture_dir=fixture_dir)
    assert "profile.csv" in reason_missing("fixture_profile", source)


def test_points_are_drawn_of_a_fixture_whose_calibration_was_not_kept(lab):
    """It lies outside the run directory, where processing writes nothing."""
    path = lab.fixture / "calibration.nc"
    known = erlif.open_calibration(path)
    path.unlink()
    with erlif.process(lab.run, output=lab.film) as film:
        source = source_of(lab.film, film, fixture_dir=lab.fixture, run_dir=lab.run)
        npt.assert_array_equal(source.calibration.curve.curve_ratio, known.curve.curve_ratio)
    assert not path.exists()


def test_existing_figures_are_kept_without_overwrite(film_path, tmp_path):
    (tmp_path / "calibration.svg").write_text("mine")
    with pytest.raises(OutputError, match="--overwrite"):
        plots.write_figures(film_path, tmp_path, formats=("svg",))
    assert [path.name for path in tmp_path.iterdir()] == ["calibration.svg"]
    assert (tmp_path / "calibration.svg").read_text() == "mine"


def test_chosen_figures_are_written_in_their_style_and_resolution(film_path, tmp_path):
    """85 mm at 100 pixels an inch, 16:9 at 60, and a sheet of the user of 4 inches at 50."""
    sheet = tmp_path / "mine.mplstyle"
    sheet.write_text("figure.figsize: 4.0, 3.0\nfont.size: 9\n")
    for style, name, dpi, width in (
        ("paper", "calibration", 100, int(85 / 25.4 * 100)),
        ("slides", "film_over_cycle", 60, 799),
        (sheet, "speed_against_angle", 50, 200),
    ):
        seen = []
        options = {"only": [name], "formats": ["png"], "style": style, "dpi": dpi}
        (path,) = plots.write_figures(
            film_path, tmp_path, progress=lambda *step, seen=seen: seen.append(step), **options
        )
        assert path.name == f"{name}.png"
        assert seen == [("figures", 0, 1), ("figures", 1, 1)]
        assert int.from_bytes(path.read_bytes()[16:20], "big") == width


def test_no_legend_is_cut_where_pixels_are_few(film):
    """Text of seven pixels is taller than its size, and a legend of many lines with it."""
    with in_style("paper"):
        for dpi in (50, 72):
            figure = plots.speed_figure(film)
            figure_bytes(figure, kind="png", dpi=dpi)
            figure.set_dpi(dpi)
            for ax in figure.axes:
                assert ax.get_legend().get_window_extent().y0 > -1


def test_files_do_not_depend_on_settings_of_the_caller(film_path, tmp_path):
    options = {"only": ["calibration"], "formats": ["svg", "pdf"]}
    plain = plots.write_figures(film_path, tmp_path / "a", **options)
    with matplotlib.rc_context({"font.size": 13, "lines.linewidth": 4, "svg.hashsalt": "mine"}):
        other = plots.write_figures(film_path, tmp_path / "b", **options)
    assert [path.read_bytes() for path in plain] == [path.read_bytes() for path in other]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"only": ["fixture_profile"]}, "CMM profile"),
        ({"style": "nonsense"}, "paper, slides"),
        ({"dpi": 3}, "20 to 2400"),
        ({"trigger": 6}, "from 0 to 5"),
    ],
)
def test_unknown_choice_is_refused_with_what_there_is(film_path, tmp_path, options, message):
    with pytest.raises(ErlifError, match=message):
        plots.write_figures(film_path, tmp_path / "figures", **options)
    assert not (tmp_path / "figures").exists()
