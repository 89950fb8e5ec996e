"""Where camera 2 looks, without any help: offset, rotation and scale from small images.

The frames are binned until they are some 200 pixels wide. A cross-correlation of the whole frame gives the offset for
each of a bank of rotations and scales; blocks matched around the best of them give an affine map that enough of the
blocks must agree on. What does not agree is refused, and said to be mirrored or turned if it is.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numba import njit
from scipy import fft

from erlif.core.arrays import AnyArray
from erlif.core.errors import RegistrationError
from erlif.registration.normalise import binned, normalise
from erlif.registration.settings import ORIENTATIONS, RegistrationSettings, orient
from erlif.registration.surface import Box, Surface, affine_surface
from erlif.registration.warp import NOTHING_BAD, sample_spline, spline_coefficients

COARSE_SIZE: Final = 256
"""The coarse images are binned by powers of two until their longer side is at most this. [px]"""
BLOCK: Final = 32
STRIDE: Final = 16
REACH: Final = 6
"""Blocks of the coarse images, their distance, and how far around the prediction they are searched. [px]"""
ROTATIONS: Final = np.radians([0.0, 1.25, -1.25, 2.5, -2.5, 3.75, -3.75, 5.0, -5.0])
SCALES: Final = (1.0, 1.0125, 0.9875, 1.025, 0.975, 1.0375, 0.9625, 1.05, 0.95)
SIGNIFICANT: Final = 7.0
"""Height of a correlation peak over the scatter of the correlation that is not taken for chance."""


@dataclass(frozen=True)
class Start:
    """An affine map found from the coarse images: d(x) = matrix @ x + offset, x in pixels from the frame's origin."""

    matrix: AnyArray
    offset: AnyArray
    agreement: float
    """Part of the blocks that agree with it."""
    blocks: int

    def surface(self, box: Box) -> Surface:
        """The same map as a surface."""
        return affine_surface(box, self.matrix, self.offset)


@dataclass(frozen=True)
class Peak:
    """A peak of the cross-correlation for one rotation and scale, in binned pixels about the frame's centre."""

    significance: float
    linear: AnyArray
    """(2, 2): camera 2 = linear @ (camera 1 - centre) + centre + shift."""
    shift: AnyArray


def coarse_binning(shape: tuple[int, int]) -> int:
    """The power of two that brings the longer side to at most ``COARSE_SIZE`` but the shorter not below 48."""
    factor = 1
    while max(shape) / factor > COARSE_SIZE and min(shape) / (2 * factor) >= 48:
        factor *= 2
    return factor


def _textures(image: AnyArray, weight: AnyArray | None, factor: int) -> tuple[AnyArray, AnyArray]:
    small, sound = binned(image, weight, factor)
    return normalise(small, sound, reach=3.0)


class _Correlator:
    """Cross-correlation of camera 1 with whatever camera 2 is turned into, at every offset at once."""

    def __init__(self, coarse: "_Coarse", search: float) -> None:
        h, w = self.shape = coarse.a.shape
        larger = (max(a, b) for a, b in zip(coarse.a.shape, coarse.b.shape, strict=True))
        rows, cols = (fft.next_fast_len(2 * n, real=True) for n in larger)
        self.size = (rows, cols)
        self.spectrum = np.conj(fft.rfft2(coarse.a, self.size))
        self.search = search
        self.offset_y = fft.fftfreq(self.size[0], 1 / self.size[0])[:, None]
        self.offset_x = fft.fftfreq(self.size[1], 1 / self.size[1])[None, :]
        # pixels that both cameras see at each offset; turning by a few degrees changes them little
        weights = fft.rfft2(coarse.wb, self.size) * np.conj(fft.rfft2(coarse.wa, self.size))
        shared = fft.irfft2(weights, self.size)
        self.enough = shared > 0.25 * h * w
        self.scale = np.where(self.enough, 1 / np.sqrt(np.maximum(shared, 1)), 0).astype(np.float32)

    def peak(
        self, texture: AnyArray, blur: float, *, everywhere: bool = False
    ) -> tuple[float, AnyArray]:
        """Significance and offset (x, y) of the best alignment; ``blur`` [px] gathers a peak that a slight
        rotation smears."""
        h, w = self.shape
        ky = np.exp(-0.5 * (2 * np.pi * fft.fftfreq(self.size[0]) * blur) ** 2)[:, None].astype(
            np.float32
        )
        kx = np.exp(-0.5 * (2 * np.pi * fft.rfftfreq(self.size[1]) * blur) ** 2)[None, :].astype(
            np.float32
        )
        product = fft.rfft2(texture, self.size)
        product *= self.spectrum
        product *= ky
        product *= kx
        value = fft.irfft2(product, self.size, overwrite_x=True)
        value *= self.scale
        reach = 0.75 if everywhere else self.search
        inside = (
            self.enough
            & (np.abs(self.offset_x) <= reach * w)
            & (np.abs(self.offset_y) <= reach * h)
        )
        if not inside.any():
            return 0.0, np.zeros(2)
        chance = 1.4826 * float(np.median(np.abs(value[self.enough][::5])))
        j, i = np.unravel_index(int(np.argmax(np.where(inside, value, -np.inf))), value.shape)
        if not chance > 0:
            return 0.0, np.zeros(2)
        offset = np.array([float(self.offset_x[0, i]), float(self.offset_y[j, 0])])
        return float(value[j, i]) / chance, offset


def _turned(
    coefficients: AnyArray, bad: AnyArray, linear: AnyArray, shift: AnyArray, shape: tuple[int, int]
) -> tuple[AnyArray, AnyArray]:
    """Camera 2 at ``linear @ (x - centre) + centre + shift`` for every coarse pixel x; 0 with weight 0 outside."""
    h, w = shape
    centre = np.array([(w - 1) / 2, (h - 1) / 2])
    offset = centre + shift - linear @ centre
    x, y = np.meshgrid(np.arange(w, dtype=np.float32), np.arange(h, dtype=np.float32))
    dx = (linear[0, 0] - 1) * x + linear[0, 1] * y + offset[0]
    dy = linear[1, 0] * x + (linear[1, 1] - 1) * y + offset[1]
    out = np.empty(shape, np.float32)
    sample_spline(
        coefficients, dx.astype(np.float32), dy.astype(np.float32), 0.0, 0.0, bad, out, 0, h
    )
    sound = np.isfinite(out)
    return np.where(sound, out, np.float32(0)), sound.astype(np.float32)


@njit(nogil=True, cache=True, error_model="numpy", fastmath=True)
def _integral(values: AnyArray, other: AnyArray, out: AnyArray) -> None:
    """Sums of values * other over every rectangle from the origin; one row and column more than the image."""
    h, w = values.shape
    for x in range(w + 1):
        out[0, x] = 0.0
    for y in range(h):
        line = 0.0
        out[y + 1, 0] = 0.0
        for x in range(w):
            line += values[y, x] * other[y, x]
            out[y + 1, x + 1] = out[y, x + 1] + line


@njit(nogil=True, cache=True, error_model="numpy", fastmath=True)
def _match_blocks(
    a: AnyArray,
    b: AnyArray,
    energy_a: AnyArray,
    energy_b: AnyArray,
    area: AnyArray,
    block: int,
    stride: int,
    reach: int,
    out: AnyArray,
) -> None:
    """Normalised correlation of each block of ``a`` with ``b`` at every integer offset within ``reach``; -2 where
    less than a third of the block is seen. Energies and area are integral images."""
    h, w = a.shape
    n = 2 * reach + 1
    for r in range(out.shape[0]):
        for c in range(out.shape[1]):
            y0 = r * stride
            x0 = c * stride
            y1 = min(y0 + block, h)
            x1 = min(x0 + block, w)
            saa = energy_a[y1, x1] - energy_a[y0, x1] - energy_a[y1, x0] + energy_a[y0, x0]
            for j in range(n):
                for i in range(n):
                    dy = j - reach
                    dx = i - reach
                    ya, yb = max(y0, -dy), min(y1, h - dy)
                    xa, xb = max(x0, -dx), min(x1, w - dx)
                    out[r, c, j, i] = -2
                    if yb <= ya or xb <= xa:
                        continue
                    p, q, s, t = ya + dy, yb + dy, xa + dx, xb + dx
                    count = area[q, t] - area[p, t] - area[q, s] + area[p, s]
                    sbb = energy_b[q, t] - energy_b[p, t] - energy_b[q, s] + energy_b[p, s]
                    if count < 0.3 * block * block or saa <= 0 or sbb <= 0:
                        continue
                    total = np.float32(0)
                    for y in range(ya, yb):
                        for x in range(xa, xb):
                            total += a[y, x] * b[y + dy, x + dx]
                    out[r, c, j, i] = total / np.sqrt(saa * sbb)


def _block_vectors(
    a: AnyArray, b: AnyArray, wb: AnyArray, reach: int
) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Centres (n, 2), vectors (n, 2) and peak heights over chance (n,) of all blocks that overlap enough. [px]"""
    h, w = a.shape
    rows, cols = max((h - BLOCK) // STRIDE + 1, 1), max((w - BLOCK) // STRIDE + 1, 1)
    n = 2 * reach + 1
    scores = np.empty((rows, cols, n, n), np.float32)
    energy_a, energy_b, area = (np.empty((h + 1, w + 1)) for _ in range(3))
    _integral(a, a, energy_a)
    _integral(b, b, energy_b)
    _integral(wb, wb, area)
    _match_blocks(a, b, energy_a, energy_b, area, BLOCK, STRIDE, reach, scores)
    flat = scores.reshape(rows, cols, n * n)
    usable = (flat > -1.5).mean(-1) > 0.6
    best = np.argmax(flat, axis=-1)
    j, i = np.divmod(best, n)
    height = np.take_along_axis(flat, best[..., None], -1)[..., 0]
    valid = np.where(flat > -1.5, flat, np.nan)[usable]
    chance = np.sqrt(np.nanmedian(valid**2, axis=-1)) / 0.6745 if usable.any() else np.zeros(0)
    y, x = np.meshgrid(np.arange(rows), np.arange(cols), indexing="ij")
    # parabola through the peak and its neighbours; a peak on the rim of the search is kept as it is
    inner = (i > 0) & (i < n - 1) & (j > 0) & (j < n - 1)
    sub = np.zeros((rows, cols, 2))
    jj, ii = np.clip(j, 1, n - 2), np.clip(i, 1, n - 2)
    for axis, (left, right) in enumerate((((0, -1), (0, 1)), ((-1, 0), (1, 0)))):
        low = scores[y, x, jj + left[0], ii + left[1]]
        high = scores[y, x, jj + right[0], ii + right[1]]
        middle = scores[y, x, jj, ii]
        bend = 2 * middle - low - high
        ok = inner & (bend > 0) & (low > -1.5) & (high > -1.5)
        sub[..., axis] = np.where(
            ok, np.clip((high - low) / (2 * np.where(bend > 0, bend, 1)), -0.5, 0.5), 0
        )
    vectors = np.stack([i - reach, j - reach], axis=-1) + sub
    half = (min(BLOCK, w, h) - 1) / 2
    centres = np.stack([x * STRIDE + half, y * STRIDE + half], axis=-1).astype(float)
    strength = height[usable] / np.maximum(chance, 1e-6)
    return centres[usable], vectors[usable], strength


def _agree(
    centres: AnyArray, vectors: AnyArray, strength: AnyArray
) -> tuple[AnyArray, AnyArray, float]:
    """The affine field that most blocks agree with: matrix (2, 2), offset (2,), part of the blocks within a pixel.

    Triples of blocks are drawn, the strong ones more often, with a generator of fixed seed; then least squares over the
    blocks that agree with the best triple, twice.
    """
    n = len(centres)
    if n < 4:
        return np.zeros((2, 2)), np.zeros(2), 0.0
    terms = np.concatenate([centres, np.ones((n, 1))], axis=1)
    rng = np.random.default_rng(0)
    chance = np.maximum(strength, 0.1) ** 2
    chance /= chance.sum()
    pick = rng.choice(n, (300, 3), p=chance)
    triangle = terms[pick]
    area = np.linalg.det(triangle)
    pick, triangle = pick[np.abs(area) > 400], triangle[np.abs(area) > 400]
    if not len(pick):
        return np.zeros((2, 2)), np.zeros(2), 0.0
    fields = np.linalg.solve(triangle, vectors[pick])
    near = np.hypot(*np.moveaxis(terms @ fields - vectors, -1, 0)) < 1.0
    near[np.abs(fields[:, :2]).max((1, 2)) > 0.12] = False
    best = near[np.argmax(near.sum(1))]
    if best.sum() < 4:
        return np.zeros((2, 2)), np.zeros(2), 0.0
    field = np.zeros((3, 2))
    for _ in range(3):
        field = np.linalg.lstsq(terms[best], vectors[best], rcond=None)[0]
        best = np.hypot(*(terms @ field - vectors).T) < 1.0
        if best.sum() < 4:
            return np.zeros((2, 2)), np.zeros(2), 0.0
    return field[:2].T, field[2], float(best.mean())


def _linear(rotation: float, scale: float) -> AnyArray:
    c, s = np.cos(rotation), np.sin(rotation)
    return scale * np.array([[c, -s], [s, c]])


def _bank() -> Iterator[tuple[float, float]]:
    for rotation in ROTATIONS:
        for scale in SCALES:
            yield float(rotation), scale


@dataclass(frozen=True)
class _Coarse:
    """The two coarse textures, ready to be compared under any affine map."""

    a: AnyArray
    wa: AnyArray
    b: AnyArray
    wb: AnyArray
    coefficients: AnyArray
    bad: AnyArray
    factor: int

    def turned(self, linear: AnyArray, shift: AnyArray) -> tuple[AnyArray, AnyArray]:
        return _turned(
            self.coefficients, self.bad, linear, shift, (self.a.shape[0], self.a.shape[1])
        )


def _second(b: AnyArray, wb: AnyArray) -> dict[str, Any]:
    """The part of `_Coarse` that belongs to camera 2."""
    b = np.clip(b, -4, 4)
    return {
        "b": b,
        "wb": wb,
        "coefficients": spline_coefficients(b),
        "bad": NOTHING_BAD if wb.all() else wb == 0,
    }


def _prepare(
    reference: AnyArray, moving: AnyArray, wr: AnyArray | None, wm: AnyArray | None, factor: int
) -> _Coarse:
    a, wa = _textures(reference, wr, factor)
    return _Coarse(
        a=np.clip(a, -4, 4), wa=wa, factor=factor, **_second(*_textures(moving, wm, factor))
    )


def _refine(coarse: _Coarse, peak: Peak) -> Start | None:
    """Match blocks about a peak, twice, and keep the affine map if enough of them agree."""
    h, w = coarse.a.shape
    centre = np.array([(w - 1) / 2, (h - 1) / 2])
    linear, shift = peak.linear, peak.shift
    agreement, blocks = 0.0, 0
    for reach in (REACH, REACH // 2):
        b, wb = coarse.turned(linear, shift)
        centres, vectors, strength = _block_vectors(coarse.a, b, wb, reach)
        matrix, offset, agreement = _agree(centres - centre, vectors, strength)
        blocks = len(centres)
        if agreement * blocks < 4:
            return None
        # camera 2 was read at L (x - c) + c + s and matches at x + M (x - c) + o
        shift = shift + linear @ offset
        linear = linear @ (np.eye(2) + matrix)
    if agreement < 0.4 or np.abs(linear - np.eye(2)).max() > 0.2:
        return None
    # binned pixel i lies at f i + (f - 1)/2 of the full frame
    f = coarse.factor
    middle = f * centre + (f - 1) / 2
    matrix = linear - np.eye(2)
    return Start(matrix, f * shift - matrix @ middle, agreement, blocks)


def _search_still(coarse: _Coarse, correlator: _Correlator) -> tuple[Start | None, Peak]:
    """Try the frame as it is, without the bank of rotations and scales."""
    still = np.eye(2)
    best = Peak(0.0, still, np.zeros(2))
    for blur in (0.7, 2.0):
        significance, offset = correlator.peak(coarse.b, blur)
        if significance > best.significance:
            best = Peak(significance, still, offset)
        if best.significance > 3 * SIGNIFICANT:
            break
    if best.significance > SIGNIFICANT:
        start = _refine(coarse, best)
        if start is not None and start.agreement > 0.6:
            return start, best
    return None, best


def _search_bank(coarse: _Coarse, correlator: _Correlator) -> tuple[Start | None, Peak]:
    """Try the bank of rotations and scales."""
    peaks = []
    for rotation, scale in _bank():
        linear = _linear(rotation, scale)
        b, _ = coarse.turned(linear, np.zeros(2))
        significance, offset = correlator.peak(b, 0.7)
        peaks.append(Peak(significance, linear, linear @ offset))
    peaks.sort(key=lambda p: -p.significance)
    for peak in peaks[:4]:
        if peak.significance < SIGNIFICANT:
            break
        start = _refine(coarse, peak)
        if start is not None:
            return start, peak
    return None, peaks[0]


def find_start(
    reference: AnyArray,
    moving: AnyArray,
    weight_reference: AnyArray | None,
    weight_moving: AnyArray | None,
    settings: RegistrationSettings,
) -> Start:
    """Find camera 2's offset, rotation and scale against camera 1.

    Parameters
    ----------
    reference, moving : array, (y, x)
        Counts above dark of the cameras; the orientation of the settings is applied to ``moving`` already.
    weight_reference, weight_moving : array, (y, x), optional
        0 for pixels that must not count.
    settings : RegistrationSettings
        ``search`` bounds the offset.

    Raises
    ------
    RegistrationError
        If the frames share no texture, if camera 2 is mirrored or turned against the settings, or if the offset is
        beyond the search range.
    """
    factor = coarse_binning(
        (min(reference.shape[0], moving.shape[0]), min(reference.shape[1], moving.shape[1]))
    )
    coarse = _prepare(reference, moving, weight_reference, weight_moving, factor)
    if not (coarse.wa > 0).mean() > 0.05 or not (coarse.wb > 0).mean() > 0.05:
        raise RegistrationError(
            "Registration needs light on both cameras, but hardly any pixel of "
            f"camera {1 if not (coarse.wa > 0).mean() > 0.05 else 2} is both lit and sound. "
            "Check the exposure, the dark frames and the masks."
        )
    correlator = _Correlator(coarse, settings.search)
    best = Peak(0.0, np.eye(2), np.zeros(2))
    for search in (_search_still, _search_bank):
        start, peak = search(coarse, correlator)
        if start is not None:
            return start
        best = max(best, peak, key=lambda p: p.significance)
    _explain(reference, moving, weight_moving, settings, coarse)
    raise RegistrationError(
        "No common texture found in the images of the two cameras: the highest peak of their cross-correlation stands "
        f"{best.significance:.1f} times above chance, {SIGNIFICANT:.0f} are needed, within an offset of "
        f"{settings.search:.0%} of the frame, 5 degrees and 5 % of scale. Check that both cameras see the same field in "
        "focus and in the same pulse, and that more light than noise reaches them."
    )


def _explain(
    reference: AnyArray,
    moving: AnyArray,
    weight_moving: AnyArray | None,
    settings: RegistrationSettings,
    coarse: _Coarse,
) -> None:
    """Raise what is known about why the frames do not fit: turned, mirrored, or too far off."""
    for search in (_search_still, _search_bank):
        for other in ORIENTATIONS[1:]:
            turned = np.ascontiguousarray(orient(moving, other))
            weight = (
                None
                if weight_moving is None
                else np.ascontiguousarray(orient(weight_moving, other))
            )
            b, wb = _textures(turned, weight, coarse.factor)
            trial = replace(coarse, **_second(b, wb))
            start, peak = search(trial, _Correlator(trial, settings.search))
            if start is None or start.agreement < 0.5 or peak.significance < SIGNIFICANT:
                continue
            total = combined_orientation(settings.orientation, other)
            raise RegistrationError(
                f"Camera 2 is expected in orientation {settings.orientation!r} but its image fits that of camera 1 when "
                f'it is taken as {total!r}. Set orientation = "{total}" in the settings of the registration, or mount '
                "the camera the other way."
            )
    correlator = _Correlator(coarse, settings.search)
    best = Peak(0.0, np.eye(2), np.zeros(2))
    for rotation, scale in _bank():
        linear = _linear(rotation, scale)
        b, _ = coarse.turned(linear, np.zeros(2))
        significance, offset = correlator.peak(b, 0.7, everywhere=True)
        if significance > best.significance:
            best = Peak(significance, linear, linear @ offset)
    reach = settings.search * np.array(coarse.a.shape[::-1])
    if best.significance > SIGNIFICANT and bool((np.abs(best.shift) > 0.98 * reach).any()):
        dx, dy = (float(v) * coarse.factor for v in best.shift)
        raise RegistrationError(
            f"Camera 2 is searched within {settings.search:.0%} of the frame, but its image fits at an offset of "
            f"({dx:.0f}, {dy:.0f}) px. Move its region of interest by that much, or raise search (at most 0.4)."
        )


def combined_orientation(first: str, second: str) -> str:
    """The one orientation that turns an image as ``first`` and then ``second`` do."""
    probe = np.arange(6).reshape(2, 3)
    both = orient(orient(probe, first), second)
    return next(name for name in ORIENTATIONS if np.array_equal(orient(probe, name), both))
