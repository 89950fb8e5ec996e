"""A plan against its rehearsal: the virtual rig shares no code with the prediction."""

import functools
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scipy.stats import median_abs_deviation

import erlif
from erlif.core.errors import ConfigError
from erlif.core.flags import Flag
from erlif.io.settings import PlanSettings
from erlif.planning import find_optimum, log_ratio, measurable_range, signal, thickness_std
from erlif.planning.plan import (
    best_settings,
    design_of,
    example_plan,
    film_of,
    moved_settings,
    plan,
    rig_of,
)
from erlif.rig import simulate
from erlif.show.plots import example_plan_results
from erlif.show.report import summarise_plan, write_plan

pytestmark = pytest.mark.usefixtures("without_theory")


def settings_of(*changes):
    text = example_plan()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return PlanSettings.model_validate(tomllib.loads(text))


@pytest.fixture(scope="module")
def planned():
    return example_plan_results()  # that of the command is in tests/commands


@pytest.fixture(scope="module")
def rehearsal(tmp_path_factory):
    """Film, truth and calibration of the example plan.

    The beam is even, the pulse has its mean energy, both cameras are equally sharp, and camera 2 is
    turned so far that the pixels have all sub-pixel positions, as the plan assumes.
    """
    folder = tmp_path_factory.mktemp("rehearsal") / "rig"
    size = {"width": 160, "height": 128, "fixture_frames": 6, "rotation": 1.5}
    even = {"dust": 0, "marks": 0.0, "blur": (0.5, 0.5)}
    simulate(folder, seed=3, rig=replace(rig_of(settings_of()), **size, **even, pulse_jitter=0.0))
    calibration = erlif.calibrate(folder / "fixture")
    film = erlif.process(folder / "run", calibration=calibration)
    with xr.open_dataset(folder / "truth.nc", engine="h5netcdf") as truth:
        return film, truth.film.values[0], calibration


def test_standard_deviation_is_that_of_the_rehearsal(rehearsal):
    film, true, _ = rehearsal
    design = design_of(settings_of(), Path())
    chosen = (film.flags.values[0] == 0) & (true > 2) & (true < 10)
    predicted = thickness_std(design, true[chosen])
    stated = film.thickness_std.values[0][chosen]
    assert np.median(stated / predicted) == pytest.approx(1.0, abs=0.05)

    # the error of the calibration is the same for all pixels of one thickness
    pull = (film.thickness.values[0][chosen] - true[chosen]) / predicted
    like = np.digitize(true[chosen], np.geomspace(2, 10, 13))
    spread = [np.std(pull[like == number]) for number in range(1, 13)]
    assert np.sqrt(np.mean(np.square(spread))) == pytest.approx(1.0, abs=0.05)


BEST = (
    ('"0.008 mol/L"', '"0.00517 mol/L"'),
    ('"0.024 mol/L"', '"0.0476 mol/L"'),
    ('thick_film = "11000 electron"', 'thick_film = "5100 electron"'),
    ('thick_film = "11500 electron"', 'thick_film = "13300 electron"'),
)


@pytest.mark.parametrize(("corner", "changes"), [(0.5, ()), (0.43, BEST)], ids=["thesis", "best"])
def test_standard_deviation_in_a_beam_that_falls_off(tmp_path, corner, changes):
    """Of the whole field, with dust, marks and scatter of the pulse energy; two rigs."""
    settings = settings_of(*changes, ("# corner = 1.0", f"corner = {corner}"))
    size = {"width": 160, "height": 128, "fixture_frames": 6, "blur": (0.5, 0.5)}
    simulate(tmp_path / "rig", seed=3, rig=replace(rig_of(settings), **size))
    calibration = erlif.calibrate(tmp_path / "rig" / "fixture")
    film = erlif.process(tmp_path / "rig" / "run", calibration=calibration)
    with xr.open_dataset(tmp_path / "rig" / "truth.nc", engine="h5netcdf") as truth:
        true = truth.film.values[0]
    chosen = (film.flags.values[0] == 0) & (true > 2) & (true < 10)
    predicted = thickness_std(design_of(settings, Path()), true[chosen])
    stated = film.thickness_std.values[0][chosen] / predicted
    assert np.sqrt(np.mean(stated**2)) == pytest.approx(1.0, abs=0.04)

    # dust leaves single pixels far off
    pull = (film.thickness.values[0][chosen] - true[chosen]) / predicted
    like = np.digitize(true[chosen], np.geomspace(2, 10, 13))
    spread = [1.4826 * median_abs_deviation(pull[like == number]) for number in range(1, 13)]
    assert np.sqrt(np.mean(np.square(spread))) == pytest.approx(1.0, abs=0.05)

    # the middle of the beam alone is well below
    even = thickness_std(design_of(settings_of(*changes), Path()), true[chosen])
    assert np.sqrt(np.mean((predicted / even) ** 2)) > 1.1


def test_range_is_that_of_the_rehearsal(rehearsal):
    film, true, calibration = rehearsal
    wanted = replace(film_of(settings_of()), covered=calibration.covered_range)
    low, high = measurable_range(design_of(settings_of(), Path()), wanted)
    flags = film.flags.values[0]
    true = np.where(flags & Flag.OUTSIDE_OVERLAP, np.nan, true)
    valid = flags == 0
    assert valid[(true > 1.15 * low) & (true < high / 1.15)].mean() > 0.97
    outside = (true < low / 1.3) | (true > 1.3 * high)
    assert not outside.any() or valid[outside].mean() < 0.05


def test_ratio_is_that_of_the_fixture(rehearsal):
    *_, calibration = rehearsal
    films = np.linspace(1, 12, 12)
    planned = np.exp(log_ratio(design_of(settings_of(), Path()), films))
    # the flats of both cameras have one lamp, so that the ratio has no factor
    npt.assert_allclose(calibration.predict(films) / planned, 1.0, atol=0.01)


def test_a_plan_is_a_dataset_with_units(planned):
    assert planned.attrs["title"] == "example rig"
    for name, variable in planned.data_vars.items():
        assert "units" in variable.attrs or variable.dtype.kind in "UO", name
        assert variable.attrs["long_name"], name
    design = design_of(settings_of(), Path())
    npt.assert_allclose(planned.thickness_std, thickness_std(design, planned.thickness))
    npt.assert_allclose(planned.attenuation_camera1, 0.40, rtol=0.02)

    # the best plan is as good as predicted
    better = PlanSettings.model_validate(tomllib.loads(planned.attrs["optimum_settings"]))
    best_std = thickness_std(design_of(better, Path()), planned.thickness)
    npt.assert_allclose(best_std, planned.optimum_thickness_std, rtol=5e-3)


def test_the_best_plan_keeps_the_light_of_its_pulse_energy():
    settings = settings_of(('"11000 electron"', '"90000 electron"'))
    design, film = design_of(settings, Path()), film_of(settings)
    best = find_optimum(design, film)
    again = design_of(best_settings(settings, best), Path())
    assert best.design.energy < 1
    films = np.array([2.0, 10.0])
    for number in (1, 2):
        npt.assert_allclose(
            signal(again, number, films), signal(best.design, number, films), rtol=5e-3
        )


def test_coefficients_and_files_give_the_plan_of_the_spectra(tmp_path):
    source = Path(erlif.__file__).parent / "planning" / "dyes"
    changes = []
    for number in (605, 650):
        kinds = ("absorption", "emission")
        for kind in kinds:
            text = (source / f"synthetic_{number}_{kind}.csv").read_text()
            (tmp_path / f"{number}_{kind}.csv").write_text(text)
        files = "\n".join(f'{kind} = "{number}_{kind}.csv"' for kind in kinds)
        changes.append((f'spectra = "synthetic {number}"', files))
    settings = settings_of(*changes)
    expected = design_of(settings_of(), Path())
    films = np.array([1.0, 5.0, 12.0])
    npt.assert_allclose(log_ratio(design_of(settings, tmp_path), films), log_ratio(expected, films))
    moved = moved_settings(settings, tmp_path, tmp_path / "results")
    assert moved.dye1.absorption == "../605_absorption.csv"
    with pytest.raises(ConfigError, match="cannot be read"):
        design_of(settings, tmp_path / "elsewhere")


def test_coefficients_give_the_plan_of_spectra_that_are_flat_in_each_band(tmp_path):
    edges = np.array([500, 556, 556.001, 595, 595.001, 640])
    inline, by_file = [], []
    for number, absorbed, emitted in (
        (605, (4e4, 8e3, 100), (3, 2)),
        (650, (3e3, 5e4, 4e4), (1, 4)),
    ):
        laser, one, two = absorbed
        share = np.array(emitted) / (emitted[0] * 95 + emitted[1] * 45)
        named = {"absorption": np.repeat(absorbed, 2), "emission": np.repeat(emitted, [4, 2])}
        for kind, value in named.items():
            rows = "".join(f"{nm},{each}\n" for nm, each in zip(edges, value, strict=True))
            (tmp_path / f"{number}_{kind}.csv").write_text(f"wavelength_nm,value\n{rows}")
        synthetic = f'spectra = "synthetic {number}"'
        files = "\n".join(f'{kind} = "{number}_{kind}.csv"' for kind in named)
        by_file.append((synthetic, files))
        keys = {"laser": laser, "camera1": one, "camera2": two}
        keys = [f'{key} = "{value} L/mol/cm"' for key, value in keys.items()]
        keys += [f'emission{n} = "{each} 1/nm"' for n, each in enumerate(share, 1)]
        inline.append((synthetic, f"coefficients = {{ {', '.join(keys)} }}"))
    films = np.array([1.0, 5.0, 12.0])
    given, read = (design_of(settings_of(*changes), tmp_path) for changes in (inline, by_file))
    npt.assert_allclose(log_ratio(given, films), log_ratio(read, films), rtol=2e-3)


def test_light_follows_from_optics():
    table = '[optics]\npixel_pitch = "60 um"\nnumerical_aperture = 0.02\n\n[references]'
    settings = settings_of(
        ('thick_film = "11000 electron"', "efficiency = 0.1"),
        ('thick_film = "11500 electron"', "efficiency = 0.1"),
        ('# beam_diameter = "25 mm"', 'beam_diameter = "25 mm"'),
        ("[references]", table),
        ('"50 mJ"', '"1 mJ"'),
    )
    design = design_of(settings, Path())
    laser = settings.laser.model_copy(update={"pulse_energy": 2e-3})
    twice = design_of(settings.model_copy(update={"laser": laser}), Path())
    npt.assert_allclose(signal(twice, 1, 5.0), 2 * signal(design, 1, 5.0))
    assert 1e3 < signal(design, 1, 5.0) < 1e6


def test_exchanged_filters_are_refused():
    tables = tomllib.loads(example_plan())
    tables["camera1"]["band"], tables["camera2"]["band"] = "610 nm", "580 nm"
    with pytest.raises(ConfigError, match="Exchange the"):
        design_of(PlanSettings.model_validate(tables), Path())


def test_what_the_virtual_rig_cannot_show_is_refused():
    thick = ('thickest = "10 um"', 'thickest = "10 mm"')
    settings = settings_of(("# bit_depth = 12", "bit_depth = 14"))
    other = settings.camera1.model_copy(update={"bit_depth": 12, "gain": 2.0})
    for wrong, message in (
        (settings_of(thick, ('thickest = "18 um"', 'thickest = "20 mm"')), "at most 716 um"),
        (settings, "bit_depth is 14"),
        (settings.model_copy(update={"camera1": other}), "gain, bit_depth differ"),
    ):
        with pytest.raises(ConfigError, match=message):
            rig_of(wrong)
    with pytest.raises(ConfigError, match="got dict"):
        plan({})


BORE = """width = "19.2 mm"
length = "237 mm"
field = ["46 mm", "62 mm"]
bore = """
LOBE = '{ lobes = ["50 mm"], lobe_radius = "200 mm", lobe_height = "20 um" }'


@functools.cache
def planned_with(bore):
    return plan(settings_of(('width = "19.2 mm"\n', f"{BORE}{bore}\n")))


def test_plan_states_which_part_of_a_lobe_is_measurable():
    """x^2 / 2R up to the thickest measurable film, to either side of a crest within the field."""
    planned = planned_with(LOBE)
    crest, highest = planned.film_range.values, float(planned.measurable_range_frames[1])
    assert crest[1] < highest < crest[0] + 20
    reach = np.sqrt(2 * 200 * 1e-3 * (highest - crest))  # mm; the foot of the lobe is at 2.83 mm
    npt.assert_allclose(planned.bore_length, 2 * reach, atol=0.01)
    npt.assert_allclose(planned.bore_thickest, crest + 20, atol=1e-3)
    assert planned.field_length == pytest.approx(16)
    text = "With 2 um on the crest of the bore, films along the axis of the field reach 22 um: "
    assert f"{text}{2 * reach[0]:.3g} of its 16 mm are measurable." in summarise_plan(planned)


def test_plan_reads_the_profile_beside_it_and_names_it_from_its_output(tmp_path, monkeypatch):
    monkeypatch.setattr("erlif.show.plots.save_figure", lambda _, path: path.touch())
    place = np.linspace(-118.5, 118.5, 4000)
    height = np.maximum(20 - (place - 50) ** 2 / 0.4, 0)
    rows = [f"{one:.5f},{up:.5f}" for one, up in zip(place, height, strict=True)]
    (tmp_path / "bore.csv").write_text("\n".join(["axial_mm,height_um", *rows]))
    text = example_plan().replace('width = "19.2 mm"\n', BORE + '{ profile = "bore.csv" }\n')
    (tmp_path / "plan.toml").write_text(text)
    planned = plan(tmp_path / "plan.toml")
    npt.assert_allclose(planned.bore_length, planned_with(LOBE).bore_length, atol=0.02)
    write_plan(planned, tmp_path / "plan", folder=tmp_path)
    again = plan(tmp_path / "plan" / "optimum.toml")
    npt.assert_array_equal(again.bore_thickest, planned.bore_thickest)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('length = "237 mm"\n', "", "bore needs length, and as field both ends"),
        ('["46 mm", "62 mm"]', '["46 mm"]', "bore needs length, and as field both ends"),
        ('"20 um"', '"240 um"', "lobe_height of bore must be below the radial clearance"),
    ],
)
def test_bores_without_a_place_in_the_plan_are_refused(old, new, words):
    with pytest.raises(ValueError, match=words):
        settings_of(('width = "19.2 mm"\n', (BORE + LOBE + "\n").replace(old, new)))


def test_remedies_of_the_plan_are_those_that_its_list_would_add():
    """1 % of 4.5 um: a patch and flats of the day, or a rig that has both."""
    settings = tomllib.loads(example_plan())
    settings["film"]["uncertainty"] = 0.01
    bare = plan(PlanSettings.model_validate(settings)).target_std
    assert set(bare["remedy"].values) == {"", "patch", "flats"}
    settings["remedies"] = dict.fromkeys(["patch", "flats"], True)
    has = plan(PlanSettings.model_validate(settings)).target_std
    assert has["remedy"].values.tolist() == [""]
    npt.assert_allclose(has[0], bare[-1], rtol=1e-9)
    settings["systematics"] = {"field": "0 %"}
    without = plan(PlanSettings.model_validate(settings)).target_std
    assert without[0, -1] < 0.6 * has[0, -1]
