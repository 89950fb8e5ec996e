"""Parts of the slider-crank with a worn joint: contact, motion and wall.

`erlif.joint.models.slider_dynamics` and `erlif.joint.models.slider_wear` put them together.
"""
