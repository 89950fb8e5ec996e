"""Laws of viscosity fitted to measured points, and the constants of common oils.

Vogel (1921) for dynamic and Walther (1931) for kinematic viscosities, by weighted least squares in
the logarithm of the viscosity.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from erlif.core.errors import ModelError
from erlif.core.tables import read_table
from erlif.models.arguments import Values, for_each, formula, warn_of_units
from erlif.models.oil import (
    LOWEST_WALTHER_VISCOSITY,
    WALTHER_SHIFT,
    VogelConstants,
    vogel_viscosity,
)

_CONSTANTS = {"vogel": ("a", "b", "c"), "walther": ("A", "B")}
_QUANTITY = {"vogel": "viscosity", "walther": "kinematic_viscosity"}

# Trial values of Vogel's c.
_BRACKET = 400

# Vogel's c lies at most this far below the coldest point [K]; oils have 80 to 200 K.
_FARTHEST = 500.0


class ViscosityInterval(NamedTuple):
    """Interval of the viscosity of a fitted law.

    Attributes
    ----------
    lower, upper : Values
        Dynamic viscosities of Vogel's law [Pa s], or kinematic ones of Walther's [m2/s].
    """

    lower: Values
    upper: Values


class FittedViscosity(NamedTuple):
    """Viscosity of a fitted law.

    Attributes
    ----------
    value : Values
        Dynamic viscosity of Vogel's law [Pa s], or kinematic one of Walther's [m2/s].
    std : Values
        Standard deviation of the law there. [Pa s or m2/s]
    """

    value: Values
    std: Values


@dataclass(frozen=True)
class ViscosityFit:
    """A law of viscosity with the covariance of its constants.

    Attributes
    ----------
    law : str
        ``"vogel"`` or ``"walther"``.
    constants, std : dict[str, float]
        a [Pa s], b [K] and c [K] of `erlif.models.oil.vogel_viscosity`, or A [1] and B [1] of
        log10 log10(nu + 0.7) = A - B log10 T, with nu in mm2/s and T in K; and their standard
        deviations.
    covariance : array of shape (k, k)
        Of ln a, b and c, or of A and B. [1 and K, or 1]
    scatter : float
        Departure of the points from the law, as a ratio: root of the sum of squares over points
        less constants; NaN where there are as many. [1]
    degrees_of_freedom : float
        Of the standard deviations: points less constants where they follow from the scatter,
        infinite where `relative_std` was given. [1]

    Notes
    -----
    A 95 % interval is a value plus and minus 1.96 standard deviations only where
    `degrees_of_freedom` is infinite. Else the factor is Student's, ``scipy.stats.t.ppf(0.975,
    fit.degrees_of_freedom)``: 4.30 for 2 degrees of freedom, 2.78 for 4 and 2.23 for 10; 1.96 would
    hold 81 % of the true values at 2. `interval` takes this factor.
    """

    law: str
    constants: dict[str, float]
    std: dict[str, float]
    covariance: NDArray[np.float64]
    scatter: float
    degrees_of_freedom: float = np.inf

    @formula()
    def viscosity(self, temperature: Values) -> FittedViscosity:
        """Viscosity with its standard deviation at a temperature.

        Parameters
        ----------
        temperature : float or array
            Temperature, above c. [K]

        Returns
        -------
        FittedViscosity
            Dynamic viscosity [Pa s] or kinematic viscosity [m2/s], and its standard deviation.

        Raises
        ------
        ModelError
            A temperature that is not positive, or not above c.

        Examples
        --------
        >>> from erlif.models.oil_fit import fit_viscosity
        >>> fit = fit_viscosity(
        ...     [298.15, 313.15, 333.15, 353.15, 373.15],
        ...     viscosities=[0.300, 0.120, 0.0461, 0.0227, 0.0133],
        ...     relative_std=0.01,
        ... )
        >>> found = fit.viscosity(323.15)
        >>> print(f"{found.value:.4f} ± {found.std:.4f} Pa s")
        0.0715 ± 0.0005 Pa s
        """
        # to first order in the logarithm
        first, *others = self.constants.values()
        if self.law == "vogel":
            value = vogel_viscosity(temperature, **self.constants)
            _, slopes = _vogel(temperature, np.log(first), *others)
        else:
            logarithm, slopes = _walther(temperature, first, *others)
            value = np.exp(logarithm)
        variance = 0.0
        for i, one in enumerate(slopes):
            for j, other in enumerate(slopes):
                variance = variance + self.covariance[i, j] * one * other
        return FittedViscosity(value, value * np.sqrt(np.maximum(variance, 0.0)))

    def interval(self, temperature: Values, *, probability: float = 0.95) -> ViscosityInterval:
        """Interval that holds the viscosity at a temperature with a probability.

        The relative standard deviation of the law times Student's factor for `degrees_of_freedom`,
        below and above the logarithm of the viscosity.

        Parameters
        ----------
        temperature : float or array
            Temperature, above c. [K]
        probability : float
            Share of such intervals that hold the true viscosity, between 0 and 1. [1]

        Returns
        -------
        ViscosityInterval
            Lower and upper end: dynamic viscosity [Pa s] or kinematic viscosity [m2/s].

        Raises
        ------
        ModelError
            A temperature that is not positive, or not above c; a probability outside 0 to 1.

        Examples
        --------
        Five points without a stated error leave 2 degrees of freedom, a factor of 4.30:

        >>> from erlif.models.oil_fit import fit_viscosity
        >>> fit = fit_viscosity(
        ...     [298.15, 313.15, 333.15, 353.15, 373.15],
        ...     viscosities=[0.300, 0.120, 0.0461, 0.0227, 0.0133],
        ... )
        >>> lower, upper = fit.interval(323.15)
        >>> print(f"{fit.degrees_of_freedom:.0f}: {lower:.4f} to {upper:.4f} Pa s")
        2: 0.0686 to 0.0746 Pa s
        """
        from scipy.stats import t  # at use, as all solvers of the theories

        if not 0 < probability < 1:
            raise ModelError(
                f"probability must lie between 0 and 1, got {probability!r}. Give 0.95 for 95 %."
            )
        value, std = self.viscosity(temperature)
        factor = float(t.ppf(0.5 + probability / 2, self.degrees_of_freedom))
        ratio = np.exp(factor * std / value)
        return ViscosityInterval(value / ratio, value * ratio)


@formula(viscosities="number")
def fit_viscosity(
    temperatures: Values,
    *,
    viscosities: Values,
    law: str = "vogel",
    relative_std: Values | None = None,
) -> ViscosityFit:
    """Fit Vogel's or Walther's law to measured viscosities by least squares.

    Parameters
    ----------
    temperatures : array of shape (n,)
        Temperatures, in any order. [K]
    viscosities : array of shape (n,)
        Dynamic viscosities for ``"vogel"`` [Pa s], kinematic ones for ``"walther"`` [m2/s].
    law : {"vogel", "walther"}
        Three constants or two.
    relative_std : float or array of shape (n,), optional
        Standard deviation of each viscosity over its value [1]; default: equal for all, and found
        from the scatter of the points, which takes one point more than there are constants.

    Returns
    -------
    ViscosityFit
        Constants with standard deviations, and the law with its own at any temperature.

    Raises
    ------
    ModelError
        Too few points, values that are not positive, a kinematic viscosity below 2 mm2/s, another
        law, or points that do not determine the constants.

    Notes
    -----
    A systematic error that all points share, of the viscometer for example, is not in the standard
    deviations. Without `relative_std` these follow from few points: an interval takes Student's
    factor in place of 1.96, which `ViscosityFit.interval` applies.

    Examples
    --------
    Five points with an error of 1 %:

    >>> fit = fit_viscosity(
    ...     [298.15, 313.15, 333.15, 353.15, 373.15],
    ...     viscosities=[0.300, 0.120, 0.0461, 0.0227, 0.0133],
    ...     relative_std=0.01,
    ... )
    >>> print(f"c = {fit.constants['c']:.0f} ± {fit.std['c']:.0f} K")
    c = 192 ± 4 K
    """
    from scipy.optimize import least_squares  # at use, as all solvers of the theories

    if law not in _CONSTANTS:
        raise ModelError(f"Expected vogel or walther as law, got {law!r}. Choose one of them.")
    T, viscosity = np.asarray(temperatures, float), np.asarray(viscosities, float)
    known = len(_CONSTANTS[law]) + (relative_std is None)
    if T.ndim != 1 or T.shape != viscosity.shape or np.unique(T[~np.isnan(T)]).size < known:
        raise ModelError(
            f"Expected temperatures and viscosities of one length, at {known} or more different "
            f"temperatures, got shapes {T.shape} and {viscosity.shape}. Measure more points"
            f"{', or give relative_std' if relative_std is None else ''}."
        )
    if np.any(np.isnan(T)) or np.any(np.isnan(viscosity)):
        raise ModelError("temperatures and viscosities must not be NaN. Leave those points out.")

    spread = 1.0 if relative_std is None else relative_std
    spread = for_each(T.size, "viscosity", relative_std=spread)
    warn_of_units(_QUANTITY[law], viscosities=viscosities)
    law_at = _vogel if law == "vogel" else _walther

    def residuals_at(constants: Values) -> Values:
        return (law_at(T, *constants)[0] - np.log(viscosity)) / spread

    def slopes_at(constants: Values) -> Values:
        return np.stack(law_at(T, *constants)[1], axis=1) / spread[:, None]

    # Vogel's c lies below the coldest point
    start = _start_vogel(T, viscosity, spread) if law == "vogel" else _start_walther(T, viscosity)
    highest = [np.inf, np.inf, T.min()][: len(start)]
    fit = least_squares(
        residuals_at,
        start,
        slopes_at,
        bounds=(-np.inf, highest),
        x_scale="jac",
        xtol=1e-14,
        ftol=1e-14,
        gtol=1e-14,
    )
    values, slopes, residuals = np.array(fit.x), np.asarray(fit.jac, float), fit.fun

    freedom = T.size - values.size
    scatter = np.sqrt(np.sum((residuals * spread) ** 2) / freedom) if freedom else np.nan
    covariance = np.linalg.inv(slopes.T @ slopes)
    if relative_std is None:
        covariance = covariance * scatter**2
    std = np.sqrt(np.diag(covariance))
    if law == "vogel":  # the first is the logarithm of a
        values[0] = np.exp(values[0])
        std[0] *= values[0]
    names = _CONSTANTS[law]
    return ViscosityFit(
        law,
        dict(zip(names, values.tolist(), strict=True)),
        dict(zip(names, std.tolist(), strict=True)),
        covariance,
        float(scatter),
        np.inf if relative_std is not None else float(freedom),
    )


def sae_oil(grade: int) -> VogelConstants:
    """Constants of Vogel's law of a mineral engine oil. Seireg and Dandage (1982).

    Parameters
    ----------
    grade : int
        SAE 10, 20, 30, 40, 50 or 60.

    Returns
    -------
    VogelConstants
        a [Pa s], b [K] and c [K] of `erlif.models.oil.vogel_viscosity`.

    Raises
    ------
    ModelError
        Another grade.

    Notes
    -----
    The source writes mu = mu0 exp(b / (T + 95)) in microreyn and degrees Fahrenheit. Oils of one
    grade differ: the grade fixes the viscosity at 100 degrees Celsius to about 15 % only. Measure
    the oil of a test.

    Examples
    --------
    >>> from erlif.models.oil import vogel_viscosity
    >>> print(f"{vogel_viscosity(373.15, **sae_oil(30)._asdict()) * 1e3:.1f} mPa s")
    8.2 mPa s
    """
    return VogelConstants(**_of_grade("SAE", grade))


def iso_vg_viscosity(grade: int) -> tuple[float, float]:
    """Lowest and highest kinematic viscosity of an ISO viscosity grade at 40 degrees. ISO 3448.

    Parameters
    ----------
    grade : int
        2 to 3200.

    Returns
    -------
    lowest, highest : float
        10 % below and above the midpoint. [m2/s]

    Raises
    ------
    ModelError
        Another grade.

    Examples
    --------
    >>> lowest, highest = iso_vg_viscosity(150)
    >>> print(f"{lowest * 1e6:.0f} to {highest * 1e6:.0f} mm2/s")
    135 to 165 mm2/s
    """
    midpoint = _of_grade("ISO VG", grade)
    return 0.9 * midpoint, 1.1 * midpoint


def _vogel(temperature: Values, log_a: float, b: float, c: float) -> tuple[Values, list[Values]]:
    """Logarithm of the viscosity by Vogel's law, and its slopes by ln a, b and c."""
    inverse = 1 / (temperature - c)
    return log_a + b * inverse, [1.0 + 0 * inverse, inverse, b * inverse**2]


def _walther(temperature: Values, A: float, B: float) -> tuple[Values, list[Values]]:
    """Logarithm of the kinematic viscosity by Walther's law, and its slopes by A and B."""
    logarithm = np.log10(temperature)
    w = A - B * logarithm
    shifted = 10 ** (10**w)
    slope = np.log(10) ** 2 * 10**w * shifted / (shifted - WALTHER_SHIFT)
    return np.log((shifted - WALTHER_SHIFT) * 1e-6), [slope, -logarithm * slope]


def _start_vogel(T: Values, viscosity: Values, spread: Values) -> list[float]:
    """The best of many trial values of c."""
    y, coldest = np.log(viscosity), T.min()

    # for a given c the law is a line in 1/(T - c)
    distance = np.geomspace(1e-3 * (T.max() - coldest), _FARTHEST, _BRACKET)
    constant, slope, error = _line(1 / (T - coldest + distance[:, None]), y, spread)
    best = int(np.argmin(error))
    if best in (0, _BRACKET - 1):
        raise ModelError(
            "viscosities must fall with temperature, ever more slowly, for a Vogel curve through "
            "them; these points do not determine c. Measure over a wider range of temperatures, or "
            "take law='walther'."
        )

    return [constant[best], slope[best], coldest - distance[best]]


def _line(x: Values, y: Values, spread: Values) -> tuple[Values, Values, Values]:
    """Constant and slope of weighted lines along the last axis, and the sums of squares left."""
    weight = 1 / spread**2 / np.sum(1 / spread**2)
    x_mean, y_mean = np.sum(weight * x, axis=-1), np.sum(weight * y)
    away, rise = x - x_mean[..., None], y - y_mean
    slope = np.sum(weight * away * rise, axis=-1) / np.sum(weight * away**2, axis=-1)
    left = np.sum(weight * (rise - slope[..., None] * away) ** 2, axis=-1)
    return y_mean - slope * x_mean, slope, left


def _start_walther(T: Values, viscosity: Values) -> list[float]:
    """A line through the points in the scales of the law."""
    if np.any(viscosity < LOWEST_WALTHER_VISCOSITY):
        raise ModelError(f"viscosities must be at least 2e-6 m2/s, got {viscosity.min():g}.")
    w = np.log10(np.log10(viscosity * 1e6 + WALTHER_SHIFT))
    slope, constant = np.polyfit(np.log10(T), w, 1)
    if not slope < 0:
        raise ModelError(
            "viscosities must fall with temperature for Walther's law, and these do not. Check "
            "which viscosity belongs to which temperature."
        )
    return [constant, -slope]


def _of_grade(system: str, grade: int) -> Any:
    """Row of the table of oils for a viscosity grade."""
    rows = read_table("erlif.models", "oils.toml")[system]
    table = {int(name): row for name, row in rows.items()}
    if grade not in table:
        raise ModelError(
            f"Expected one of the grades {', '.join(rows)} of {system}, got {grade!r}. Choose one "
            "of them, or fit measured points with fit_viscosity."
        )
    return table[grade]
