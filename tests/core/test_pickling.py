"""Records without their cached properties."""

import pickle
from dataclasses import dataclass
from functools import cached_property

from erlif.core.pickling import PickledByFields


@dataclass(frozen=True)
class Table(PickledByFields):
    size: int

    @cached_property
    def squares(self) -> list[int]:
        return [n**2 for n in range(self.size)]


def test_cached_properties_are_not_sent_and_are_made_again():
    table = Table(1000)
    before = len(pickle.dumps(table))
    assert table.squares[30] == 900
    assert len(pickle.dumps(table)) == before
    copy = pickle.loads(pickle.dumps(table))
    assert "squares" not in vars(copy)
    assert copy == table
    assert copy.squares == table.squares
