"""Clock times as loggers and spreadsheets write them."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.io.ingest.logs.clock_times import read_clock


@pytest.mark.parametrize(
    "texts",
    [
        ("04.03.2026 23:59:00", "05.03.2026 00:00:30"),
        ("2026-03-04T23:59:00Z", "2026-03-05T00:00:30Z"),
        ("2026-03-04 23:59:00.000+01:00", "2026-03-05 00:00:30,0+01:00"),
        ("2026-03-04T23:59:00+01:00", "2026-03-04T23:00:30Z"),
        ("3/4/2026 11:59:00 PM", "3/5/2026 12:00:30 AM"),
        ("28/02/26 23:59:00", "01/03/26 00:00:30"),
        ("4/5/2026 23:59:00", "5/5/2026 00:00:30"),
        ("23:59:00", "00:00:30"),
        ("47:59:00", "48:00:30"),
    ],
)
def test_ninety_seconds_are_ninety_seconds(texts):
    npt.assert_allclose(read_clock(texts), [0.0, 90.0], atol=1e-6)


@pytest.mark.parametrize(
    "text", ["08:00", "31.02.2026 08:00:00", "8", "", "08:61:00", "04.03.2026"]
)
def test_what_is_no_time_of_a_clock_stays_unknown(text):
    """Hours and minutes may be minutes and seconds."""
    assert np.isnan(read_clock([text])).all()
