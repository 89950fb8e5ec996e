"""Temperature of the oil: the ratio of each frame as it were at the temperature of the fixture."""

from __future__ import annotations

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.io.ingest import Run
from erlif.io.settings import TemperatureOptions
from erlif.pipeline.chain import FrameChain


def read_warming(run: Run, calibration: Calibration) -> Array | None:
    """Temperature of the oil over that of the fixture.

    Parameters
    ----------
    run : Run
    calibration : Calibration

    Returns
    -------
    array, (frame,), or None
        None where the settings state no change with temperature. [K]

    Raises
    ------
    ConfigError
        If log or calibration has no temperature.
    """
    if run.settings.temperature.coefficient is None:
        return None
    if "temperature" not in run.log:
        raise ConfigError(
            "Expected the temperature of the oil in the log, because [temperature] states how the "
            "light changes with it; there is no column temperature. Add it to the log, name it as "
            "temperature in [encoder], or remove [temperature]."
        )
    if calibration.temperature is None:
        raise ConfigError(
            "Expected the temperature of the fixture, because [temperature] states how the light "
            f"changes with it; the calibration {calibration.fixture!r} has none. Add temperature = "
            '"23 degC" to [fixture] in fixture.toml and calibrate again, or remove [temperature].'
        )
    return np.asarray(run.log.temperature.values, float) - calibration.temperature


def without_warming(
    chain: FrameChain, warmer: Array | None, options: TemperatureOptions
) -> FrameChain:
    """Correct the ratios of a chain to the temperature of the fixture.

    Parameters
    ----------
    chain : FrameChain
    warmer : array, (frame,), or None
        As `read_warming` returns it.
    options : TemperatureOptions

    Returns
    -------
    FrameChain
        The same where `warmer` is None.
    """
    if warmer is None or options.coefficient is None:
        return chain
    return chain.without(options.coefficient * warmer)


def error_of_warming(warmer: Array, options: TemperatureOptions) -> Array:
    """Covariance of the residual change of the ratio after the temperature correction.

    Parameters
    ----------
    warmer : array, (frame,)
        Temperature over that of the fixture. [K]
    options : TemperatureOptions
        With a coefficient.

    Returns
    -------
    array, (2, 2)
        At the first frame, and of what grows from nothing to the last, as the term `temperature`.
        [1]

    Examples
    --------
    A coefficient known to 0.02 %/K, in a run 10 K warmer than its fixture:

    >>> options = TemperatureOptions(
    ...     camera1="-0.2 %/K", camera2="-0.1 %/K", std="0.02 %/K", reading_std="0 K"
    ... )
    >>> np.sqrt(np.diag(error_of_warming(np.full(5, 10.0), options))).round(6)
    array([0.002, 0.   ])
    """
    assert options.coefficient is not None
    assert options.std is not None
    passed = np.linspace(0.0, 1.0, warmer.size)
    rise, start = np.polyfit(passed, warmer, 1) if warmer.size > 1 else (0.0, float(warmer[0]))
    course = np.array([start, rise])
    by_coefficient = (options.std / 100) ** 2 * np.outer(course, course)
    return by_coefficient + (options.coefficient * options.reading_std) ** 2 * np.eye(2)
