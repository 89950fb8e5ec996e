"""Refinement of the pose: the profile is moved to where the ratio fits best.

Only what the form of the profile determines is refined, see `erlif.calibration.pose`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

from erlif.calibration.pairing import pair_profile_with_image
from erlif.calibration.points import Points
from erlif.calibration.pose import (
    ACROSS,
    ALONG,
    SCALE,
    TURN,
    FoundPose,
    Freedom,
    Pose,
    Turn,
    find_turn,
)
from erlif.calibration.profile import Profile
from erlif.calibration.regression import Fit, fit_robustly
from erlif.core.arrays import Array
from erlif.core.products import RatioImages

_TURNS = 3  # each turn assigns the pixels anew; the second is already below its error
_STEPS = 10
_CONVERGED = 0.1  # of the standard deviation of each combination
_MOSTLY = 0.5  # share of an element of the pose from which on it counts as determined
_POINTS_PER_KNOT = 15  # each piece of the imitating spline is supported by as many points
_MAXIMUM_KNOTS = 5  # as many as the spline of `erlif.calibration.departure` may have


def refine_pose(
    ratios: RatioImages, profile: Profile, points: Points, given: Pose
) -> tuple[Points, Freedom, FoundPose]:
    """Move, scale and turn the profile until the ratio fits best.

    The turn of a line comes from the image alone, because the film does not change across it.
    Everything else comes from the form of the profile, together with K, p and q (Gauss-Newton
    steps; the pixels are assigned to the CMM points anew after each).

    Parameters
    ----------
    ratios : RatioImages
        Ratio of the fixture, (y, x).
    profile : Profile
        Profile as it was paired.
    points : Points
        CMM points and ratio, paired at the given pose.
    given : Pose
        Pose from fixture.toml.

    Returns
    -------
    Points
        CMM points and ratio, paired at the refined pose.
    Freedom
        Combinations of offset, scale and turn that stay free in the fit that follows.
    FoundPose
        The refined pose, its change and its uncertainty.
    """
    points, pose, turn = _turn_line(ratios, profile, points, given)
    change = np.zeros(4)
    change[TURN] += turn.angle

    for n in range(_STEPS):
        freedom = _freedom_at(points, pose)
        if not freedom.size:
            break
        fit = fit_robustly(points, freedom)
        std = np.sqrt(np.diag(fit.covariance)[-freedom.size :])
        if n == _STEPS - 1 or np.all(np.abs(fit.displacement) < _CONVERGED * std):
            break
        step = freedom.combinations @ fit.displacement
        change += step
        pose = pose.changed(step, freedom.middle)
        points, _ = pair_profile_with_image(ratios, profile, pose)

    covariance = np.diag([0.0, 0.0, 0.0, turn.std**2])
    if freedom.size:
        scale = max(1.0, fit.reduced_chi_square)
        free = fit.covariance[-freedom.size :, -freedom.size :]
        covariance += scale * freedom.combinations @ free @ freedom.combinations.T
    determined = freedom.shares >= _MOSTLY
    determined[TURN] |= turn.std > 0
    return points, freedom, FoundPose(pose, change, covariance, determined)


def _turn_line(
    ratios: RatioImages, profile: Profile, points: Points, pose: Pose
) -> tuple[Points, Pose, Turn]:
    """Turn a line profile until the ratio is constant across it."""
    total, std = 0.0, 0.0
    for _ in range(_TURNS):
        turn = find_turn(points, pixel_pitch=pose.pixel_pitch)
        if turn.angle == 0.0:
            break
        std = turn.std
        total += turn.angle
        pose = pose.changed(np.array([0.0, 0.0, 0.0, turn.angle]), np.zeros(2))
        points, _ = pair_profile_with_image(ratios, profile, pose)
    return points, pose, Turn(total, std)


def _freedom_at(points: Points, pose: Pose) -> Freedom:
    """Changes of the pose that the points determine, outliers left out."""
    freedom = Freedom.none(points)
    # Without stated uncertainty the CMM's comes from the scatter, to which a wrong pose
    # contributes: the second pass estimates it with the pose free.
    for _ in range(1 if points.has_error_bars else 2):
        fit = fit_robustly(points, freedom)
        freedom = find_freedom(points, fit, pixel_pitch=pose.pixel_pitch)
    return freedom


def find_freedom(points: Points, fit: Fit, *, pixel_pitch: float) -> Freedom:
    """Find the changes of pose whose effect on the ratio no change of the curve can imitate.

    All that a smooth function of thickness can imitate is removed from the effect of each change;
    the form of the profile remains. Combinations of offset, scale and turn whose standard
    deviation is below one pixel at the edge of the profile are determined. A straight wedge
    determines none: an offset looks like another K, a scale like other p and q.

    Parameters
    ----------
    points : Points
        CMM points and the ratio there.
    fit : Fit
        The model fitted to them.
    pixel_pitch : float
        Distance of pixels on the profile. [mm]

    Returns
    -------
    Freedom
        Without combinations where the points are too few to separate form from curve.
    """
    kept, slope = fit.kept, fit.slope(fit.true_thickness)
    axes = points.position.shape[1]
    middle = np.zeros(2)
    middle[:axes] = points.position[kept].mean(axis=0)
    reach = float(np.ptp(points.position[kept], axis=0).max()) / 2

    # change of the film under each point; scale and turn are counted in mm at the edge
    along = points.gradient[:, 0]
    if points.on_surface:
        x, y = (points.position - middle).T
        across = points.gradient[:, 1]
        effect = np.column_stack(
            [along, across, (along * x + across * y) / reach, (along * y - across * x) / reach]
        )
        elements = [ALONG, ACROSS, SCALE, TURN]
    else:
        # the film of a line is the same across it; its turn comes from the image, see `find_turn`
        x = points.position[:, 0] - middle[0]
        effect = np.column_stack([along, along * x / reach])
        elements = [ALONG, SCALE]

    std = np.hypot(points.log_ratio_std, fit.thickness_std * slope)[kept]
    shown = effect[kept] * (slope[kept] / std)[:, None]
    imitated = _smooth_functions(fit.true_thickness[kept]) / std[:, None]
    if kept.sum() < 2 * (imitated.shape[1] + shown.shape[1]):
        return Freedom.none(points)

    # Fisher information of the remaining effect; its eigenvectors are independent combinations
    own = shown - imitated @ np.linalg.lstsq(imitated, shown, rcond=None)[0]
    information, vectors = np.linalg.eigh(own.T @ own)
    determined = vectors[:, information * pixel_pitch**2 >= 1]
    units, shares = np.diag([1.0, 1.0, 1 / reach, 1 / reach])[:, elements], np.zeros(4)
    shares[elements] = (determined**2).sum(axis=1)
    return Freedom(effect @ determined, units @ determined, middle, shares)


def _smooth_functions(thickness: Array) -> Array:
    """Cubic B-splines over thickness, (point, function)."""
    inner = min(_MAXIMUM_KNOTS, thickness.size // _POINTS_PER_KNOT)
    low, high = float(thickness.min()), float(thickness.max())
    inside = np.quantile(thickness, np.linspace(0, 1, inner + 2)[1:-1])
    knots = np.concatenate([[low] * 4, inside, [high] * 4])
    return np.asarray(scipy.interpolate.BSpline.design_matrix(thickness, knots, 3).toarray())


def add_uncertainty_of_turn(fit: Fit, points: Points, freedom: Freedom, pose: FoundPose) -> Fit:
    """Add the uncertainty of a line's turn to the covariance of K, p and q.

    Parameters
    ----------
    fit : Fit
        The model fitted at the refined pose.
    points : Points
        What was fitted.
    freedom : Freedom
        Changes of the pose that were free in the fit.
    pose : FoundPose
        The refined pose with the standard deviation of its turn.

    Returns
    -------
    Fit
        The same parameters with the larger covariance; a surface's fit is returned as it is.
    """
    if points.on_surface:
        return fit
    slope = fit.slope(fit.true_thickness)
    design = np.column_stack(
        [fit.gradient(fit.true_thickness).T, slope[:, None] * freedom.displacement]
    )[fit.kept]
    variance = points.log_ratio_std**2 + (slope * fit.thickness_std) ** 2

    # linear response of the parameters to a turn by one standard deviation
    moved: Array = (slope * points.gradient[:, 0] * points.mean_across / variance)[fit.kept]
    response = fit.covariance @ design.T @ moved * pose.standard_deviations[TURN]
    return replace(fit, covariance=fit.covariance + np.outer(response, response))
