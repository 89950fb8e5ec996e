"""
Galling in endurance tests
==========================

The load on a bearing rises in stages until its friction rises suddenly. First the onset of galling
in one test, with the interval that holds it with a probability of 95 %; then loads at failure of
two designs, as in section 4.1 of Farzaneh (2002); a test that ended without galling gives the
largest load that the bearing has carried.
"""

import matplotlib.pyplot as plt
from sample import ENDURANCE

import erlif

columns = erlif.joint.friction.LogColumns(arm_force="Third cell [N]")
tests = {
    path.stem: erlif.joint.analyse_endurance(
        erlif.joint.read_torque_log(path, columns), pin_radius=0.03336, arm=0.3
    )
    for path in sorted(ENDURANCE.glob("*.csv"))
}

# %%
# One test: friction over the last stages. The logs are simulated, and the true onset of this one is
# at 4380 s.

test = tests["uncut_1"]
fig, curve = plt.subplots(figsize=(5, 3.8), layout="constrained")
erlif.joint.plots.quantity_over_test(test, "friction", ax=curve)
minute = 60.0
curve.set(xlim=(3700 / minute, 4500 / minute), title="uncut_1")
plt.show()
print(f"onset at {test.onset.time:.1f} s, {test.onset.earliest:.1f} to {test.onset.latest:.1f} s")

# %%
# Two designs: filled where the bearing has galled, open where the test ended before.

failures = {
    design: [found.failure for name, found in tests.items() if name.startswith(design)]
    for design in ("uncut", "undercut")
}
fig, loads = plt.subplots(figsize=(5, 3.8), layout="constrained")
for place, group in enumerate(failures.values()):
    for height, failure in zip((-0.15, 0.0, 0.15), group, strict=True):
        error = 1.96 * failure.std / 1e3 if failure.failed else None
        filled = "full" if failure.failed else "none"
        marker = {"fmt": "o", "color": "k", "fillstyle": filled}
        loads.errorbar(failure.load / 1e3, place + height, xerr=error, **marker)
ratio = erlif.joint.compare_designs(failures["uncut"], failures["undercut"])
loads.set(
    yticks=range(len(failures)),
    yticklabels=failures,
    ylim=(-0.5, 1.5),
    xlabel="load [kN]",
    title=f"undercut over uncut: {ratio.ratio:.2f}",
)

plt.show()
