"""Part of a file that belongs to a camera, and the alignment of the bits of its counts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from erlif.core.arrays import AnyArray
from erlif.core.errors import FrameError
from erlif.io.readers import FrameFile
from erlif.io.settings import CameraSettings

# Parts of one file that belong to two cameras; any two channels do as well.
_PARTNERS = {"left": "right", "top": "bottom", "odd": "even"}


@dataclass(frozen=True)
class Selection:
    """The counts of one camera within a file.

    Attributes
    ----------
    part : str
        Half of the sensor ("left", "right", "top", "bottom"), alternating pages ("odd", "even",
        counted from 1) or channel ("channel 1" to "channel 4"); empty for the whole file.
    dataset : str
        Path of the array in a file that holds several; empty for the only one.
    shift : int
        Bits by which left-aligned counts are shifted right.
    array_order : str
        As in `FrameFile`: images stored column by column are transposed.
    """

    part: str = ""
    dataset: str = ""
    shift: int = 0
    array_order: str = ""

    def pages(self, file: FrameFile) -> Sequence[int]:
        """Frames of a file that belong to this part, counted from 0.

        Raises
        ------
        FrameError
            With the bare reason, if the file has no such frames.
        """
        every = range(len(file.kinds))
        if self.part in ("odd", "even"):
            chosen: Sequence[int] = every[self.part == "even" :: 2]
        elif self.part.startswith("channel"):
            if file.channels is None:
                raise FrameError(
                    f'it has no channels, and part = "{self.part}" asks for one. For alternating '
                    'pages use part = "odd" and part = "even".'
                )
            wanted = int(self.part.split()[1])
            chosen = [k for k, channel in enumerate(file.channels) if channel == wanted]
        else:
            return every
        if not chosen:
            raise FrameError(
                f'it has no frame that belongs to part = "{self.part}". Correct part in the '
                "settings."
            )
        return chosen

    def crop_shape(self, shape: tuple[int, ...]) -> tuple[int, ...]:
        """Shape of the part of a frame; the middle row or column of an odd number is left out."""
        shape = (shape[1], shape[0], *shape[2:]) if self.array_order == "column" else shape
        rows, columns = self._window(shape)
        return (len(range(shape[0])[rows]), len(range(shape[1])[columns]), *shape[2:])

    def crop(self, image: AnyArray) -> AnyArray:
        """The part of a frame, as a view."""
        image = image.swapaxes(0, 1) if self.array_order == "column" else image
        return image[self._window(image.shape)]

    def _window(self, shape: tuple[int, ...]) -> tuple[slice, slice]:
        """Rows and columns of the part."""
        rows, columns = shape[0], shape[1]
        half = {
            "left": (slice(None), slice(columns // 2)),
            "right": (slice(None), slice(columns - columns // 2, None)),
            "top": (slice(rows // 2), slice(None)),
            "bottom": (slice(rows - rows // 2, None), slice(None)),
        }
        return half.get(self.part, (slice(None), slice(None)))


# All counts of a file, right-aligned.
WHOLE = Selection()


# What the counts of a file are for.
Purpose = Literal["frames", "dark", "flat", "background"]


def select_counts(camera: CameraSettings, purpose: Purpose = "frames") -> Selection:
    """The counts that the settings name for a camera.

    Parameters
    ----------
    camera : CameraSettings
    purpose : {"frames", "dark", "flat", "background"}
        All have the part and the alignment of the frames, and may have a dataset of their own.

    Returns
    -------
    Selection

    Examples
    --------
    >>> camera = CameraSettings(
    ...     files="run.h5", dataset="/one", flat_dataset="/flat", band="580 nm", offset="0 DN",
    ...     alignment="left",
    ... )
    >>> select_counts(camera, "flat")
    Selection(part='', dataset='/flat', shift=4, array_order='')
    """
    own = None if purpose == "frames" else getattr(camera, f"{purpose}_dataset")
    dataset = own or camera.dataset or ""
    shift = 16 - camera.bit_depth if camera.alignment == "left" else 0
    return Selection(camera.part or "", dataset, shift, camera.array_order or "")


def may_share_files(one: Selection, two: Selection) -> bool:
    """Whether two cameras may have their counts in the same files.

    Parameters
    ----------
    one, two : Selection
        Of camera 1 and camera 2.

    Returns
    -------
    bool
        True where both name parts that exclude one another, or different datasets.

    Examples
    --------
    >>> may_share_files(Selection("right"), Selection("left"))
    True
    >>> may_share_files(Selection("left"), Selection("top"))
    False
    """
    if one.dataset != two.dataset:
        return True
    if one.part.startswith("channel") and two.part.startswith("channel"):
        return one.part != two.part
    return _PARTNERS.get(one.part) == two.part or _PARTNERS.get(two.part) == one.part
