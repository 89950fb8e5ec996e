"""
Design of a joint: pressure, limits and life
============================================

``erlif.joint.design`` walks through the guide of Strand (2005) with a joint whose dimensions are
given. Two steps fail here: weld and prongs of the lock plate.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import erlif

EXAMPLES = next(path for path in (Path("../examples"), Path("docs/examples")) if path.is_dir())
designed = erlif.joint.design(EXAMPLES / "bucket_link.toml")

fig, panels = plt.subplots(2, 2, figsize=(8, 6), layout="constrained")
erlif.joint.plots.design_pressure(designed, ax=panels[0, 0])
erlif.joint.plots.design_pv(designed, ax=panels[0, 1])
erlif.joint.plots.design_temperature(designed, ax=panels[1, 0])
erlif.joint.plots.design_wear(designed, ax=panels[1, 1])
plt.show()

# %%
# The margin of each step, and what would raise those that fail:

print(erlif.joint.report.summarise_design(designed))
