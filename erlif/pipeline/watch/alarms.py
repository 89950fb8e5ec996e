"""Limits that a person sets, beyond which a run needs a look."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.pipeline.watch.live import LivePair


@dataclass(frozen=True)
class Alarms:
    """Limits of the film, of the light and of the pulses; None where a limit is not set.

    Attributes
    ----------
    film_below : float | None
        Minimum film thickness. [um]
    saturated_above : float | None
        Share of saturated pixels of either camera. [1]
    no_pulse_for : float | None
        Time without a new pair. [s]

    Examples
    --------
    >>> Alarms(no_pulse_for=2.0).raised([], silence=3.5)
    {'no pulse': 'no pulse for 3.5 s (limit 2 s)'}
    >>> Alarms().raised([], silence=3.5)
    {}
    """

    film_below: float | None = None
    saturated_above: float | None = None
    no_pulse_for: float | None = None

    def raised(self, pairs: list[LivePair], *, silence: float) -> dict[str, str]:
        """The alarms of some pairs.

        Parameters
        ----------
        pairs : list of LivePair
        silence : float
            Time since the last pair. [s]

        Returns
        -------
        dict of str to str
            Name of the limit to a sentence with value and limit.
        """
        found: dict[str, str] = {}
        films = [one for one in pairs if np.isfinite(one.film_min)]
        if self.film_below is not None and films:
            thinnest = min(films, key=lambda one: one.film_min)
            if thinnest.film_min < self.film_below:
                found["film"] = (
                    f"minimum film {thinnest.film_min:.2f} um in pair {thinnest.place} "
                    f"(limit {self.film_below:g} um)"
                )
        if self.saturated_above is not None and pairs:
            worst = max(pairs, key=lambda one: max(one.saturated))
            camera = 1 + int(np.argmax(worst.saturated))
            if max(worst.saturated) > self.saturated_above:
                found["saturated"] = (
                    f"camera {camera} saturates in {100 * max(worst.saturated):.1f} % of pair "
                    f"{worst.place} (limit {100 * self.saturated_above:g} %)"
                )
        if self.no_pulse_for is not None and silence > self.no_pulse_for:
            found["no pulse"] = f"no pulse for {silence:.1f} s (limit {self.no_pulse_for:g} s)"
        return found

    def describe_unjudged(self, pair: LivePair) -> str:
        """State that the minimum film of a pair is not known, where it has a limit; else empty.

        Parameters
        ----------
        pair : LivePair

        Returns
        -------
        str
        """
        if self.film_below is None or np.isfinite(pair.film_min):
            return ""
        return (
            f"the limit of the film ({self.film_below:g} um) cannot be judged: the minimum film of "
            f"pair {pair.place} is not determined, because its map is not that of a smooth gap or "
            "has too few valid pixels. Choose roi in [thickness] about the thinnest film"
        )
