"""Accuracy, time and memory of the registration against the tools a laboratory would otherwise use.

    python benchmarks/registration.py                       # base case at 1280x1024, all peers
    python benchmarks/registration.py --cases all --peers erlif,openpiv
    python benchmarks/registration.py --size 640x480

Every method sees the same frames of an analytic scene (tests/scenes/registration.py), so its
displacement is known at every pixel. Peers get textures without illumination, as they would from a
careful user. The first call, which compiles or plans, is not timed; the best of the repetitions
is. Peers that are not installed are left out:
``pip install erlif[benchmark]`` brings them.
"""

import argparse
import contextlib
import io
import time
from collections.abc import Callable
from importlib.util import find_spec
from multiprocessing import get_context
from pathlib import Path
from sys import path
from typing import Any

import numpy as np
from numpy.typing import NDArray

path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from scenes.registration import Scene, Views, expose, smooth_map

from erlif.registration import RegistrationSettings, register

Array = NDArray[Any]
Method = Callable[[Array, Array], tuple[Array, Array]]

CASES: dict[str, dict[str, Any]] = {
    "base": {},
    "clean": {"private": 0.0},
    "weak": {"contrast": 0.04, "private": 0.0},
    "fine": {"sigma": 0.7},
    "coarse": {"sigma": 4.0},
    "wave": {},
    "lens": {},
    "dust": {},
}


# the frames ---------------------------------------------------------------------------------------


def displacement(
    case: str, shape: tuple[int, int]
) -> Callable[[Array, Array], tuple[Array, Array]]:
    """The smooth map of the rig, with a ripple for ``wave`` and a bump for ``lens``.

    The ripple is 160 px long; the bump is no polynomial.
    """
    smooth = smooth_map(shape, offset=(9.4, -6.7), rotation=0.3, scale=1.009)
    h, w = shape
    half = max(h, w) / 2

    def field(x: Array, y: Array) -> tuple[Array, Array]:
        dx, dy = smooth(x, y)
        if case == "wave":
            k = 2 * np.pi / 160
            dx = dx + 0.3 * np.sin(k * x + 0.3) * np.cos(0.8 * k * y)
            dy = dy + 0.3 * np.cos(0.9 * k * x) * np.sin(k * y + 1)
        if case == "lens":
            u, v = (x - (w - 1) / 2) / half, (y - (h - 1) / 2) / half
            bump = 0.6 * np.exp(-((u - 0.3) ** 2 + (v + 0.2) ** 2) / 0.18)
            r4 = (u * u + v * v) ** 2
            dx, dy = dx + bump + 0.3 * u * r4, dy - 0.7 * bump + 0.3 * v * r4
        return dx, dy

    return field


def dusty(clean: Array, rng: np.random.Generator) -> Array:
    """Sharp spots of dust in front of one camera, 150 for each megapixel."""
    h, w = clean.shape
    out = clean.copy()
    for _ in range(int(150e-6 * h * w)):
        cx, cy, r = rng.uniform(0, w), rng.uniform(0, h), rng.uniform(2, 9)
        part = (
            slice(max(int(cy - 16), 0), int(cy + 17)),
            slice(max(int(cx - 16), 0), int(cx + 17)),
        )
        y, x = np.mgrid[part[0].start : min(part[0].stop, h), part[1].start : min(part[1].stop, w)]
        depth = rng.choice([0.25, 0.5, 1.7]) - 1
        out[part] *= 1 + depth / (1 + np.exp((np.hypot(x - cx, y - cy) - r) / 0.5))
    return out


def make_views(case: str, shape: tuple[int, int], seed: int) -> Views:
    """One exposure of both cameras."""
    views = Scene(shape, seed, **CASES[case]).photograph(displacement(case, shape))
    if case != "dust":
        return views
    rng = np.random.default_rng(1000 + seed)
    frames = [
        expose(dusty(clean, rng), rng) for clean in (views.clean_reference, views.clean_moving)
    ]
    return Views(
        frames[0], frames[1], views.dx, views.dy, views.clean_reference, views.clean_moving
    )


# the methods --------------------------------------------------------------------------------------


def flattened(image: Array) -> Array:
    """Texture without illumination: local mean and local rms taken out."""
    import cv2

    f = image.astype(np.float32)
    f = f / np.maximum(cv2.GaussianBlur(f, (0, 0), 12), 1) - 1
    return np.asarray(f / np.sqrt(cv2.GaussianBlur(f * f, (0, 0), 24) + 1e-12))


def as_bytes(image: Array) -> Array:
    """The same texture within three rms, in 8 bit."""
    return np.clip((flattened(image) + 3) * (255 / 6), 0, 255).astype(np.uint8)


def on_pixels(
    x: Array, y: Array, dx: Array, dy: Array, shape: tuple[int, int]
) -> tuple[Array, Array]:
    """Interpolate vectors on a grid to every pixel by a bicubic spline."""
    from scipy.interpolate import RectBivariateSpline

    rows, cols = (
        np.clip(np.arange(shape[0]), y[0], y[-1]),
        np.clip(np.arange(shape[1]), x[0], x[-1]),
    )
    return tuple(RectBivariateSpline(y, x, f)(rows, cols) for f in (dx, dy))  # type: ignore[return-value]


def erlif_surface(a: Array, b: Array) -> tuple[Array, Array]:
    """The automatic choice."""
    found = register(a, b)
    return found.displacement_x, found.displacement_y


def erlif_local(a: Array, b: Array) -> tuple[Array, Array]:
    """A vector for each window, for comparison with the other window methods."""
    found = register(a, b, settings=RegistrationSettings(model="local"))
    return found.displacement_x, found.displacement_y


WINDOWS = (128, 64, 32, 32)


def openpiv_vectors(
    a: Array, b: Array, windows: tuple[int, ...] = WINDOWS
) -> tuple[Array, Array, Array, Array]:
    """OpenPIV: passes of `windows` [px], 75 % overlap, second image deformed, median test."""
    from openpiv import windef
    from openpiv.settings import PIVSettings

    s = PIVSettings(
        windowsizes=windows,
        overlap=tuple(size // 2 if size > 32 else 24 for size in windows),
        num_iterations=len(windows),
        deformation_method="second image",
        median_normalized=True,
        min_max_u_disp=(-60, 60),
        min_max_v_disp=(-60, 60),
    )
    a, b = flattened(a) * 500, flattened(b) * 500
    with contextlib.redirect_stdout(io.StringIO()):
        x, y, u, v, _ = windef.first_pass(a, b, s)
        # a window without light has no vector, which would spoil the spline of the next pass
        u, v = (np.ma.masked_array(np.where(np.isnan(f), np.nanmedian(f), f)) for f in (u, v))
        for number in range(1, len(windows)):
            x, y, u, v, _, _ = windef.multipass_img_deform(a, b, number, x, y, u, v, s)
    return x[0], y[:, 0], np.asarray(u), np.asarray(v)


def openpiv(a: Array, b: Array) -> tuple[Array, Array]:
    """The vectors of OpenPIV, interpolated."""
    x, y, u, v = openpiv_vectors(a, b)
    return on_pixels(x, y, u, v, (a.shape[0], a.shape[1]))


def openpiv_quintic(a: Array, b: Array, windows: tuple[int, ...] = WINDOWS) -> tuple[Array, Array]:
    """A robust polynomial of degree five through the vectors of OpenPIV."""
    x, y, u, v = openpiv_vectors(a, b, windows)
    h, w = a.shape

    def terms(x: Array, y: Array) -> Array:
        x, y = np.meshgrid(2 * x / w - 1, 2 * y / h - 1)
        return np.stack([x**i * y**j for i in range(6) for j in range(6 - i)], -1)

    design, dense = terms(x, y).reshape(-1, 21), terms(np.arange(w), np.arange(h))
    fields = []
    for f in (u.ravel(), v.ravel()):
        weight = np.ones(f.size)
        for _ in range(6):
            c = np.linalg.lstsq(design * weight[:, None], f * weight, rcond=None)[0]
            rest = f - design @ c
            weight = 1 / np.sqrt(1 + (rest / (2 * 1.4826 * np.median(np.abs(rest)))) ** 2)
        fields.append(dense @ c)
    return fields[0], fields[1]


def skimage_ilk(a: Array, b: Array) -> tuple[Array, Array]:
    """Iterative Lucas-Kanade of scikit-image, 25 px windows."""
    from skimage.registration import optical_flow_ilk

    v = optical_flow_ilk(
        flattened(a), flattened(b), radius=12, num_warp=10, gaussian=True, dtype=np.float32
    )
    return v[1], v[0]


def opencv_dis(a: Array, b: Array) -> tuple[Array, Array]:
    """Dense inverse search of OpenCV, medium preset."""
    import cv2

    v = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM).calc(
        as_bytes(a), as_bytes(b), None
    )
    return v[..., 0], v[..., 1]


def opencv_pyrlk(a: Array, b: Array) -> tuple[Array, Array]:
    """Pyramidal Lucas-Kanade of OpenCV on a grid of 8 px, 31 px windows, 3 by 3 median."""
    import cv2
    from scipy.ndimage import median_filter

    h, w = a.shape
    x, y = np.arange(16, w - 16, 8, dtype=np.float32), np.arange(16, h - 16, 8, dtype=np.float32)
    points = np.stack(np.meshgrid(x, y), -1).reshape(-1, 1, 2)
    stop = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 30, 1e-4)
    moved, _, _ = cv2.calcOpticalFlowPyrLK(
        as_bytes(a), as_bytes(b), points, None, winSize=(31, 31), maxLevel=4, criteria=stop
    )
    d = (moved - points).reshape(len(y), len(x), 2)
    return on_pixels(x, y, median_filter(d[..., 0], 3), median_filter(d[..., 1], 3), (h, w))


METHODS: dict[str, tuple[Method, str]] = {
    "erlif": (erlif_surface, "numba"),
    "erlif_local": (erlif_local, "numba"),
    "openpiv": (openpiv, "openpiv"),
    "openpiv_quintic": (openpiv_quintic, "openpiv"),
    "skimage_ilk": (skimage_ilk, "skimage"),
    "opencv_dis": (opencv_dis, "cv2"),
    "opencv_pyrlk": (opencv_pyrlk, "cv2"),
}


# the table ----------------------------------------------------------------------------------------


def memory(key: str) -> float:
    """A line of /proc/self/status in MB; nan where there is none."""
    with contextlib.suppress(OSError):
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith(key):
                return int(line.split()[1]) / 1024
    return float("nan")


def measure(name: str, views: Views, repeats: int) -> tuple[float, float, float, float, float]:
    """Run one method several times.

    Returns the rms and the 95th percentile of the error [px], wall time and processor time [s], and
    the peak memory above the start [MB]. Runs in a process of its own, so that no method inherits
    the memory of the one before.
    """
    method, _ = METHODS[name]
    small = Scene((192, 256), 1).photograph(smooth_map((192, 256)))
    with contextlib.suppress(Exception):
        method(small.reference, small.moving)
    start = memory("VmRSS")
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    wall, processor = [], []
    for _ in range(repeats):
        c, t = time.process_time(), time.perf_counter()
        dx, dy = method(views.reference, views.moving)
        wall.append(time.perf_counter() - t)
        processor.append(time.process_time() - c)
    peak = memory("VmHWM") - start
    error = np.hypot(dx - views.dx, dy - views.dy)[views.inside(32)]
    return (
        float(np.sqrt(np.mean(error**2))),
        float(np.percentile(error, 95)),
        min(wall),
        min(processor),
        peak,
    )


def main() -> None:
    """Print a line for each case and method."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--cases", default="base", help="comma-separated, or all: " + ", ".join(CASES)
    )
    parser.add_argument(
        "--peers", default="all", help="comma-separated, or all: " + ", ".join(METHODS)
    )
    parser.add_argument("--size", default="1280x1024", help="width x height")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()

    w, h = (int(n) for n in options.size.split("x"))
    cases = list(CASES) if options.cases == "all" else options.cases.split(",")
    names = list(METHODS) if options.peers == "all" else options.peers.split(",")
    print(
        f"{'case':7} {'method':16} {'rms px':>8} {'p95 px':>8} {'time s':>8} {'cpu s':>7} {'MB':>6}"
        "  error, time / erlif"
    )

    for case in cases:
        views = make_views(case, (h, w), options.seed)
        ours: tuple[float, float] | None = None
        for name in names:
            if find_spec(METHODS[name][1]) is None:
                continue
            with get_context("spawn").Pool(1) as fresh:
                rms, p95, wall, processor, peak = fresh.apply(
                    measure, (name, views, options.repeats)
                )
            if name == "erlif":
                ours = rms, wall
            ratio = f"{rms / ours[0]:8.1f} {wall / ours[1]:8.1f}" if ours else ""
            print(
                f"{case:7} {name:16} {rms:8.4f} {p95:8.4f} {wall:8.3f} {processor:7.3f} "
                f"{peak:6.0f}  {ratio}",
                flush=True,
            )


if __name__ == "__main__":
    main()
