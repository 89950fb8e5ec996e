"""Parts of the slider-crank with a worn joint: contact, motion, wall and extrapolation.

`erlif.models.slider_dynamics` and `erlif.models.slider_wear` put them together.
"""
