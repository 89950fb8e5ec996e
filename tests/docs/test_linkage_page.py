"""The numbers of docs/linkage.md are those of the models, and its code runs."""

import re
from pathlib import Path

import numpy as np
import pytest

from erlif.joint.models.linkage import (
    drive_power,
    link_sensitivity,
    measure_linkage,
    pin_hole_concentration,
    synthesise_crank_rocker,
)
from erlif.models.four_bar.measures import speed_ratio
from erlif.models.mechanism import CrankRocker

PAGE = (Path(__file__).parents[2] / "docs" / "linkage.md").read_text(encoding="utf-8")
RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
RPM, HP = np.pi / 30, 745.7


@pytest.fixture(scope="module")
def numbers():
    """Statements of the page, with the numbers computed."""
    as_built = measure_linkage(RIG, rocker_speed=24 * RPM)
    (longer,) = synthesise_crank_rocker(
        swing=np.radians(26), rocker_speed=24 * RPM, coupler=0.44, rocker=0.26, ground=0.51
    ).designs
    away, towards = (114 * speed_ratio(RIG.links, rising=up) for up in (True, False))
    slopes = link_sensitivity(RIG)
    crank, _, rocker, _ = np.degrees(slopes.swing) / 1e3
    low, high = np.degrees(as_built.transmission)
    along, across = 1e3 * np.array(as_built.space)
    power = drive_power(RIG, crank_speed=114 * RPM, torque=2118.5)
    return [
        f"| swing | 26° | {np.degrees(as_built.swing):.2f}°, below",
        f"| 5.5 cm | {100 * longer.linkage.crank:.3f} cm |",
        f"| 24 rpm | {away:.2f} rpm away from the crank, {towards:.2f} rpm towards it |",
        f"{as_built.crank_speed / RPM:.2f} rpm; {longer.crank_speed / RPM:.2f} rpm with",
        f"between {low:.1f} and {high:.1f}°, the time ratio is {as_built.time_ratio:.4f}",
        f"space is {along:.0f} mm x {across:.0f} mm",
        f"adds {crank:.3f}° to the swing, a rocker longer by 1 mm takes {-rocker:.3f}°",
        f"hold the swing to ± {np.degrees(slopes.worst(1e-4)['swing']):.3f}°",
        f"hole of 27.9 mm in 45 mm has {pin_hole_concentration(27.9 / 45):.2f}",
        "the fit has {:.2f}, {:.2f}, {:.2f}, {:.2f} and {:.2f}:".format(
            *pin_hole_concentration([0.15, 0.2, 0.3, 0.4, 0.5])
        ),
        f"peak is {power.peak_power / HP:.2f} hp",
        f"the mean {power.mean_power / HP:.2f} hp",
        f"heats, {power.rms_power / HP:.2f} hp",
    ]


def test_numbers_of_the_page(numbers):
    text = " ".join(PAGE.split())
    assert [statement for statement in numbers if statement not in text] == []


def test_code_of_the_page_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.S)
    # a movie of two positions shows the same calls
    exec(code.replace('"turn.gif"', '"turn.gif", positions=2'), {})
    assert (tmp_path / "turn.gif").is_file()
