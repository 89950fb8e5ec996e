"""The variance of differences between frames, split into its causes by least squares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy

from erlif.core.arrays import Array, Mask
from erlif.core.detector import QUANTISATION_VAR
from erlif.core.products import References
from erlif.core.statistics import MAD_TO_STD

# Blocks of the image along each axis, whose scatter gives the standard deviations.
BLOCKS = 6

# Prior probability of two cameras with different gains.
_UNLIKE = 0.05

# Relative spread of different gains, prior.
_UNLIKENESS = 0.4

# Degrees of freedom of a standard deviation from the blocks, which do not weigh alike.
_FREEDOM = 10

# Standard deviation of the variance of the response, small enough for a zero result. [1]
_SHARP = 0.005**2

# Standard deviation of the response's variance above which it is undetermined. [1]
_VAGUE = 0.01**2

# Residual from which a cell is left out: marks, bubbles, wrong registration. [robust std]
_OUTLIER = 6


@dataclass(frozen=True)
class NoiseUnknowns:
    """Unknown noise parameters of the cameras.

    Attributes
    ----------
    gain : Mask
        Cameras of unknown gain, (camera,).
    read_noise : Mask
        Cameras of unknown read noise, (camera,).
    response : Mask
        Cameras without a flat, (camera,).

    Examples
    --------
    >>> unknown = NoiseUnknowns(np.array([True, False]), np.array([False, False]), np.array([0, 0]))
    >>> unknown.noise.tolist(), unknown.any
    ([True, False], True)
    """

    gain: Mask
    read_noise: Mask
    response: Mask

    @property
    def noise(self) -> Mask:
        """Cameras whose gain or read noise is unknown."""
        return np.asarray(self.gain | self.read_noise)

    @property
    def any(self) -> bool:
        """Whether frames are needed; they do not determine the response of camera 1 alone."""
        return bool(self.noise.any() or self.response[1])


class NoiseCells(NamedTuple):
    """Cells of differences between two frames: their variance, and that of each cause at unit size.

    Attributes
    ----------
    pixels : Array
        Valid pixels, (cell,).
    block : npt.NDArray[np.int64]
        Block of the image, (cell,).
    variance : Array
        Variance of the difference, (cell,). [1]
    shot : Array
        Variance for a gain of 1 electron/DN, (cell, camera). [1]
    read : Array
        Variance for a dark variance of 1 DN2, (cell, camera). [1]
    pattern : Array
        Variance for a response of camera 2 with a relative variance of 1, (cell,). [1]
    """

    pixels: Array
    block: npt.NDArray[np.int64]
    variance: Array
    shot: Array
    read: Array
    pattern: Array

    @classmethod
    def join(cls, parts: Sequence[NoiseCells]) -> NoiseCells:
        """The cells of several pairs of frames together."""
        # an empty part gives no pairs their types
        none, by_camera = np.zeros(0), np.zeros((0, 2))
        empty = cls(none, none.astype(np.int64), none, by_camera, by_camera, none)
        return cls(*(np.concatenate(column) for column in zip(empty, *parts, strict=True)))


@dataclass(frozen=True)
class NoiseFit:
    """Noise as fitted; zeros where gain or dark was known.

    Attributes
    ----------
    slope : Array
        1/gain, (camera,). [DN/electron]
    slope_covariance : Array
        Covariance of the slopes, (camera, camera). [(DN/electron)2]
    dark : float
        Variance of the dark. [DN2]
    dark_std : float
        Its standard deviation. [DN2]
    response : float
        Relative variance of the response of camera 2, NaN where it was left out. [1]
    response_std : float
        Its standard deviation. [1]
    """

    slope: Array
    slope_covariance: Array
    dark: float
    dark_std: float
    response: float
    response_std: float

    @property
    def determines_response(self) -> bool:
        """Whether the response is determined: with a small error, or clearly above zero."""
        return self.response_std < _SHARP or self.response_std < min(_VAGUE, self.response / 3)


def fit_pixel_noise(
    cells: NoiseCells,
    references: References,
    unknown: NoiseUnknowns,
    *,
    one_gain: bool,
    pattern: bool,
) -> NoiseFit:
    """Split the variance of the cells into light, dark, pattern and a constant.

    The pattern is the response of camera 2 without a flat, which moves with its drift. The constant
    is speckle that alignment and blur leave different in the two cameras.

    Parameters
    ----------
    cells : NoiseCells
    references : References
        Gains and read noises, assumed where unknown, and the flat of camera 2.
    unknown : NoiseUnknowns
    one_gain : bool
        Whether unknown gains of both cameras are one.
    pattern : bool
        Whether the response of camera 2 is fitted.

    Returns
    -------
    NoiseFit
    """
    # variance of the causes that are known
    gain, read_noise = references.gain.values, references.read_noise.values
    known = np.zeros(len(cells.variance))
    for camera in range(2):
        if not unknown.gain[camera]:
            known += cells.shot[:, camera] / gain[camera]
        measured = (read_noise[camera] / gain[camera]) ** 2
        electronic = 0.0 if unknown.read_noise[camera] else measured
        known += cells.read[:, camera] * (electronic + QUANTISATION_VAR)

    # one column for each unknown; `share` assigns the gain columns to the cameras
    share = np.eye(2)[unknown.gain]
    if one_gain and len(share):
        share = share.sum(axis=0, keepdims=True)
    columns = [cells.shot @ cameras for cameras in share]
    if unknown.read_noise.any():
        columns.append(cells.read[:, unknown.read_noise].sum(axis=1))
    if pattern:
        columns.append(cells.pattern)
    elif not unknown.response[1]:
        two = references.isel(camera=1)
        good = ~two.bad.values
        known += cells.pattern * float((two.flat_var.values / two.flat.values**2)[good].mean())
    columns.append(np.ones(len(known)))

    values, covariance = _solve_non_negative(np.stack(columns, axis=1), cells, known)
    gains, dark = len(share), bool(unknown.read_noise.any())
    return NoiseFit(
        slope=values[:gains] @ share,
        slope_covariance=share.T @ covariance[:gains, :gains] @ share,
        dark=float(values[gains]) if dark else 0.0,
        dark_std=float(np.sqrt(covariance[gains, gains])) if dark else 0.0,
        response=float(values[-2]) if pattern else float("nan"),
        response_std=float(np.sqrt(covariance[-2, -2])) if pattern else float("nan"),
    )


def weigh_gains(same: NoiseFit, apart: NoiseFit) -> tuple[NoiseFit, float]:
    """Average the fits for equal and for different gains by their probabilities.

    By Bayes' rule the odds are the prior odds times the ratio of densities of the observed
    difference: equal gains differ by the standard deviation alone, different ones by more. Both
    densities are Student's, because the standard deviation itself comes from a few dozen blocks.

    Parameters
    ----------
    same, apart : NoiseFit
        With one gain, and with two.

    Returns
    -------
    NoiseFit
        For cameras whose gains may be equal or different.
    float
        Probability of equal gains. [1]
    """
    contrast = np.array([1.0, -1.0])
    difference = contrast @ apart.slope
    variance = contrast @ apart.slope_covariance @ contrast
    spread = (_UNLIKENESS * same.slope.mean()) ** 2

    # without any scatter the fits decide by themselves
    if not variance > 0:
        return (same, 1.0) if difference == 0 else (apart, 0.0)
    share = spread / (variance + spread)

    pull = np.array([difference**2 / variance, difference**2 / (variance + spread)])
    density = np.sqrt([1.0, 1 - share]) * (1 + pull / _FREEDOM) ** (-(_FREEDOM + 1) / 2)
    odds = _UNLIKE / (1 - _UNLIKE) * density[1] / density[0]
    alike = float(1 / (1 + odds))

    # different gains, with the prior of their difference
    towards = apart.slope_covariance @ contrast / (variance + spread)
    unlike = apart.slope - towards * difference
    narrowed = apart.slope_covariance - np.outer(towards, towards) * (variance + spread)

    # mean and covariance of the mixture of both
    off = unlike - same.slope
    slope = same.slope + (1 - alike) * off
    between = alike * (1 - alike) * np.outer(off, off)
    covariance = alike * same.slope_covariance + (1 - alike) * narrowed + between
    likelier = same if alike > 0.5 else apart
    return replace(likelier, slope=slope, slope_covariance=covariance), alike


def _solve_non_negative(design: Array, cells: NoiseCells, known: Array) -> tuple[Array, Array]:
    """Least squares with non-negative parameters, and their covariance.

    Cells are weighted by their expected variance, and outliers are left out. The covariance comes
    from the scatter between blocks of the image, so that it includes noise that cells share and
    misfits that depend on the position.
    """
    variance, pixels, block = cells.variance, cells.pixels, cells.block
    scale = design.mean(axis=0)
    design = design / scale

    expected = np.full(variance.shape, np.median(variance))
    keep = np.ones(variance.shape, bool)
    for _ in range(20):  # reweighting settles in about ten rounds
        weight = keep * np.sqrt(pixels) / expected
        values = scipy.optimize.nnls(design * weight[:, None], (variance - known) * weight)[0]
        expected = np.maximum(known + design @ values, 0.1 * np.median(variance))
        off = (variance - expected) / expected * np.sqrt(pixels)
        keep = np.abs(off) < _OUTLIER * MAD_TO_STD * np.median(np.abs(off))

    weight = keep * pixels / expected**2
    inverse = np.linalg.pinv(design.T @ (design * weight[:, None]), hermitian=True)
    pull = (variance - known - design @ values) * weight
    score = np.stack([np.bincount(block, pull * column, BLOCKS**2) for column in design.T], axis=1)
    covariance = inverse @ (score.T @ score) @ inverse * BLOCKS**2 / (BLOCKS**2 - 1)
    return values / scale, covariance / np.outer(scale, scale)
