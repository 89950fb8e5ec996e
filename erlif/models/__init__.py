"""Theory that films and joints share: SI numbers in, SI numbers out.

Every formula takes floats, lists, numpy arrays or xarray DataArrays, broadcasts, and returns the
same kind: a float for floats. Angles are in radians, temperatures in kelvin. A value at which an
equation has no meaning (a negative modulus, an infinite load, a bushing smaller than its pin, an
angle outside the motion of the linkage) raises `erlif.core.errors.ModelError` with the name of the
argument; a value that is probably in another unit (a modulus in GPa) warns with
`erlif.core.errors.UnitWarning`. NaN stands for a missing value and is passed on.

The four sources are cited by author:

- Farzaneh (2002): Failure Analysis and Design of a Heavily Loaded Pin Joint, MSc thesis, MIT.
- Strand (2005): Design, Testing and Analysis of Journal Bearings for Construction Equipment,
  thesis, KTH Stockholm.
- Mukras et al. (2008): Modeling a Slider-Crank Mechanism With Joint Wear, SAE International.
- Colbert et al. (2009): Edges, clearances, and wear: little things that make big differences in
  bushing friction, Wear.

Where a source is misprinted, the function holds the corrected form and its note quotes the print;
docs/sources.md compares each published number with the one computed here.

>>> import erlif
>>> erlif.models.film.lubrication_regimes(1.52)
('partial',)
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
