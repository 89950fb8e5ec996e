"""A calibration tabulated once, for the statistics of all triggers."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array
from erlif.core.speed.kernels import njit

_FILMS = 20001  # films of the table; its linear interpolation is good to 1e-8 of the log ratio

_BINS = 4000  # bins of log ratio over the calibrated range, far narrower than the noise of a pixel

# The table begins 0.5 um below the calibrated range and ends at 1.5 times its end.
_BELOW, _ABOVE = 0.5, 1.5


@dataclass(frozen=True)
class FilmCurve:
    """Log ratio of a film and film of a log ratio, in tables.

    Attributes
    ----------
    calibration : RatioCurve
        What is tabulated.
    films : Array
        Evenly spaced films beyond both ends of the calibrated range, (film,). [um]
    log_ratio : Array
        Their log ratio, (film,). [1]
    slope : Array
        Its derivative by the film, (film,). [1/um]
    bins : tuple[float, float]
        Log ratio at the ends of the calibrated range. [1]
    film : Array
        Film in the middle of evenly spaced bins of log ratio over the calibrated range, (bin,).
        [um]
    rate : Array
        Its derivative by the log ratio, (bin,). [um]
    curvature : Array
        Its second derivative, (bin,). [um]
    """

    calibration: RatioCurve
    films: Array = field(repr=False)
    log_ratio: Array = field(repr=False)
    slope: Array = field(repr=False)
    bins: tuple[float, float]
    film: Array = field(repr=False)
    rate: Array = field(repr=False)
    curvature: Array = field(repr=False)

    @classmethod
    def of(cls, calibration: RatioCurve) -> FilmCurve:
        """Tabulate a calibration.

        Parameters
        ----------
        calibration : RatioCurve

        Returns
        -------
        FilmCurve
        """
        low, high = calibration.thickness_range
        films = np.linspace(low - _BELOW, _ABOVE * high, _FILMS)

        # film, slope and curvature change slowly with the ratio: once per bin is enough
        first, last = (float(end) for end in calibration.predict_log([low, high]))
        centre = first + (np.arange(_BINS) + 0.5) * (last - first) / _BINS
        film = calibration.inverse.look_up(centre)
        rate = 1 / calibration.slope(film)
        return cls(
            calibration,
            films,
            calibration.predict_log(films),
            calibration.slope(films),
            (first, last),
            film,
            rate,
            np.gradient(rate, centre),
        )

    def at(self, passed: float) -> FilmCurve:
        """Return the curve when a share of the run has passed, as `RatioCurve.at` does."""
        calibration = self.calibration.at(passed)
        if calibration is self.calibration:
            return self
        if calibration.moves:
            return FilmCurve.of(calibration)
        return replace(self, calibration=calibration)

    @property
    def parameters(self) -> int:
        """Number of the parameters of the calibration, with those of its systematics."""
        return len(self.calibration.full_covariance)

    def predict(self, film: Array) -> tuple[Array, Array]:
        """Log ratio and slope of films.

        Parameters
        ----------
        film : array
            Films; those beyond the table are taken for its nearest end. [um]

        Returns
        -------
        log_ratio : array
            Like film. [1]
        slope : array
            Its derivative. [1/um]

        Examples
        --------
        >>> from erlif.show.plots import example_calibration
        >>> calibration = example_calibration()
        >>> log_ratio, slope = FilmCurve.of(calibration).predict(np.array([2.0, 5.0]))
        >>> bool(np.allclose(log_ratio, calibration.predict_log([2.0, 5.0]), atol=1e-8))
        True
        """
        film = np.asarray(film, float)
        found = np.empty((2, film.size))
        _look_up(film.ravel(), self.films, self.log_ratio, self.slope, found)
        log_ratio, slope = found.reshape(2, *film.shape)
        return log_ratio, slope

    def find_bins(self, log_ratio: Array) -> tuple[npt.NDArray[np.intp], Array]:
        """Bins of log ratios, and the distance from the middle of their bins.

        Parameters
        ----------
        log_ratio : array
            Values beyond the calibrated range belong to its first or last bin. [1]

        Returns
        -------
        bin : array of int
        distance : array
            Log ratio less that in the middle of the bin. [1]

        Examples
        --------
        >>> from erlif.show.plots import example_calibration
        >>> curve = FilmCurve.of(example_calibration())
        >>> middle = np.array([0.5 * sum(curve.bins)])
        >>> int(curve.find_bins(middle)[0][0])
        2000
        """
        first, last = self.bins
        width = (last - first) / _BINS
        place = np.clip(((log_ratio - first) / width).astype(np.intp), 0, _BINS - 1)
        return place, log_ratio - first - (place + 0.5) * width


@njit(nogil=True, cache=True, error_model="numpy")
def _look_up(film, films, log_ratio, slope, found):  # type: ignore[no-untyped-def]
    """Interpolate both numbers of each film linearly, as `numpy.interp` does."""
    last = films.size - 1
    per_step = last / (films[last] - films[0])
    for n in range(film.size):
        value = min(max(film[n], films[0]), films[last])
        if value != value:
            found[:, n] = value
            continue

        # even spacing gives the entry below but for the rounding of the table
        k = min(int((value - films[0]) * per_step), last - 1)
        while films[k] > value:
            k -= 1
        while k < last - 1 and films[k + 1] <= value:
            k += 1
        width, beyond = films[k + 1] - films[k], value - films[k]
        found[0, n] = (log_ratio[k + 1] - log_ratio[k]) / width * beyond + log_ratio[k]
        found[1, n] = (slope[k + 1] - slope[k]) / width * beyond + slope[k]
        if value == films[last]:
            found[0, n], found[1, n] = log_ratio[last], slope[last]
