"""Titles and captions of the figures in the report."""

from __future__ import annotations

from dataclasses import dataclass, replace

import xarray as xr

from erlif.io.files import settings_of
from erlif.show.plots.triggers import has_varying_speed


@dataclass(frozen=True)
class Caption:
    """Text of a figure, and the format of its image.

    Attributes
    ----------
    title : str
        Heading of the figure.
    text : str
        What the figure shows, panel by panel.
    kind : str
        ``"svg"`` for lines, ``"png"`` for images.
    dpi : float
        Resolution of an image. [pixel/inch]
    """

    title: str
    text: str
    kind: str = "svg"
    dpi: float = 150.0


CAPTIONS = {
    "speed_against_angle": Caption(
        "Speed of the joint against encoder angle",
        "The line is the kinematics of the linkage; the points are the triggers: filled circles "
        "for rising angle, open squares for falling angle. Right axis: surface speed of the pin.",
    ),
    "fixture_profile": Caption(
        "Profile of the calibration fixture",
        "Thickness by the coordinate measuring machine (CMM); bars are one standard deviation "
        "where the profile gives it. Shaded: calibrated range.",
    ),
    "processed_images": Caption(
        "Processed images of one trigger",
        "Both bands after correction by dark and flat, on one colour scale; camera 2 is resampled "
        "onto the pixel grid of camera 1. Grey: outside the image of camera 2.",
        "png",
    ),
    "ratio_image": Caption(
        "Ratio of the two images",
        "Camera 2 over camera 1, which rises with film thickness: the ratio that the map was "
        "computed from. Grey: flagged.",
        "png",
    ),
    "calibration": Caption(
        "Calibration",
        "(a) Ratio against thickness with the fitted reabsorption model and its 95 % band; bars "
        "are one standard deviation and include the error of the CMM. (b) Residuals of the fit. "
        "Shaded: calibrated range.",
    ),
    "thickness_map": Caption(
        "Film thickness at one trigger",
        "(a) Map; flagged pixels have the colour of their flag; dashed: region of interest. "
        "(b) Profile along sliding, averaged over the axial extent of the region, with the gap of "
        "rigid bodies h = h_min + x²/2R fitted to it. (c) Difference of the two. Bands are 95 % "
        "of the random error, dashed lines 95 % of the error that all pixels share.",
        "png",
    ),
    "film_against_speed": Caption(
        "Film thickness against speed over load",
        "(a) Mean and minimum film thickness of each trigger with the fitted powers n; bars are "
        "one standard deviation, random and shared. Grey: too slow for the fit. (b) Minimum film "
        "thickness beside theory; open diamonds: the transient film predicted at the same trigger; "
        "lines: steady theory at the same speed and load, whose range the legend states where it "
        "is beyond the axis.",
    ),
    "map_sheet": Caption(
        "Maps of the cycle", "One colour scale for all maps. Grey: flagged.", "png"
    ),
    "film_over_cycle": Caption(
        "Film thickness and speed over the cycle",
        "(a) Mean and minimum film thickness; bands, where they are wider than the markers, are "
        "95 % of random and shared errors; "
        "(b) speed. Dotted: dead points of the mechanism.",
    ),
    "film_and_prediction": Caption(
        "Measured and predicted film",
        "(a) Minimum film thickness at every trigger with its standard deviation, and the "
        "transient film that theory predicts over the cycle. (b) The same against the turns of the "
        "crank since the first frame; a trigger of several frames lies at their mean turn.",
    ),
    "prediction_map": Caption(
        "Measured and predicted map",
        "(a) Measured and (b) predicted film on one colour scale, (c) their difference, white at "
        "zero. Grey: not valid.",
        "png",
    ),
    "pin_orbit": Caption(
        "Orbit of the pin",
        "(a) Displacement of the pin at every trigger; grey: the clearance, where pin and bore "
        "touch. (b) Film where they are closest, against the angle of this place; filled ellipses: "
        "95 % of the random error, dashed: with the errors that all triggers share. (c) Curvature "
        "of the gap along sliding, left free, with bars of 95 %, and that of circles with the "
        "radii of the joint.",
    ),
    "registration": Caption(
        "Registration of the cameras",
        "(a, b) Displacement of camera 2 against camera 1 less its mean; dashed: edge of the "
        "overlap. (c) Drift of each frame, in addition to the displacement.",
        "png",
    ),
}
"""Captions by the name of the figure, as in `erlif.show.plots.files.DRAWN`."""


def caption_of(name: str, film: xr.Dataset) -> Caption:
    """Choose the caption of a figure by the motion and by what the film holds.

    Parameters
    ----------
    name : str
        Name of the figure, as in `erlif.show.plots.files.DRAWN`.
    film : xarray.Dataset
        As `erlif.process` returns it.

    Returns
    -------
    Caption

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> caption_of("film_over_cycle", example_film()).title
    'Film thickness and speed over the cycle'
    """
    caption, settings = CAPTIONS[name], settings_of(film)
    if name == "film_and_prediction" and "film_regime_map" in film:
        comment = str(film["film_regime_map"].attrs.get("comment", ""))
        return replace(caption, text=f"{caption.text} {_explain_steady(film, comment)}".rstrip())
    if name == "thickness_map" and settings.joint is None:
        text = caption.text.replace(
            ", with the gap of rigid bodies h = h_min + x²/2R fitted to it. (c) Difference of the "
            "two.",
            ".",
        )
        return replace(caption, text=text)
    if name == "film_against_speed" and "film_theory" not in film:
        text = caption.text.replace("(a) ", "").partition(" (b)")[0]
        return replace(caption, text=text)
    if name == "map_sheet" and settings.mechanism is None:
        return replace(caption, title="Maps of the run")
    if settings.linkage is not None:
        return caption

    # without a linkage there may be neither strokes nor a speed
    if name == "speed_against_angle":
        strokes = "filled circles where the position rises, open squares where it falls."
        points = f" The points are the triggers: {strokes}" if "stroke" in film else ""
        text = f"Speed of the moving surface against the one at rest.{points}"
        return replace(caption, title="Sliding speed", text=text)
    if name == "film_over_cycle":
        dotted = " Dotted: the slider turns back." if "position" in film else ""
        if has_varying_speed(film):
            text = caption.text.partition(" Dotted")[0].replace("speed.", "sliding speed.")
            return replace(caption, title="Film thickness and speed", text=text + dotted)
        text = "Mean and minimum film thickness with 95 % bands of random and shared errors."
        return replace(caption, title="Film thickness over the run", text=text)
    return caption


def _explain_steady(film: xr.Dataset, comment: str) -> str:
    """Films by the steady formulas, and why they do not describe the joint."""
    reason = comment.removeprefix("steady formula, for reference: ")
    if not reason:
        return ""
    steady, formula = (
        float(film[name].max()) for name in ("film_regime_map", "film_hamrock_dowson")
    )
    return (
        f"At the highest speed the steady regime map gives {steady:.3g} µm and the 2.65 formula "
        f"{formula:.3g} µm. They do not apply: {reason}."
    )
