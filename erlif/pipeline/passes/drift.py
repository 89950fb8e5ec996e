"""The drift of a frame pair from its binned light.

The reference is `erlif.registration.estimate_drift`, which bins the light of the whole frame. What
the frames of a run have in common, the displacement at the binned pixels, is prepared once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.errors import RegistrationError
from erlif.correction import PairLight
from erlif.correction.light import BLOCK, UNUSABLE
from erlif.registration import CameraMap, is_steep, orient
from erlif.registration.drift import Drift, DriftSearch
from erlif.registration.normalise import binned
from erlif.registration.pairs import normalise_both


@dataclass(frozen=True)
class PairDrift:
    """Finds the drift of frames against one camera map.

    Attributes
    ----------
    shape : tuple[int, int]
        Rows and columns of the frames.
    orientation : str
        How camera 2 is turned, one of `erlif.registration.settings.ORIENTATIONS`.
    search : DriftSearch
        The search on textures.
    """

    shape: tuple[int, int]
    orientation: str
    search: DriftSearch

    @classmethod
    def of(cls, camera_map: CameraMap) -> PairDrift:
        """Prepare the search.

        Parameters
        ----------
        camera_map : CameraMap
            The fixed map.

        Returns
        -------
        PairDrift
        """
        search = DriftSearch.of(camera_map.displacement_x, camera_map.displacement_y)
        return cls(camera_map.shape, camera_map.settings.orientation, search)

    def find(self, light: PairLight) -> Drift:
        """Measure how far camera 2 has moved in this frame since the map was made.

        Parameters
        ----------
        light : PairLight
            Light of the pair; blocks, light and flags, or half and half_weight, are read.

        Returns
        -------
        Drift
            NaN where the cameras have no common texture when they are aligned by the map.

        Raises
        ------
        RegistrationError
            If the frame has another size than the map.

        Examples
        --------
        Camera 2 shows the same random texture three columns to the right.

        >>> from scipy.ndimage import gaussian_filter
        >>> from erlif.registration import MapKind
        >>> flat = np.zeros((96, 128), np.float32)
        >>> level = CameraMap(flat, flat, flat, flat == 0, flat > 0, 1.0, MapKind.SURFACE)
        >>> noise = np.random.default_rng(1).normal(size=(96, 131))
        >>> wall = (1000 + 300 * gaussian_filter(noise, 1.5)).astype(np.float32)
        >>> light = PairLight.empty((96, 128))
        >>> light.light[:] = wall[:, 3:], wall[:, :-3]
        >>> light.flags[:], light.blocks[:] = 0, 1000
        >>> drift = PairDrift.of(level).find(light)
        >>> abs(drift.dx - 3) < 0.01, abs(drift.dy) < 0.01
        (True, True)
        """
        if light.light.shape[1:] != self.shape:
            raise RegistrationError(
                f"The camera map was made for frames of {self.shape}, this frame has "
                f"{light.light.shape[1:]}; register the cameras again for this region of interest."
            )

        one, two = self._light(light, 0, "normal"), self._light(light, 1, self.orientation)
        return self.search.find(normalise_both(one, two, binning=self.search.binning))

    def _light(self, light: PairLight, camera: int, turn: str) -> tuple[AnyArray, AnyArray]:
        """Light of one camera in the pixels of the search, turned, and the weight of the pixels."""
        # squares of 2 px that begin at the other end of an odd side are other squares
        odd = any(side % 2 for side in self.shape)
        whole = self.search.binning == 1 or (odd and turn != "normal")
        if whole:
            image = light.light[camera]
            weight = (light.flags[camera] & UNUSABLE == 0).astype(np.float32)
        else:
            image, weight = light.half[camera], light.half_weight[camera]

        # where the film itself makes the light steep, the bands differ
        side, (rows, columns) = BLOCK if whole else BLOCK // 2, image.shape
        steep = is_steep(light.blocks[camera], (rows, columns), side=side)
        if steep.any():
            weight = np.where(steep, np.float32(0), weight)

        image, weight = orient(image, turn), orient(weight, turn)
        return binned(image, weight, 2) if whole and self.search.binning == 2 else (image, weight)
