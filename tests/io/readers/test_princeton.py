"""Princeton Instruments SPE of WinView and of LightField."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import random_frames, write_spe2, write_spe3
from scenes.reading import read, refusal, times_of

STAMP = '<TimeStamp event="Exposure{}" type="Int64" bitDepth="64" resolution="2208037" />'
NUMBER = '<FrameTrackingNumber type="Int64" bitDepth="64" />'


@pytest.mark.parametrize(
    ("listed", "column"),
    [
        ((STAMP.format("Started"), STAMP.format("Ended"), NUMBER), 0),
        ((NUMBER, STAMP.format("Started")), 1),
        ((STAMP.format("Ended"), STAMP.format("Started")), 1),
        ((NUMBER, STAMP.format("Ended")), 1),
        ((NUMBER,), None),
        ((STAMP.format("Started").replace("Int64", "Double"),), None),
        ((STAMP.format("Started"),) * 4, None),  # more than there are bytes
    ],
)
def test_time_stamps_of_lightfield_are_those_of_the_exposure(tmp_path, listed, column):
    """SPE 3.0 File Format Specification, table 9: ticks since a common zero, behind each frame."""
    frames = random_frames(np.random.default_rng(1))
    ticks = np.array([[2208037, 5, 7], [4416074, 2208042, 2208044], [4416075, 11, 13]], "<i8")
    meta = f'<MetaFormat><MetaBlock id="1">{"".join(listed)}</MetaBlock></MetaFormat>'
    path = write_spe3(
        tmp_path / "a.spe", frames, behind=[row.tobytes() for row in ticks], meta=meta
    )
    if column is None:
        assert times_of(path) is None
    else:
        expected = (ticks[:, column] - ticks[0, column]) / 2208037
        npt.assert_allclose(times_of(path), expected, rtol=1e-15)
    npt.assert_array_equal(read(path), frames)


def test_several_regions_are_refused(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    for path in (
        write_spe2(tmp_path / "a.spe", frames, regions=2),
        write_spe3(tmp_path / "b.spe", frames, regions=2),
    ):
        assert "holds 2 regions" in refusal(path)
