"""The film summed up and set against speed and theory."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.calibration import Calibration
from erlif.core.errors import ConfigError
from erlif.core.products import RatioImages
from erlif.pipeline.joint import describe_joint
from erlif.rig import RigSettings
from erlif.rig.film import draw_marks
from erlif.settings import RunSettings
from erlif.thickness import measure_thickness
from erlif.trend import Region, find_region, fit_exponent, predict_film, summarise_film

K, P, Q = 0.65, 0.40, 0.25
X, Y = 0.06 * np.arange(200), 0.06 * np.arange(160)
WHOLE = {"region": Region(slice(0, Y.size), slice(0, X.size))}


@pytest.fixture
def calibration():
    root = 1e-3 * np.array([[1.4, 0.0, 0.0], [-1.9, 0.8, 0.0], [-0.6, 0.6, 0.3]])
    return Calibration(
        K, P, Q, root @ root.T, (0.2, 16.0), (580.0, 610.0), xr.Dataset(), 1.0, "given"
    )


def log_ratio_of(film):
    return np.log(K * P / Q * (1 - np.exp(-Q * film)) / (1 - np.exp(-P * film)))


def gap(least):
    """Rigid gap with its thinnest line inside the region and a tilt of 0.2 um."""
    return least + ((X - 7.0) ** 2 / (2 * 4.872))[None, :] + 0.2 * (Y / Y[-1])[:, None]


def ratios_of(film, noise, rng):
    dims = ("y", "x")
    values = log_ratio_of(film) + noise * rng.standard_normal(film.shape)
    return RatioImages(
        xr.Dataset(
            {
                "log_ratio": (dims, values.astype(np.float32)),
                "log_ratio_var": (
                    dims,
                    np.broadcast_to(np.square(noise), film.shape).astype(np.float32),
                ),
                "log_ratio_var_shared": (dims, np.zeros(film.shape, np.float32)),
                "flags": (dims, np.zeros(film.shape, np.uint8)),
            }
        )
    )


def statistics(film, noise, rng, calibration):
    ratios = ratios_of(film, noise, rng)
    return summarise_film(
        ratios, measure_thickness(ratios, calibration), calibration, x=X, y=Y, **WHOLE
    )


@pytest.mark.parametrize("least", [0.3, 2.0, 6.0])
def test_least_film_of_the_gap_is_found_through_noise_and_range_limits(calibration, least):
    """At 0.3 um half the pixels of the thin line fall below the range; the fitted gap does not notice."""
    rng = np.random.default_rng(1)
    found = np.array([statistics(gap(least), 0.0135, rng, calibration).minimum for _ in range(12)])
    assert abs(found.mean() - least) < 4 * found.std(ddof=1) / np.sqrt(12) + 1e-3
    assert found.std(ddof=1) < 0.03


def test_uncertainty_of_the_least_film_is_its_scatter(calibration):
    rng = np.random.default_rng(2)
    results = [statistics(gap(3.0), 0.0135, rng, calibration) for _ in range(60)]
    scatter = np.std([r.minimum for r in results], ddof=1)
    claimed = np.mean([r.minimum_random_std for r in results])
    # the scatter of 60 values is known to 9 %
    npt.assert_allclose(claimed, scatter, rtol=0.3)


def test_mean_film_is_freed_of_the_bias_of_a_curved_inverse(calibration):
    """Noise of 3 % biases a single film of 6 um by half a per cent; the mean of the region must not show it."""
    rng = np.random.default_rng(3)
    film = np.full((Y.size, X.size), 6.0)
    ratios = ratios_of(film, 0.03, rng)
    maps = measure_thickness(ratios, calibration)
    raw = float(maps.thickness.mean()) - 6.0
    result = summarise_film(ratios, maps, calibration, x=X, y=Y, **WHOLE)
    assert raw > 0.05
    assert abs(result.mean - 6.0) < 0.25 * raw


def test_share_beyond_the_range_is_told(calibration):
    """A gap of which a known part is thicker than the calibration answers for."""
    film = gap(14.0)
    result = statistics(film, 0.0001, np.random.default_rng(4), calibration)
    npt.assert_allclose(result.beyond_range, (film > 16.0).mean(), atol=0.01)
    assert statistics(gap(2.0), 0.0001, np.random.default_rng(4), calibration).beyond_range == 0


def test_dust_does_not_move_the_gap(calibration):
    rng = np.random.default_rng(4)
    film = gap(3.0)
    ratios = ratios_of(film, 0.01, rng)
    ratios.log_ratio.values[40:60, 100:124] += 0.2
    dusty = summarise_film(
        ratios, measure_thickness(ratios, calibration), calibration, x=X, y=Y, **WHOLE
    )
    assert abs(dusty.minimum - 3.0) < 0.03


def test_change_with_the_calibration_is_the_derivative(calibration):
    """Read the same ratios with a calibration that is a little off: mean and minimum move as their gradients say."""
    rng = np.random.default_rng(5)
    ratios = ratios_of(gap(3.0), 0.002, rng)

    def result(k, p, q):
        used = Calibration(
            k, p, q, calibration.covariance, (0.2, 16.0), (580.0, 610.0), xr.Dataset(), 1.0, "given"
        )
        return summarise_film(ratios, measure_thickness(ratios, used), used, x=X, y=Y, **WHOLE)

    base = result(K, P, Q)
    for n, step in enumerate((2e-4, 2e-4, 2e-4)):
        changed = [K, P, Q]
        changed[n] += step
        moved = result(*changed)
        npt.assert_allclose(moved.mean - base.mean, step * base.mean_gradient[n], rtol=0.03)
        npt.assert_allclose(
            moved.minimum - base.minimum, step * base.minimum_gradient[n], rtol=0.03
        )


def test_turned_image_gives_the_same_film(calibration):
    rng = np.random.default_rng(6)
    ratios = ratios_of(gap(3.0), 0.01, rng)
    turned = RatioImages(ratios.rename(x="y", y="x").transpose("y", "x"))
    one = summarise_film(
        ratios, measure_thickness(ratios, calibration), calibration, x=X, y=Y, **WHOLE
    )
    two = summarise_film(
        turned,
        measure_thickness(turned, calibration),
        calibration,
        x=Y,
        y=X,
        region=Region(slice(0, X.size), slice(0, Y.size)),
        sliding_along_x=False,
    )
    npt.assert_allclose([two.mean, two.minimum], [one.mean, one.minimum], rtol=1e-6)


@pytest.mark.parametrize("power", [0.62, 0.40, 1.0])
def test_exponent_of_a_power_law_is_covered(power):
    """300 noisy power laws: the exponent within one and two standard deviations as often as it should be."""
    rng = np.random.default_rng(7)
    angle = np.linspace(0, 2 * np.pi, 50, endpoint=False)
    speed, load = 2.54 * np.sin(angle), 222 * (1 + 0.01 * np.cos(angle))
    pulls = []
    for _ in range(300):
        film = 6 * (np.abs(speed) / 2.54 * 222 / load) ** power
        std = 0.01 + 0.02 * film
        result = fit_exponent(film + std * rng.standard_normal(50), std, speed=speed, load=load)
        pulls.append((result.value - power) / result.std)
    within = [np.mean(np.abs(pulls) < width) for width in (1, 2)]
    assert abs(within[0] - 0.683) < 3 * 0.027
    assert abs(within[1] - 0.954) < 3 * 0.012


def test_understated_error_bars_are_recognised_by_the_scatter():
    rng = np.random.default_rng(8)
    speed = np.linspace(0.3, 2.5, 40)
    pulls = []
    for _ in range(200):
        film = 5 * speed**0.6 * np.exp(0.05 * rng.standard_normal(40))
        result = fit_exponent(film, np.full(40, 0.001), speed=speed, load=np.full(40, 222.0))
        pulls.append((result.value - 0.6) / result.std)
    assert 0.85 < np.std(pulls) < 1.15


def test_slow_triggers_are_left_out_of_the_exponent():
    speed = np.array([2.5, 2.0, 1.5, 1.0, 0.6, 0.3, 0.2, 0.1])
    film = speed**0.5
    film[-2:] = 100.0  # below a tenth of the top speed
    result = fit_exponent(film, np.full(8, 0.01), speed=speed, load=np.ones(8))
    npt.assert_allclose(result.value, 0.5, atol=1e-6)
    assert result.triggers == 6


def settings(**changes):
    raw = {
        "run": {"name": "test"},
        "camera1": {"files": "a", "band": "580 nm", "offset": "64 DN"},
        "camera2": {"files": "b", "band": "610 nm", "offset": "64 DN"},
        "optics": {"pixel_pitch": "60 um"},
        "encoder": {"file": "encoder.csv"},
        "mechanism": {
            "kind": "crank-rocker",
            "crank": "5.5 cm",
            "coupler": "44 cm",
            "rocker": "26 cm",
            "ground": "51 cm",
            "crank_speed": "114 rpm",
        },
        "joint": {
            "pin_radius": "33.36 mm",
            "bushing_radius": "33.59 mm",
            "length": "237 mm",
            "pin": {"youngs_modulus": "2.7 GPa", "poissons_ratio": 0.37, "roughness": "0.2 um"},
            "bushing": {"youngs_modulus": "2.7 GPa", "poissons_ratio": 0.37, "roughness": "0.2 um"},
        },
        "oil": {"viscosity": "0.12 Pa s", "pressure_viscosity": "20 1/GPa"},
    }
    return RunSettings.model_validate(raw | changes)


def at(speed, load, **more):
    variables = {"sliding_speed": speed, "load": load, **more}
    return xr.Dataset(
        {name: ("trigger", np.atleast_1d(value)) for name, value in variables.items()}
    )


# physics.md section 4, recomputed there: film in um at 0.0842 m/s
@pytest.mark.parametrize(
    ("pounds", "theory", "hamrock_dowson", "regime"),
    [(50, 128.4, 1.92, "isoviscous-rigid"), (1333, 7.05, 1.25, "isoviscous-elastic")],
)
def test_theory_of_the_acrylic_joint(pounds, theory, hamrock_dowson, regime):
    predicted = predict_film(at(0.0842, pounds * 4.4482216), describe_joint(settings()))
    npt.assert_allclose(predicted.film_theory, theory, rtol=3e-3)
    npt.assert_allclose(predicted.film_hamrock_dowson, hamrock_dowson, rtol=4e-3)
    assert predicted.film_theory.attrs["regime"] == regime


def test_film_parameter_is_film_over_combined_roughness():
    predicted = predict_film(at([0.08], [222.0], film_min=[1.0]), describe_joint(settings()))
    npt.assert_allclose(predicted.film_parameter, 1.0 / (0.2 * np.sqrt(2)))


def test_vogel_viscosity_follows_the_logged_temperature():
    """Film of the isoviscous-rigid regime is proportional to viscosity: two temperatures, one ratio."""
    vogel = {
        "oil": {
            "vogel": {"a": "0.0001 Pa s", "b": "900 delta_degC", "c": "-100 degC"},
            "pressure_viscosity": "20 1/GPa",
        }
    }
    predicted = predict_film(
        at([0.0842] * 2, [222.4] * 2, temperature=[25.0, 40.0]), describe_joint(settings(**vogel))
    )
    cold, warm = predicted.film_theory.values
    npt.assert_allclose(cold / warm, np.exp(900 / 125 - 900 / 140), rtol=1e-6)
    with pytest.raises(ConfigError, match="temperature_C"):
        predict_film(at(0.0842, 222.4), describe_joint(settings(**vogel)))


def test_region_outside_the_image_is_refused():
    with pytest.raises(ConfigError, match="at least 32 x 32 pixels"):
        find_region(X, Y, roi=((30, 40), (0, 5)))
    region = find_region(X, Y, roi=((3, 9), (2, 8)))
    rows, columns = region.rows, region.columns
    assert (X[columns][0], X[columns][-1]) == (pytest.approx(3.0), pytest.approx(9.0))
    assert (Y[rows][0], Y[rows][-1]) == (pytest.approx(2.04), pytest.approx(7.98))


@pytest.mark.slow
def test_error_bar_of_the_least_film_covers_turned_and_scratched_surfaces(calibration):
    """Two hundred surfaces with turning marks and scratches of the virtual rig: 68 and 95 % within one and two standard deviations."""
    marks = RigSettings()
    rows, columns = np.indices((Y.size, X.size), dtype=float)
    pulls = []
    for seed in range(200):
        rng = np.random.default_rng([7, seed])
        film = np.maximum(gap(3.0) + draw_marks(marks, rng)(columns + 60, rows + 40), 0.05)
        found = statistics(film, 0.0135, rng, calibration)
        pulls.append(
            (found.minimum - 3.0) / np.hypot(found.minimum_random_std, found.minimum_surface_std)
        )
    within = [np.mean(np.abs(pulls) < width) for width in (1, 2)]
    # 200 draws scatter by 3.3 and 1.5 % about 68.3 and 95.4 %
    assert abs(within[0] - 0.683) < 3 * 0.033
    assert abs(within[1] - 0.954) < 3 * 0.015


def test_scratches_move_the_least_film_by_less_than_their_share(calibration):
    """Lines 3 px wide and 0.4 um high over a tenth of the image raise a mean by 40 nm; the smooth gap must not follow."""
    film = gap(3.0)
    film[:, ::30] += 0.4
    film[:, 1::30] += 0.4
    film[:, 2::30] += 0.4
    found = statistics(film, 0.005, np.random.default_rng(8), calibration)
    assert abs(found.minimum - 3.0) < 0.03


@pytest.mark.parametrize(("least", "noise"), [(9.5, 0.02), (5.0, 0.05)])
def test_mean_film_is_that_of_the_answered_pixels_where_much_lies_beyond_the_range(
    calibration, least, noise
):
    """A gap that leaves the range: no bias by what single pixels lose to the limit."""
    film = gap(least)
    errors = []
    for seed in range(20):
        rng = np.random.default_rng([9, seed])
        ratios = ratios_of(film, noise, rng)
        maps = measure_thickness(ratios, calibration)
        found = summarise_film(ratios, maps, calibration, x=X, y=Y, **WHOLE)
        errors.append((found.mean - film[maps.flags.values == 0].mean()) / found.mean_random_std)
    assert found.beyond_range > 0.05
    assert abs(np.mean(errors)) < 4 / np.sqrt(20)
    assert np.std(errors) < 1.6


def test_region_covered_but_for_one_row_of_blocks_has_no_least_film(calibration):
    """What is left tells no tilt: NaN, not a singular fit."""
    ratios = ratios_of(gap(3.0), 0.01, np.random.default_rng(10))
    ratios.flags.values[8:] = 128
    found = summarise_film(
        ratios, measure_thickness(ratios, calibration), calibration, x=X, y=Y, **WHOLE
    )
    assert np.isnan(found.minimum)
    assert np.isnan(found.minimum_std)
    assert np.isfinite(found.mean)
