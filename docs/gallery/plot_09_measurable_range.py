"""
Which film a pixel can measure
==============================

The thickness follows from the ratio, so its standard deviation is that of the logarithm of the
ratio over the slope of the curve. Thin films emit little light, thick films have a flat curve: in
between lies the range in which a single pixel of one frame measures.
"""

import matplotlib.pyplot as plt
import numpy as np

from erlif.models.fluorescence import band_ratio, band_signal

P, Q = 0.40, 0.25  # attenuation of cameras 1 and 2 [1/um], about those of the sample
READ_NOISE = 9.0  # electron
GAIN = 4.4  # electron/DN

thickness = np.logspace(-1, 1.5, 300)  # um

fig, ax = plt.subplots(figsize=(6.5, 4.2), layout="constrained")
for electrons in (11000, 3300, 1100):
    variance = 0.0
    for attenuation in (P, Q):
        signal = band_signal(thickness, attenuation=attenuation, brightness=electrons * attenuation)
        variance += (signal + READ_NOISE**2 + GAIN**2 / 12) / signal**2
    ratio = band_ratio(thickness, ratio_at_zero=1.0, attenuation_camera1=P, attenuation_camera2=Q)
    std = np.sqrt(variance) / ratio.slope
    ax.loglog(thickness, std / thickness, label=f"{electrons} electrons of a thick film")
ax.axhline(0.25, color="black", linewidth=0.8, linestyle="--")
ax.annotate("25 %", (0.11, 0.27))
ax.set(xlabel="film thickness [µm]", ylabel="relative standard deviation of a pixel")
ax.set_ylim(0.03, 10)
ax.legend()
plt.show()

# %%
# The measurable range narrows as the light falls. Averaging frames of one trigger widens it.
