"""Parts of the slider-crank with a worn joint: contact, motion and wall.

`erlif.models.slider_dynamics` and `erlif.models.slider_wear` put them together.
"""
