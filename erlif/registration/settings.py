"""Settings of the registration, and the orientations of camera 2 against camera 1."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.errors import RegistrationError

_TURNS: Final[dict[str, Callable[[AnyArray], AnyArray]]] = {
    "normal": lambda image: image,
    "mirrored_x": lambda image: image[:, ::-1],
    "mirrored_y": lambda image: image[::-1, :],
    "rotated_90": lambda image: np.rot90(image, 1),
    "rotated_180": lambda image: image[::-1, ::-1],
    "rotated_270": lambda image: np.rot90(image, -1),
    "transposed": lambda image: image.T,
    "antitransposed": lambda image: image[::-1, ::-1].T,
}

# The eight ways in which camera 2, behind mirrors or turned in its mount, can see the scene.
ORIENTATIONS: Final[tuple[str, ...]] = tuple(_TURNS)

# What the displacement may be made of, see `RegistrationSettings`.
MODELS: Final = ("auto", "surface", "local")

# Smallest side of a cell: the five-point derivative reaches as far. [px]
SMALLEST_STEP: Final = 4

# Largest side of a window; broader distortion is left to a surface. [px]
LARGEST_WINDOW: Final = 256

# At larger offsets the cameras share too little of the field. [1]
LARGEST_SEARCH: Final = 0.4


def orient(image: AnyArray, orientation: str) -> AnyArray:
    """Turn the image of camera 2 so that it can be laid over that of camera 1.

    Parameters
    ----------
    image : array, (y, x)
        Anything on the pixels of camera 2: counts, weights, flags.
    orientation : str
        One of ``ORIENTATIONS``.

    Returns
    -------
    array, (y, x)
        A view where possible; (x, y) of the original for the orientations that exchange the axes.

    Examples
    --------
    >>> orient(np.array([[1, 2, 3], [4, 5, 6]]), "rotated_90")
    array([[3, 6],
           [2, 5],
           [1, 4]])
    >>> orient(np.array([[1, 2, 3], [4, 5, 6]]), "mirrored_x")
    array([[3, 2, 1],
           [6, 5, 4]])
    """
    return _TURNS[orientation](image)


@dataclass(frozen=True)
class RegistrationSettings:
    """Settings of the registration. Every default suits an ordinary run.

    Raises
    ------
    RegistrationError
        If a value lies outside its range.

    Attributes
    ----------
    window : int
        Side of the square window with the noise of the Gaussian one used for local vectors.
        [px]
    step : int
        Distance of the nodes of the local field, and side of the cells that are summed. [px]
    passes : int
        Gauss-Newton passes of the local field at full resolution.
    model : Literal['auto', 'surface', 'local']
        ``"surface"``: a smooth surface, as fine as the data support; ``"local"``: one
        displacement for each window; ``"auto"``: the surface, unless the distortion is finer
        than any surface.
    orientation : str
        How the image of camera 2 is turned before it looks like that of camera 1, one of
        ``ORIENTATIONS``. ``"rotated_90"`` turns it counter-clockwise as seen on the screen, as
        `numpy.rot90` does.
    whiten : bool
        Weight the spatial frequencies by the coherence of the two cameras.
    search : float
        Largest offset of camera 2 that is searched, as a part of the frame. [1]
    frames_for_map : int
        Largest number of frames, evenly spaced over the run, from which the fixed map is made.
        The drift is measured for all frames.
    threads : int
        Threads for one pair of frames. The result does not depend on it.

    Examples
    --------
    >>> RegistrationSettings(model="local", window=48).step
    8
    """

    window: int = 32
    step: int = 8
    passes: int = 3
    model: Literal["auto", "surface", "local"] = "auto"
    orientation: str = "normal"
    whiten: bool = True
    search: float = 0.27
    frames_for_map: int = 32
    threads: int = 2

    def __post_init__(self) -> None:
        for name, words in (("orientation", ORIENTATIONS), ("model", MODELS)):
            if getattr(self, name) not in words:
                raise RegistrationError(
                    f"{name} must be one of {', '.join(words)}; got {getattr(self, name)!r}. "
                    "Correct it in the settings of the registration."
                )

        # a window spans at least two cells
        narrow = not SMALLEST_STEP <= self.step <= self.window / 2
        if narrow or self.window > LARGEST_WINDOW or self.step % 2:
            raise RegistrationError(
                f"window must lie between twice the step and {LARGEST_WINDOW} px, and step must be "
                f"even and at least {SMALLEST_STEP} px; got window {self.window} and step "
                f"{self.step}. Keep 32 and 8 if in doubt."
            )

        if not 0 < self.search <= LARGEST_SEARCH:
            raise RegistrationError(
                f"search must lie above 0 and at most at {LARGEST_SEARCH} of the frame; got "
                f"{self.search}. Keep the default if in doubt."
            )
        if self.passes < 1 or self.frames_for_map < 1 or self.threads < 1:
            raise RegistrationError(
                f"passes, frames_for_map and threads must be at least 1; got {self.passes}, "
                f"{self.frames_for_map} and {self.threads}. Correct the settings."
            )
