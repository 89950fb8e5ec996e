"""Files for other programs, read back."""

import io

import numpy as np
import numpy.testing as npt
import tifffile

from erlif.show.view.exports import map_csv, map_tiff

X, Y = 0.06 * np.arange(20), 1.0 + 0.06 * np.arange(10)
VALUES = np.random.default_rng(5).normal(5, 1, (10, 20)).astype(np.float32)
FLAGS = np.zeros((10, 20), np.uint16)
FLAGS[3, 4] = 128


def test_a_tiff_holds_every_value_and_the_scale():
    content = map_tiff(VALUES, FLAGS, pitch=(0.06, 0.06), title="film µ", unit="um")
    with tifffile.TiffFile(io.BytesIO(content)) as file:
        npt.assert_array_equal(file.asarray(), np.where(FLAGS == 0, VALUES, np.nan))
        over, under = file.pages[0].tags["XResolution"].value
        assert abs(under / over / 0.06 - 1) < 1e-6
        assert file.imagej_metadata["unit"] == "mm"
        assert file.imagej_metadata["Info"] == "film ? [um]"


def test_a_map_as_text_holds_every_pixel():
    text = map_csv(VALUES, FLAGS, x=X, y=Y, name="thickness [um]").decode()
    assert text.splitlines()[0] == "x [mm],y [mm],thickness [um],flags"
    table = np.genfromtxt(io.StringIO(text), delimiter=",", skip_header=1)
    npt.assert_allclose(table[:, 2].reshape(10, 20)[FLAGS == 0], VALUES[FLAGS == 0], rtol=1e-6)
    assert np.isnan(table[3 * 20 + 4, 2])
    npt.assert_allclose(table[:, 0].reshape(10, 20), np.broadcast_to(X, (10, 20)), rtol=1e-6)
    npt.assert_allclose(table[:, 1].reshape(10, 20), np.broadcast_to(Y[:, None], (10, 20)))
