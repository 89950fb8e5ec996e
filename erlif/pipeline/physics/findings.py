"""Errors that light and films of a run show, and their selection for the error bars."""

from __future__ import annotations

from dataclasses import dataclass, replace

from erlif.calibration import RunCurve
from erlif.io.settings import LightOptions
from erlif.pipeline.physics.dark import DarkLevel
from erlif.pipeline.physics.reference import PatchScale
from erlif.trend import BackgroundEstimate, CourseChange, ErrorEstimate, Texture, Trend


@dataclass(frozen=True)
class LightFindings:
    """Effects found in light and films of a run: background, bleaching, drift, scale.

    Attributes
    ----------
    background : BackgroundEstimate | None
        None where it is not determined.
    bleaching : Trend | None
        None where it is not determined.
    source : str
        Where the film is the same, for bleaching.
    course : CourseChange | None
        Largest step or drift of the logarithm of the ratio at equal film; None where it is not
        determined.
    scale : PatchScale | None
        Ratio of the patch against that of its film; None where it is not determined.
    errors : ErrorEstimate | None
        What the gap of the joint shows of the errors of the run; None where it is not determined,
        where background or bleaching are corrected by themselves, and where a change is far
        beyond the widths.
    darks : tuple[DarkLevel, ...]
        Dark levels that are not those of the dark frames.
    texture : Texture | None
        What stands still in the image; None where nothing is significant.
    taken_out : bool
        Whether the errors were taken out of the curve.
    """

    background: BackgroundEstimate | None = None
    bleaching: Trend | None = None
    source: str = ""
    course: CourseChange | None = None
    scale: PatchScale | None = None
    errors: ErrorEstimate | None = None
    darks: tuple[DarkLevel, ...] = ()
    texture: Texture | None = None
    taken_out: bool = False

    def complete(self, remaining: LightFindings, options: LightOptions) -> LightFindings:
        """Combine corrected effects, as found before, with those of the finished films."""
        even = self if options.background == "correct" else remaining
        patched = self.scale is not None
        bleached = self if options.bleaching == "correct" or patched else remaining
        return replace(
            remaining,
            background=even.background,
            bleaching=bleached.bleaching,
            source=bleached.source,
            scale=self.scale,
        )

    def for_error_bars(self, calibration: RunCurve, options: LightOptions) -> LightFindings:
        """Select the effects that enter the error bars.

        A shift that the gap shows within the widths is one of those that the error bars are made
        for. A small course is among the errors that the gap shows.

        Parameters
        ----------
        calibration : RunCurve
            With the systematics of the settings.
        options : LightOptions

        Returns
        -------
        LightFindings
        """
        errors = self.errors
        if errors is not None and not self.taken_out:
            errors = errors if errors.exceeds_widths(calibration) else None
        return replace(self, errors=errors, course=None if errors is not None else self.course)
