"""What a store of maps does, whichever format it writes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import AnyArray


class MapStore(Protocol):
    """The maps and numbers of the finished triggers of a film in the making.

    `NetcdfMaps` takes triggers in their order, in one thread. `ZarrMaps` takes them in any order,
    from several threads and processes.
    """

    @property
    def any_order(self) -> bool:
        """Whether triggers may be put in any order and from several threads and processes."""
        ...

    @property
    def path(self) -> Path:
        """The unfinished file or directory."""
        ...

    def encode(self, maps: Mapping[str, AnyArray]) -> dict[str, bytes]:
        """Round and compress the maps (y, x) of one trigger; any thread may call it."""
        ...

    def has(self, trigger: int) -> bool:
        """Check whether a trigger is finished and its chunks are complete."""
        ...

    def put(
        self, trigger: int, chunks: Mapping[str, bytes], numbers: Mapping[str, npt.ArrayLike]
    ) -> None:
        """Keep the chunks that `encode` made of one trigger, and its small arrays by name."""
        ...

    def numbers(self, trigger: int) -> dict[str, AnyArray]:
        """Small arrays of a finished trigger, by the names given to `put`."""
        ...

    def finish(self, film: xr.Dataset, groups: Mapping[str, xr.Dataset]) -> None:
        """Add the small variables, the groups and the attributes; may be repeated."""
        ...

    def close(self) -> None:
        """Release the files."""
        ...
