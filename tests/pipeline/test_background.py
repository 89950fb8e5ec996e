"""Light that is not film: a run with a known background, from frames to film."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.preparing import prepare
from scenes.rig import small_rig

import erlif
from conftest import processed, simulated

pytestmark = pytest.mark.usefixtures("without_theory")

RIG = small_rig(background=0.03, background_pages=8, pulse_jitter=0.1)
"""Sixteen triggers with 3 % of the median light in every pixel; the pulses scatter by a tenth."""


lab = simulated(RIG, seed=31)
plain = processed(
    "lab",
    "plain",
    *[("\nbackground =", "\n# background =")] * 2,
    add='\n[light]\nerrors = "report"\n',
)
"""The same run, processed as if there were no background."""

corrected = processed("lab")


def test_frames_of_the_dry_joint_take_the_bias_away(lab, plain, corrected):
    """Valid pixels of 3 to 4 um."""
    inside, error = lab.errors(plain, above=3, below=4)
    before = error[inside]
    inside, error = lab.errors(corrected, above=3, below=4)
    after = error[inside]
    std = np.hypot(corrected.thickness_std, corrected.thickness_std_shared).values[inside]

    shared = float(np.median(corrected.thickness_std_shared.values[corrected["flags"] == 0]))
    assert before.mean() > 0.08
    assert abs(after.mean()) < 2 * shared
    # the noise of the dry pages and the photons of the background are in the error bars
    assert 0.9 < (after / std).std() < 1.1


def test_budget_has_the_frames_of_the_dry_joint(lab, corrected):
    budget = erlif.budget(lab.run, trigger=4, films=(8.0,))
    one = corrected.isel(trigger=4)
    near = np.abs(one.thickness.values / 8.0 - 1) < 0.05
    column = budget["std"].isel(quantity=0)
    assert float(column.sel(term="frames of the dry joint, camera 1")) > 0
    random = float(column.sel(term="random part"))
    assert random == pytest.approx(float(np.median(one.thickness_std.values[near])), rel=0.05)


def test_pulse_energies_come_from_the_light_where_the_log_has_none(lab, corrected):
    run = lab.copy_run("without")
    rows = [row.rsplit(",", 1)[0] for row in (run / "encoder.csv").read_text().splitlines()]
    (run / "encoder.csv").write_text("\n".join(rows) + "\n")
    film = erlif.process(run, workers=1)

    # the meter is good to half a per cent; at the mean energy films would change by up to 20 nm
    (inside, error), (valid, known) = (
        lab.errors(each, above=0, below=5) for each in (film, corrected)
    )
    inside, change = inside & valid, error - known
    means = [one[good].mean() for one, good in zip(change, inside, strict=True) if good.sum() > 999]
    assert len(means) > 3
    assert np.abs(means).max() < 0.003


def test_error_of_the_energy_of_dry_frames_is_one_of_the_systematics(lab, corrected):
    stated = ('\nenergy = "0 %"', '\nenergy = "5 %"')
    run = lab.copy_run("energy", stated, add='\n[light]\nerrors = "report"\n')
    calibration = erlif.open_calibration(lab.fixture / "calibration.nc")
    systematics = prepare(run, calibration).curve.systematics
    rows = [n for n, term in enumerate(systematics.terms) if term == "background"]

    # 3 % of the light, 5 % by the mean energy; about 10 % by each of 8 pages and 16 frames
    by_chance = np.var(lab.truth.pulse_energy.values) * (1 / 8 + 1 / 16) * np.eye(2)
    found = systematics.covariance[np.ix_(rows, rows)] / 0.03**2
    npt.assert_allclose(found, 0.05**2 + by_chance, rtol=0.3)
    assert corrected.film_mean_error.sel(error_term="background").min() > 0.005
