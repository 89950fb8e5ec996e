"""Theory of the joint: SI numbers in, SI numbers out.

Every function takes floats, numpy arrays or xarray DataArrays, broadcasts, and gives back what it was given. Angles are
in radians, temperatures in kelvin. A value for which an equation means nothing (a negative modulus, a bushing smaller
than its pin, an angle that the linkage never takes) raises `erlif.core.errors.ModelError` naming the argument; NaN
stands for a missing value and passes through.

The four sources are cited by author:

- Farzaneh (2002): Failure Analysis and Design of a Heavily Loaded Pin Joint, MSc thesis, MIT.
- Strand (2005): Design, Testing and Analysis of Journal Bearings for Construction Equipment, thesis, KTH Stockholm.
- Mukras et al. (2008): Modeling a Slider-Crank Mechanism With Joint Wear, SAE International.
- Colbert et al. (2009): Edges, clearances, and wear: little things that make big differences in bushing friction, Wear.

Where a source is misprinted the function holds the corrected form and its note says what was printed;
docs/sources.md sets every published number beside the one computed here.
"""
