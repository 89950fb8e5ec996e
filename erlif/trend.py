"""The measured film against kinematics and theory. Here the laboratory's units meet the models' SI."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.calibration import Calibration
from erlif.config import RunSettings
from erlif.core.errors import ConfigError
from erlif.core.flags import Flag
from erlif.core.products import RatioImages, ThicknessMaps, require
from erlif.kinematics import entrained_stroke
from erlif.models.contact import conformal_radius, contact_modulus
from erlif.models.film import dowson_higginson_film, film_parameter, line_contact_film
from erlif.models.oil import vogel_viscosity

Array = npt.NDArray[np.float64]

SLOWEST = 0.1
"""Triggers below this share of the top speed are left out of the speed exponent."""

_BLOCK = 8  # pixels averaged before the gap is fitted
_CLIP = 4.685  # standard deviations off the gap at which a block has lost its say; 95 % efficient where noise is normal
_LAG = 3  # strips of blocks over which the marks of a surface go together
_STRIPS_PER_LAG = 6
_LEAST_BLOCKS = 16
_MOST_STEPS = 30


@dataclass(frozen=True)
class FilmStatistics:
    """Film of one trigger, summed up over the region of interest.

    Attributes
    ----------
    mean, mean_std, minimum, minimum_std : float
        [um]; the standard deviations hold random and shared errors.
    mean_gradient, minimum_gradient : array, (parameter,)
        Change of mean and minimum with what was fitted to the fixture, in the order of `Calibration.full_covariance`.
    mean_random_std, minimum_random_std : float
        Parts of them that are new at every trigger. [um]
    minimum_surface_std : float
        Part of minimum_std that the surfaces leave, marks and waviness about a smooth gap; the same at every trigger. [um]
    censored : float
        Share of the region whose film is too thin or too thick to be answered. The mean is that of the rest and leans to the
        other side; the minimum is not touched. [1]
    """

    mean: float
    mean_std: float
    mean_random_std: float
    mean_gradient: Array
    minimum: float
    minimum_std: float
    minimum_random_std: float
    minimum_surface_std: float
    minimum_gradient: Array
    censored: float


def region_mask(settings: RunSettings, x: Array, y: Array) -> tuple[slice, slice]:
    """Rows and columns of the region of interest.

    Raises
    ------
    ConfigError
        If fewer than 32 x 32 pixels of the image lie in it.
    """
    roi = settings.thickness.roi
    if roi is None:
        return slice(0, y.size), slice(0, x.size)
    columns = slice(
        int(np.searchsorted(x, roi.x[0])), int(np.searchsorted(x, roi.x[1], side="right"))
    )
    rows = slice(int(np.searchsorted(y, roi.y[0])), int(np.searchsorted(y, roi.y[1], side="right")))
    if columns.stop - columns.start < 32 or rows.stop - rows.start < 32:
        raise ConfigError(
            f"Expected a region of interest of at least 32 x 32 pixels within the image, x 0 to {x[-1]:.2f} mm and y 0 to "
            f"{y[-1]:.2f} mm; [thickness] roi is x = [{roi.x[0]:g}, {roi.x[1]:g}], y = [{roi.y[0]:g}, {roi.y[1]:g}]."
        )
    return rows, columns


def summarise_film(
    ratios: RatioImages,
    maps: ThicknessMaps,
    calibration: Calibration,
    *,
    x: Array,
    y: Array,
    rows: slice,
    columns: slice,
    sliding_along_x: bool = True,
) -> FilmStatistics:
    """Mean and least film of one trigger over a region.

    The mean is that of the film within the range, freed of the bias that noise leaves where the inverse of the ratio is curved. The
    minimum is that of a smooth gap, a parabola along the sliding direction plus a tilt across it, whose ratio is fitted to
    the measured ratio with weights: no pixel is lost to the limits of the range, and none is trusted alone.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (y, x) of the trigger.
    maps : ThicknessMaps
        What `measure_thickness` made of it.
    calibration : Calibration
    x, y : array
        Pixel positions. [mm]
    rows, columns : slice
        The region of interest.
    sliding_along_x : bool
        Whether image x is the sliding direction.

    Returns
    -------
    FilmStatistics
        NaN where the region holds too few valid pixels.
    """
    require(ratios, "log_ratio", "log_ratio_var", "flags")
    mean, mean_random, mean_gradient = _mean_film(ratios, maps, calibration, rows, columns)
    minimum, minimum_random, minimum_surface, minimum_gradient = _least_film(
        ratios, calibration, x, y, rows, columns, sliding_along_x=sliding_along_x
    )
    covariance = calibration.full_covariance
    return FilmStatistics(
        mean,
        math.sqrt(mean_random**2 + float(mean_gradient @ covariance @ mean_gradient)),
        mean_random,
        mean_gradient,
        minimum,
        math.sqrt(
            minimum_random**2
            + minimum_surface**2
            + float(minimum_gradient @ covariance @ minimum_gradient)
        ),
        minimum_random,
        minimum_surface,
        minimum_gradient,
        _share_beyond_range(maps.flags.values[rows, columns]),
    )


def _share_beyond_range(flags: npt.NDArray[np.uint8]) -> float:
    """Share of the pixels with light and without other fault whose film lies beyond the range of the calibration."""
    beyond = (flags == Flag.BELOW_RANGE) | (flags == Flag.ABOVE_RANGE)
    sound = int((flags == 0).sum()) + int(beyond.sum())
    return float(beyond.sum()) / sound if sound else 0.0


def _mean_film(
    ratios: RatioImages, maps: ThicknessMaps, calibration: Calibration, rows: slice, columns: slice
) -> tuple[float, float, Array]:
    """Mean over the pixels within the range, whatever their own noise made of them.

    The inverse of the ratio is taken about the mean ratio of each pixel's surroundings, to second order in what the pixel differs
    from that: h(m) + h' (r - m) + h'' ((r - m)^2 - variance) / 2, whose mean is that of the film however large the noise is.
    """
    near = maps.log_ratio_near.values[rows, columns]
    good = np.isfinite(near)
    if good.sum() < 64:
        return math.nan, math.nan, np.full(len(calibration.full_covariance), math.nan)
    near = near[good].astype(float)
    off = ratios.log_ratio.values[rows, columns][good] - near
    variance = ratios.log_ratio_var.values[rows, columns][good].astype(float)
    displaced = ratios.log_ratio_var_shared.values[rows, columns][good].astype(float)
    # film, slope, curvature and gradient change slowly with the ratio: evaluate them once per narrow bin
    first, last = calibration.predict_log(calibration.thickness_range)
    bins = 4000
    place = np.clip(((near - first) * (bins / (last - first))).astype(np.intp), 0, bins - 1)
    centre = first + (np.arange(bins) + 0.5) * (last - first) / bins
    table = calibration.inverse
    film = np.interp(
        centre, table.start + table.step * np.arange(table.thickness.size), table.thickness
    )
    rate = 1 / calibration.slope(film)
    curvature = np.gradient(rate, centre)  # of thickness over the logarithm of the ratio
    count = np.bincount(place, minlength=bins)
    size = near.size
    off += near - centre[place]
    linear, square = (np.bincount(place, values, bins) for values in (off, off**2 - variance))
    mean = float((film * count + rate * linear + 0.5 * curvature * square).sum()) / size
    gradient = -(calibration.gradient(film) * rate * count).sum(axis=1) / size
    random = (
        math.sqrt(
            _correlation(ratios) * float((rate**2 * np.bincount(place, variance, bins)).sum())
        )
        / size
    )
    registration = math.sqrt(float((rate**2 * np.bincount(place, displaced, bins)).sum())) / size
    # neighbours share the displacement error but not the sign of the gradient it meets: correlated over about 8 pixels
    return mean, math.hypot(random, _BLOCK * registration), gradient


def _correlation(ratios: RatioImages) -> float:
    """By how much the variance of a mean over pixels exceeds that of independent ones."""
    return float(ratios.noise_correlation) if "noise_correlation" in ratios else 1.0


def _least_film(
    ratios: RatioImages,
    calibration: Calibration,
    x: Array,
    y: Array,
    rows: slice,
    columns: slice,
    *,
    sliding_along_x: bool,
) -> tuple[float, float, float, Array]:
    """Fit h = a + b s + c z + d s^2 (s along sliding, z across, both -1 to 1 over the region) to the ratio."""
    nothing = (math.nan, math.nan, math.nan, np.full(len(calibration.full_covariance), math.nan))
    blocks = _block_means(ratios, x, y, rows, columns, sliding_along_x=sliding_along_x)
    value, noise = blocks.log_ratio, blocks.variance
    low, high = calibration.thickness_range
    design = np.column_stack(
        [np.ones_like(value), blocks.along, blocks.across, blocks.along_squared]
    )
    limits = calibration.predict_log([low, high])
    start = np.interp(
        value, calibration.predict_log(np.linspace(low, high, 500)), np.linspace(low, high, 500)
    )
    use = (value > limits[0]) & (value < limits[1])
    if not _determine_a_gap(blocks, use):
        return nothing
    gap = np.linalg.lstsq(design[use], start[use], rcond=None)[0]
    trust = use.astype(float)
    surface = 0.0  # variance of the film about a smooth gap beyond that of the noise [um2]
    for step in range(_MOST_STEPS):
        film = np.clip(design @ gap, low - 0.5, 1.5 * high)
        slope = calibration.slope(film)
        residual = value - calibration.predict_log(film)
        if step >= 2:
            # choose by the fitted gap, never by the noisy value, so that the choice leaves no bias
            use = film < high
            if not _determine_a_gap(blocks, use):
                return nothing
            surface = _excess_variance(residual[use] / slope[use], noise[use] / slope[use] ** 2)
            # biweight (Beaton and Tukey 1974): scratches, dust and unseen bubbles lose their say
            square = np.clip(1 - (residual / _CLIP) ** 2 / (noise + slope**2 * surface), 0, None)
            trust = np.where(use, square**2, 0.0)
            if not _determine_a_gap(blocks, square > 0.2):
                return nothing
            response = np.where(
                use, square * (5 * square - 4), 0.0
            )  # of trust times residual to the residual
        weight = trust / (noise + slope**2 * surface)
        jacobian = design * slope[:, None]
        normal = jacobian.T @ (jacobian * weight[:, None])
        change = np.linalg.solve(normal, jacobian.T @ (weight * residual))
        gap = gap + change
        if step > 2 and np.abs(change).max() < 1e-4:
            break
    _, b, c, d = gap
    place = float(np.clip(-b / (2 * d), -1, 1)) if d > 0 else -math.copysign(1.0, b)
    at = np.array([1.0, place, -math.copysign(1.0, c), place**2])
    curvature = jacobian.T @ (jacobian * (response / (noise + slope**2 * surface))[:, None])
    pull = jacobian @ np.linalg.solve(curvature, at)
    by_block = (
        pull * response / (noise + slope**2 * surface)
    )  # change of the least film with the ratio of each block
    score = pull * weight * residual
    random = float((score**2 * noise / (noise + slope**2 * surface)).sum())
    total = max(
        _variance_by_strips(score, strip) for strip in (blocks.strip_along, blocks.strip_across)
    )
    by_parameter = -calibration.gradient(film) @ by_block
    return (
        float(at @ gap),
        math.sqrt(random),
        math.sqrt(max(total - random, 0.0)),
        np.asarray(by_parameter),
    )


def _determine_a_gap(blocks: _Blocks, use: npt.NDArray[np.bool_]) -> bool:
    """Whether the chosen blocks tell a parabola along sliding and a tilt across."""
    along, across = (
        np.unique(strip[use]).size for strip in (blocks.strip_across, blocks.strip_along)
    )
    return bool(use.sum() >= _LEAST_BLOCKS and along >= 4 and across >= 3)


def _excess_variance(residual: Array, variance: Array) -> float:
    """Variance that residuals have beyond their own, by their median absolute deviation."""
    excess = 0.0
    for _ in range(20):
        scale = 1.4826 * float(np.median(np.abs(residual) / np.sqrt(variance + excess)))
        change = (scale**2 - 1) * float(np.median(variance + excess))
        excess = max(excess + change, 0.0)
        if abs(change) < 1e-3 * float(np.median(variance)) or excess == 0.0:
            break
    return excess


def _variance_by_strips(score: Array, strip: npt.NDArray[np.intp]) -> float:
    """Variance of a sum whose terms go together within a strip and, less and less, with the next strips (Newey and West 1987).

    The fit has taken from few strips a good part of what they share, so their number is corrected for, and where there are few,
    each is taken by itself.
    """
    sums = np.bincount(strip, score)
    count = np.unique(strip).size
    lags = min(max(count // _STRIPS_PER_LAG, 1), _LAG)
    total = float((sums**2).sum())
    for lag in range(1, lags):
        total += 2 * (1 - lag / lags) * float((sums[lag:] * sums[:-lag]).sum())
    return total * count / (count - 1)


@dataclass(frozen=True)
class _Blocks:
    """Log ratio averaged over blocks; places along and across sliding run from -1 to 1 over the region."""

    log_ratio: Array
    variance: Array
    along: Array
    along_squared: Array
    across: Array
    strip_along: npt.NDArray[np.intp]  # number of the strip that runs along sliding
    strip_across: npt.NDArray[np.intp]


def _block_means(
    ratios: RatioImages, x: Array, y: Array, rows: slice, columns: slice, *, sliding_along_x: bool
) -> _Blocks:
    """Average the log ratio over blocks, all pixels of a block alike: weights would go with the noise of its pixels."""
    total = _sum_blocks(
        ratios.log_ratio.values[rows, columns],
        ratios.log_ratio_var.values[rows, columns],
        ratios.flags.values[rows, columns],
        np.linspace(-1, 1, x[columns].size),
        np.linspace(-1, 1, y[rows].size),
        _BLOCK,
    )
    full = total[0] > 0
    down, right = np.nonzero(full)
    count = total[0, full]
    log_ratio, variance, u, uu, v, vv = total[1:, full] / count
    variance *= _correlation(ratios)
    along = (u, uu, v, down, right) if sliding_along_x else (v, vv, u, right, down)
    return _Blocks(log_ratio, variance / count, *along)


@numba.njit(nogil=True, cache=True)
def _sum_blocks(log_ratio, variance, flags, u, v, block):  # type: ignore[no-untyped-def]
    """Count, log ratio, variance, u, u squared, v and v squared, summed over the sound pixels of each block."""
    height, width = log_ratio.shape
    total = np.zeros((7, (height + block - 1) // block, (width + block - 1) // block))
    for i in range(height):
        for j in range(width):
            if flags[i, j] == 0:
                here = total[:, i // block, j // block]
                here[0] += 1.0
                here[1] += log_ratio[i, j]
                here[2] += variance[i, j]
                here[3] += u[j]
                here[4] += u[j] ** 2
                here[5] += v[i]
                here[6] += v[i] ** 2
    return total


def predict_film(triggers: xr.Dataset, settings: RunSettings) -> xr.Dataset:
    """Film that theory expects at the speed and load of each trigger.

    Parameters
    ----------
    triggers : xarray.Dataset
        sliding_speed [m s-1], load [N], and temperature [degree_Celsius] where the oil follows Vogel's law; dim trigger.
    settings : RunSettings

    Returns
    -------
    xarray.Dataset
        film_hamrock_dowson, the 2.65 line-contact formula [um]; film_theory, what the regime map selects [um], with its regimes and
        limits as attributes; film_parameter [1] where roughness is given.
    """
    require(triggers, "sliding_speed", "load")
    joint, oil = settings.joint, settings.oil
    radius = conformal_radius(joint.pin_radius, bushing_radius=joint.bushing_radius)
    modulus = contact_modulus(
        joint.pin.youngs_modulus,
        poisson_1=joint.pin.poissons_ratio,
        youngs_2=joint.bushing.youngs_modulus,
        poisson_2=joint.bushing.poissons_ratio,
    )
    if oil.vogel is not None:
        if "temperature" not in triggers:
            raise ConfigError(
                "Expected a column temperature_C in the encoder log, because [oil] gives the viscosity by Vogel's law; there is none. Log the "
                'temperature, or give viscosity = "0.12 Pa s".'
            )
        viscosity = np.asarray(
            vogel_viscosity(
                triggers.temperature.values + 273.15,
                a=oil.vogel.a,
                b=oil.vogel.b,
                c=oil.vogel.c + 273.15,
            )
        )
    else:
        viscosity = np.full(triggers.sizes["trigger"], oil.viscosity)
    contact = {
        "load_per_length": triggers["load"].values / joint.length,
        "viscosity": viscosity,
        "pressure_viscosity": oil.pressure_viscosity,
        "radius": radius,
        "contact_modulus": modulus,
    }
    speed = (
        triggers.sliding_speed.values / 2
    )  # the bushing surface rests: entrainment is half the sliding speed
    theory = line_contact_film(speed, stroke=entrained_stroke(settings), **contact)
    regimes, count = np.unique(np.asarray(theory.regime), return_counts=True)
    chosen = str(regimes[np.argmax(count)])
    predicted = xr.Dataset(
        {
            "film_hamrock_dowson": (
                "trigger",
                1e6 * np.asarray(dowson_higginson_film(speed, **contact)),
                {"units": "um", "long_name": "line-contact formula, 2.65 G^0.54 U^0.7 W^-0.13"},
            ),
            "film_theory": (
                "trigger",
                1e6 * np.asarray(theory.film),
                {
                    "units": "um",
                    "long_name": f"steady line-contact film, {chosen} regime",
                    "regime": chosen,
                    "regimes_by_trigger": " ".join(str(name) for name in np.asarray(theory.regime)),
                    "reason": "the largest of the four line-contact asymptotes governs; "
                    f"gV = {float(np.median(theory.gV)):.3g}, gE = {float(np.median(theory.gE)):.3g} (medians)",
                    "notes": "\n".join(theory.notes),
                },
            ),
        }
    )
    if (
        joint.pin.roughness is not None
        and joint.bushing.roughness is not None
        and "film_min" in triggers
    ):
        film = np.maximum(triggers.film_min.values, 0.0) * 1e-6
        ratio = film_parameter(
            film, roughness_a=joint.pin.roughness, roughness_b=joint.bushing.roughness
        )
        predicted["film_parameter"] = (
            "trigger",
            ratio,
            {"units": "1", "long_name": "least film over roughness, Lambda"},
        )
    return predicted


@dataclass(frozen=True)
class Exponent:
    """Power of |speed|/load that the film follows, with its standard deviation and the film at the mean."""

    value: float
    std: float
    log_scale: float
    triggers: int


def fit_exponent(
    film: Array,
    random_std: Array,
    *,
    speed: Array,
    load: Array,
    gradient: Array | None = None,
    covariance: Array | None = None,
) -> Exponent:
    """Fit film = c (|speed|/load)^n through its logarithms.

    Triggers slower than a tenth of the fastest are left out: there the film lives on squeeze. The scatter about the line
    decides the weights together with the error bars, and what bends or shifts all films alike adds its share to the standard
    deviation.

    Parameters
    ----------
    film, random_std : array, (trigger,)
        Film and the part of its standard deviation that each trigger has for itself. [um]
    speed, load : array, (trigger,)
        [rad s-1], [N]
    gradient : array, (trigger, n), optional
        Change of the film with what all triggers share: the parameters of the calibration, the marks of the surfaces.
    covariance : array, (n, n), optional
        Of what they share.

    Returns
    -------
    Exponent
        NaN where fewer than five triggers can be used.
    """
    fast = np.abs(speed) >= SLOWEST * np.abs(speed).max()
    use = fast & (film > 0) & np.isfinite(film) & np.isfinite(random_std)
    if use.sum() < 5:
        return Exponent(math.nan, math.nan, math.nan, int(use.sum()))
    x = np.log(np.abs(speed[use]) / load[use])
    y = np.log(film[use])
    own = random_std[use] / film[use]
    design = np.column_stack([np.ones_like(x), x])
    excess = 0.0
    for _ in range(20):
        weight = 1 / (own**2 + excess)
        normal = design.T @ (design * weight[:, None])
        line = np.linalg.solve(normal, design.T @ (weight * y))
        residual = y - design @ line
        chi_square = float((weight * residual**2).sum()) / (x.size - 2)
        if abs(chi_square - 1) < 1e-3 or (chi_square < 1 and excess == 0.0):
            break
        # scatter that the error bars do not explain is taken as the same share of each film
        excess = max(excess + (chi_square - 1) / float(weight.mean()), 0.0)
    inverse = np.linalg.inv(normal)
    variance = float(inverse[1, 1])
    if gradient is not None and covariance is not None:
        change = inverse @ design.T @ (weight[:, None] * (gradient[use] / film[use, None]))
        variance += float(change[1] @ covariance @ change[1])
    return Exponent(float(line[1]), math.sqrt(variance), float(line[0]), int(use.sum()))
