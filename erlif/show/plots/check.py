"""Pictures of an audit: a pair, its difference, the counts, the light over the run, the encoder."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array
from erlif.core.statistics import central_range
from erlif.pipeline.audit.log import Steps
from erlif.review.check.cameras import PairPicture
from erlif.review.check.counts import CountSurvey
from erlif.show.plots import style
from erlif.show.plots.style import MUTED, ONE_COLUMN, OUTWARD, RETURN, TWO_COLUMNS, styled

_LOOKS = ((OUTWARD, "o", OUTWARD), (RETURN, "s", "white"))
_WITHIN = 99.5  # percentile of the differences at the ends of their colour scale
_LEAST_SHARE = 1e-3  # per cent; equal images still need a scale
_AROUND = 0.55  # inch above and below an image
_STEADY = 0.01  # relative change of the time step that the axis shows at least
_ROOM = 1.1  # height of an axis over the highest value
_BARS = 256  # of a histogram at most


@styled
def pair_figure(picture: PairPicture) -> style.AnyFigure:
    """Draw the light of both cameras on the pixels of camera 1."""
    rows, columns = picture.light[0].shape
    figure = style.new_figure(TWO_COLUMNS, 0.38 * TWO_COLUMNS * rows / columns + _AROUND)
    panels = figure.subplots(1, 2)
    for ax, light, number in zip(panels, picture.light, (1, 2), strict=True):
        image = style.draw_image(ax, light, central_range(light))
        style.add_colour_bar(image, ax, "corrected light [DN]")
        ax.set_title(f"camera {number}, pair {picture.frame}")
        ax.set_axis_off()
    style.letter_panels(*panels)
    return figure


@styled
def difference_figure(picture: PairPicture) -> style.AnyFigure:
    """Draw what remains between the cameras once they are aligned and the film is taken out."""
    rows, columns = picture.difference.shape
    figure = style.new_figure(ONE_COLUMN, 0.76 * ONE_COLUMN * rows / columns + _AROUND)
    ax = figure.add_subplot()
    share = 100 * picture.difference
    limits = style.even_limits(share, within=_WITHIN, least=_LEAST_SHARE)
    image = style.draw_image(ax, share, limits, colours="vik", bad="none")
    style.hatch_missing(ax)
    style.add_colour_bar(image, ax, "ratio over its surroundings [%]")
    ax.set_axis_off()
    return figure


@styled
def histogram_figure(survey: CountSurvey) -> style.AnyFigure:
    """Draw the number of pixels by count of both cameras."""
    figure = style.new_figure()
    ax = figure.add_subplot()
    pairs = zip(survey.histograms, _LOOKS, strict=True)
    for number, (histogram, (colour, *_)) in enumerate(pairs, 1):
        width = -(-histogram.size // _BARS)
        edges = np.arange(0, histogram.size + width, width)
        padded = np.zeros((edges.size - 1) * width)
        padded[: histogram.size] = histogram
        ax.stairs(padded.reshape(-1, width).sum(axis=1), edges, color=colour, label=f"{number}")
    ax.set(xlabel="count [DN]", ylabel="pixels [1]", yscale="symlog")
    for full_scale in sorted({histogram.size - 1 for histogram in survey.histograms}):
        ax.axvline(full_scale, color=MUTED, linewidth=0.6, linestyle=":")
    ax.legend(title="camera")
    return figure


@styled
def light_figure(survey: CountSurvey, darks: tuple[float, float]) -> style.AnyFigure:
    """Draw light and fine structure of the frames that were read."""
    figure = style.new_figure(height=1.0 * ONE_COLUMN)
    upper, lower = figure.subplots(2, 1, sharex=True)
    numbers = [one.frame for one in survey.frames]
    light = np.array([one.level for one in survey.frames]) - np.asarray(darks)
    sharpness = 100 * np.array([one.sharpness for one in survey.frames])
    for ax, values in ((upper, light), (lower, sharpness)):
        for n, (colour, marker, face) in enumerate(_LOOKS):
            look = {"marker": marker, "markerfacecolor": face, "label": f"{n + 1}"}
            ax.plot(numbers, values[:, n], color=colour, linewidth=0.5, **look)
        ax.set_ylim(0, _ROOM * max(float(values.max()), 1e-9))
        ax.margins(x=0.02)
    upper.set_ylabel("median light [DN]")
    lower.set(ylabel="fine structure [%]", xlabel="frame pair [1]")
    upper.legend(title="camera", ncols=2)
    style.letter_panels(upper, lower)
    return figure


@styled
def steps_figure(steps: Steps) -> style.AnyFigure | None:
    """Draw angle and time of the log, and their steps."""
    logged = ((steps.angle, "angle", "deg"), (steps.time, "time step", "ms"))
    shown = [
        (values, name, unit)
        for values, name, unit in logged
        if values is not None and values.size > 1
    ]
    if not shown:
        return None
    figure = style.new_figure(height=0.5 * ONE_COLUMN * len(shown))
    axes = np.atleast_1d(np.asarray(figure.subplots(len(shown), 1, sharex=True)))
    for ax, (values, name, unit) in zip(axes, shown, strict=True):
        drawn: Array = values if name == "angle" else 1e3 * np.diff(values)
        ax.plot(np.arange(drawn.size), drawn, "o-", color=OUTWARD, markersize=2, linewidth=0.5)
        ax.set_ylabel(f"{name} [{unit}]")
        ax.ticklabel_format(axis="y", useOffset=False)
        if name == "time step":  # digits that a logger rounds are no scatter of its clock
            middle = float(np.median(drawn))
            room = max(float(np.abs(drawn - middle).max()), _STEADY * middle)
            ax.set_ylim(middle - 1.1 * room, middle + 1.1 * room)
    style.letter_panels(*axes)
    axes[-1].set_xlabel("frame pair [1]")
    return figure
