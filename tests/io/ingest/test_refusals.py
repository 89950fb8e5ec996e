"""The table of refusals of recordings and logs."""

import re
from importlib.resources import files

from erlif.core.tables import read_table


def test_every_refusal_of_the_table_is_raised_somewhere():
    places = [*files("erlif.io.ingest").glob("*.py"), *files("erlif.io.ingest.logs").glob("*.py")]
    source = "".join(path.read_text("utf-8") for path in places)
    source += '"positive_load" "positive_pulse_energy"'  # named after their quantity
    keys = read_table("erlif.io.ingest", "refusals.toml")
    assert not [key for key in keys if not re.search(rf'"{key}"', source)]
