"""The lossless compression IMX of LaVision images: differences of 4, 8 or 16 bits."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import AnyArray, Counts
from erlif.core.speed.kernels import njit


# one signature, compiled once per machine in half a second
@njit("int64(uint8[::1], uint16[::1])", nogil=True, cache=True)
def decode_imx(stream: AnyArray, counts: Counts) -> int:
    """Decode a compressed image.

    A byte is the difference to the count before it, with three exceptions: -128 is followed by a
    count of 16 bits; 127 by a number and so many counts of 16 bits; -127 by bytes of two
    differences of 4 bits, the high half first, until a low half is 8.

    Parameters
    ----------
    stream : array of uint8, (byte,)
    counts : array of uint16, (pixel,)
        Filled in place. [DN]

    Returns
    -------
    int
        Number of counts that were decoded; fewer than `counts` has where the stream ends before.

    Examples
    --------
    >>> stream = np.array([5, 256 - 2, 256 - 128, 0x34, 0x12], np.uint8)
    >>> counts = np.zeros(3, np.uint16)
    >>> decode_imx(stream, counts), [int(count) for count in counts]
    (3, [5, 3, 4660])
    """
    size, last, done, place = stream.size, 0, 0, 0
    while done < counts.size and place < size:
        code = int(np.int64(stream[place]))
        place += 1

        # differences of 4 bits; a low half of 8 ends them
        if code == 129:  # -127
            ended = False
            while not ended and done < counts.size and place < size:
                pair = int(np.int64(stream[place]))
                place += 1
                high, low = pair >> 4, pair & 15
                last = (last + (high - 16 if high & 8 else high)) & 0xFFFF
                counts[done] = last
                done += 1
                if low == 8:
                    ended = True
                elif done < counts.size:
                    last = (last + (low - 16 if low & 8 else low)) & 0xFFFF
                    counts[done] = last
                    done += 1
            continue

        # counts of 16 bits, one or several
        if code in (127, 128):
            number = 1
            if code == 127:
                if place >= size:
                    return done
                number = int(np.int64(stream[place]))
                place += 1
            while number > 0 and done < counts.size and place + 1 < size:
                last = int(np.int64(stream[place]) | np.int64(stream[place + 1]) << 8)
                place += 2
                counts[done] = last
                done += 1
                number -= 1
            if number > 0:  # the stream or the image ends within the counts
                return done
            continue

        last = (last + (code - 256 if code & 128 else code)) & 0xFFFF
        counts[done] = last
        done += 1
    return done
