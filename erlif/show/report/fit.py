"""The fit of a film in words: which physics carries it, and what was fitted."""

from __future__ import annotations

import numpy as np

from erlif.prediction import Comparison, Estimate
from erlif.show.report.layout import TABLES

# residuals over the stated errors up to which a scaled standard deviation is one of the fit; above
# it the model is wrong, and the scatter about it is not an error of its parameters
_DESCRIBED = 5.0


def summarise_comparison(found: Comparison) -> str:
    """Describe a comparison: the verdict, the models in their order, and the best fit.

    Examples
    --------
    >>> from erlif.prediction import Candidate
    >>> one = Candidate("a guided pin", 0.0, 4, 1.0, 4e-8)
    >>> print(summarise_comparison(Comparison((one,), "It swings.", None, 1.0)))
    It swings.
      model          BIC  residual [nm]
      a guided pin   0    40
    """
    width = max(len(one.name) for one in found.candidates) + 3
    lines = [found.verdict, f"  {'model':{width}s}{'BIC':5s}residual [nm]"]
    lines += [
        f"  {one.name:{width}s}{one.bic:<4.0f} {one.residual * 1e9:.3g}" for one in found.candidates
    ]
    if found.fit is not None:
        described = found.fit.inflation <= _DESCRIBED
        doubt = "" if described else "; no errors, as the model does not describe the positions"
        lines.append(f"  fitted: pin {found.fit.sideways} sideways{doubt}")
        for name, shown in TABLES["fitted"].items():
            if name in found.fit.estimates:
                value = _value(found.fit.estimates[name], shown.get("factor", 1.0), described)
                lines.append(f"    {shown['title']}: {value} {shown['unit']}")
        lines += [f"  {note}" for note in found.fit.notes]
    return "\n".join(lines)


def _value(estimate: Estimate, factor: float, described: bool) -> str:
    """A value with its standard deviation where the model holds, or the limit of the data."""
    one = estimate.times(factor, estimate.unit)
    if not described:
        return f"about {one.value:.2g}"
    if np.isfinite(one.low) and np.isinf(one.high):
        return f"above {one.low:.3g} (95 %)"
    # two digits of the error, as elsewhere
    digits = max(0, 1 - int(np.floor(np.log10(one.std)))) if one.std > 0 else 3
    return f"{one.value:.{digits}f} ± {one.std:.{digits}f}"
