"""Local clocks over the change of summer time, against UTC."""

from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import numpy as np
import numpy.testing as npt
import pytest

from erlif.io.ingest.logs.clock_times import read_clock, with_clocks
from erlif.io.ingest.logs.table import LogColumn, LogTable


def local_clock(zone, start, *, step=10.0, rows=1200, form="%d.%m.%Y %H:%M:%S"):
    """A log in UTC as a computer in this zone writes it."""
    first = datetime.fromisoformat(start).replace(tzinfo=UTC)
    times = (first + timedelta(seconds=step * k) for k in range(rows))
    return [time.astimezone(ZoneInfo(zone)).strftime(form) for time in times]


@pytest.mark.parametrize("step", [1.0, 10.0, 300.0])
@pytest.mark.parametrize(
    ("zone", "start"),
    [
        ("Europe/Berlin", "2026-03-29T00:48"),
        ("Europe/Berlin", "2026-10-25T00:48"),
        ("America/New_York", "2026-03-08T06:48"),
        ("America/New_York", "2026-11-01T05:48"),
        ("Australia/Sydney", "2026-10-03T15:48"),
        ("Australia/Sydney", "2026-04-04T15:48"),
        ("Asia/Jerusalem", "2026-03-26T23:48"),  # a Friday
        ("Africa/Cairo", "2026-04-23T21:48"),  # a Friday
        ("Asia/Amman", "2022-02-24T21:48"),  # a Friday
        ("Asia/Tehran", "2021-03-21T20:18"),  # a Monday
        ("America/Nuuk", "2026-03-29T00:48"),  # a Saturday at ten in the evening
        ("Asia/Shanghai", "2026-03-29T00:48"),
    ],
)
def test_a_local_clock_is_counted_on_where_summer_time_changes(zone, start, step):
    """The truth is UTC, by the database of time zones."""
    npt.assert_allclose(read_clock(local_clock(zone, start, step=step)), step * np.arange(1200))


@pytest.mark.parametrize("start", ["2026-03-29T00:48", "2026-10-25T00:48"])
def test_a_remark_names_the_row_in_which_a_clock_changes(start):
    texts = local_clock("Europe/Berlin", start)
    column = LogColumn("Zeit", "", np.full(1200, np.nan), dict(enumerate(texts)))
    table = with_clocks(LogTable("log.csv", (column,), range(2, 1202)))
    assert [remark for remark in table.remarks if "'Zeit' changes by an hour in row 74" in remark]
    npt.assert_allclose(table.columns[0].values, 10 * np.arange(1200))


@pytest.mark.parametrize(("day", "hour", "after"), [("2026-03-29", 1, 3), ("2026-10-25", 2, 2)])
def test_a_clock_may_change_in_the_longest_step_of_a_fast_log(day, hour, after):
    """Pulses of a rocker are 5 ms apart, and 50 ms at the dead point."""
    before = [f"{day} 0{hour}:59:59.{980 + 5 * k:03d}" for k in range(4)]
    later = [f"{day} 0{after}:00:00.{45 + 5 * k:03d}" for k in range(4)]
    seconds = [0, 0.005, 0.01, 0.015, 0.065, 0.07, 0.075, 0.08]
    npt.assert_allclose(read_clock(before + later), seconds, atol=1e-6)


def test_a_clock_without_a_date_is_counted_on_where_it_is_put_back():
    texts = local_clock("Europe/Berlin", "2026-10-25T00:48", form="%H:%M:%S")
    npt.assert_allclose(read_clock(texts), 10 * np.arange(1200))


@pytest.mark.parametrize(
    ("start", "pause"),
    [
        ("2026-03-30T01:59:00", 3600),  # a Monday
        ("2026-05-03T01:59:00", 3600),  # a Sunday without a change
        ("9999-12-31T01:59:00", 3600),
        ("0001-01-01T01:59:00", 3600),
        ("2026-03-29T12:59:00", 3600),  # noon
        ("2026-03-29T01:59:00", 3900),
        ("2026-03-29T01:20:00", 3600),  # within the hour
    ],
)
def test_a_pause_of_an_hour_remains_one(start, pause):
    first = datetime.fromisoformat(start)
    seconds = [10.0 * k + pause * (k >= 6) for k in range(60)]
    texts = [f"{first + timedelta(seconds=one):%Y-%m-%d %H:%M:%S}" for one in seconds]
    npt.assert_allclose(read_clock(texts), seconds)


def test_a_clock_with_its_zone_needs_no_change():
    texts = ["2026-03-29T01:59:59+01:00", "2026-03-29T03:00:00+02:00", "2026-03-29T03:00:01+02:00"]
    npt.assert_allclose(read_clock(texts), [0, 1, 2])
