"""
Uncertainty budget of one map
=============================

``erlif budget`` and ``erlif.budget`` separate the sources of error of one trigger: for single
pixels of a thin, a middle and a thick film, for the mean film and for the minimum film thickness.
"""

import matplotlib.pyplot as plt
import numpy as np
from sample import CALIBRATION, RUN

import erlif

budget = erlif.budget(RUN, calibration=CALIBRATION)
terms = budget.sel(term=budget.kind != "sum")

fig, ax = plt.subplots(figsize=(7, 4.8), layout="constrained")
places = np.arange(terms.sizes["term"])
height = 0.8 / terms.sizes["quantity"]
for k, quantity in enumerate(terms.quantity.values):
    ax.barh(places + k * height, 1e3 * terms["std"].sel(quantity=quantity), height, label=quantity)
ax.set_yticks(places + 0.4 - height / 2, terms.term.values)
ax.invert_yaxis()
ax.set(xscale="log", xlabel="standard deviation [nm]", xlim=(0.1, None))
ax.legend(fontsize=8)
plt.show()

# %%
# A single pixel is limited by photons. The mean over the region is limited by the calibration.
