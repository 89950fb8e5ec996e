"""Registration against its peers on public image pairs whose displacement is known.

    python benchmarks/registration_real.py DIR

DIR holds the images of two sets of the DIC Challenge as the repository dicengine/dice (BSD-3) keeps
them under tests/regression: ``dic_challenge_15/images`` and ``command.csv`` (a specimen image
deformed by a known v(y)), and ``bitmap_star/images`` (the noisy star:
v = 0.5 cos(2 pi (y - 250)/(10 + 0.07 x)), ever finer to the left). They are not part of this
repository. Errors are rms of the vertical component over all pixels at least 32 px inside.
"""

import sys
import time
import warnings
from pathlib import Path

import numpy as np
import tifffile
from PIL import Image
from registration import erlif_local, erlif_surface, opencv_dis, opencv_pyrlk, openpiv, skimage_ilk

PEERS = {
    "erlif": erlif_surface,
    "erlif, windows": erlif_local,
    "OpenPIV": openpiv,
    "PyrLK": opencv_pyrlk,
    "DIS": opencv_dis,
    "ILK": skimage_ilk,
}


def sample_15(directory: Path, name: str):
    """Reference, deformed image and v (y, x).

    The command gives v in the deformed frame, so each v belongs to the row y - v of the reference.
    """
    images = directory / "dic_challenge_15" / "images"
    reference, deformed = (
        tifffile.imread(images / file) for file in ("Reference.tif", f"P200_K{name}_N2.tif")
    )
    table = np.loadtxt(directory / "dic_challenge_15" / "command.csv", delimiter=",")
    command = table[:, int(name) // 50]
    known = command > -900
    y, v = table[known, 0], command[known]
    rows = np.arange(reference.shape[0])
    truth = np.interp(rows, y - v, v, left=np.nan, right=np.nan)
    return reference, deformed, np.broadcast_to(truth[:, None], reference.shape)


def star(directory: Path):
    """Reference, deformed image and v (y, x) of the noisy star."""
    images = directory / "bitmap_star" / "images"
    reference, deformed = (
        np.array(Image.open(images / f"DIC_Challenge_Wave_{kind}_Noisy.bmp").convert("L"))
        for kind in ("Reference", "Deformed")
    )
    y, x = np.indices(reference.shape)
    return reference, deformed, 0.5 * np.cos(2 * np.pi * (y - 250) / (10 + 0.07 * x))


def main() -> None:
    """Print a line for each case, method and part of the field."""
    warnings.simplefilter("ignore")
    directory = Path(sys.argv[1])
    cases = {f"sample 15, K{k}": sample_15(directory, str(k)) for k in (50, 200, 400)} | {
        "star": star(directory)
    }

    for case, (reference, deformed, truth) in cases.items():
        inside = np.zeros(truth.shape, bool)
        inside[32:-32, 32:-32] = True
        inside &= np.isfinite(truth)

        # the star by the length of its waves
        parts = {"": inside}
        if case == "star":
            x = np.arange(truth.shape[1])
            parts = {
                f", period {low} to {high} px": inside
                & ((10 + 0.07 * x >= low) & (10 + 0.07 * x < high))[None, :]
                for low, high in ((31, 59), (59, 94), (94, 147))
            }

        for name, peer in PEERS.items():
            start = time.perf_counter()
            _, dy = peer(reference.astype(np.float32), deformed.astype(np.float32))
            took = time.perf_counter() - start
            for part, use in parts.items():
                known = use & np.isfinite(dy)
                error = float(np.sqrt(np.mean((dy - truth)[known] ** 2)))
                print(
                    f"{case + part:32s} {name:16s} {error:8.4f} px   "
                    f"covered {known.sum() / use.sum():.3f}   {took:6.2f} s",
                    flush=True,
                )


if __name__ == "__main__":
    main()
