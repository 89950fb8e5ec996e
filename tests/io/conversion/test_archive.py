"""Arrays of numpy."""

import json

import numpy as np

from erlif.core.progress import silent
from erlif.io.conversion.archive import write_archive


def test_numpy_reads_every_variable_without_pickle(film, tmp_path):
    write_archive(film, tmp_path / "film.npz", triggers=[0, 1, 2, 3, 4, 5], progress=silent)
    with np.load(tmp_path / "film.npz", allow_pickle=False) as found:
        for name in film.variables:
            np.testing.assert_array_equal(found[name], film[name].values)
        assert json.loads(found["units"].item())["thickness"] == "um"
        assert json.loads(found["attributes"].item())["title"] == film.attrs["title"]
