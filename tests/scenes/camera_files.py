"""Writers of camera files, after the descriptions of the formats and not after the readers.

Packed counts are written and decoded bit by bit, so that they are an independent reference.
"""

from __future__ import annotations

import json
import struct
import tomllib
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

_HEADERS = tomllib.loads(Path(__file__).with_name("headers.toml").read_text(encoding="utf-8"))

BIT_ORDERS = {
    "HIGH_12": ("big", 12),
    "LOW_12": ("little", 12),
    "HIGH_10": ("big", 10),
    "LOW_10": ("little", 10),
}
"""Order and number of the bits of a stream without gaps."""


def counts_of_bits(packed: np.ndarray, packing: str) -> np.ndarray:
    """Decode packed counts bit by bit; whole groups of bytes only."""
    if packing.startswith("SPLIT"):
        low_bits = int(packing[-2:]) - 8
        counts = []
        for first, between, second in packed.reshape(-1, 3).tolist():
            low = f"{between:08b}"[::-1]  # place 0 is the lowest bit
            counts.append((first << low_bits) + int(low[:low_bits][::-1], 2))
            counts.append((second << low_bits) + int(low[4 : 4 + low_bits][::-1], 2))
        return np.array(counts, np.uint16)

    order, depth = BIT_ORDERS[packing]
    bits = np.unpackbits(packed, bitorder=order).reshape(-1, depth).astype(np.int64)
    powers = 2 ** np.arange(depth)
    return (bits @ (powers if order == "little" else powers[::-1])).astype(np.uint16)


def pack_counts(counts: np.ndarray, packing: str) -> bytes:
    """Pack counts bit by bit; the last byte is filled with zeros."""
    flat = counts.reshape(-1).astype(np.uint16)
    if packing.startswith("SPLIT"):
        low_bits = int(packing[-2:]) - 8
        one, two = np.append(flat, np.zeros(flat.size % 2, np.uint16)).reshape(-1, 2).T
        low = [(count % 2**low_bits) for count in (one, two)]
        groups = [one // 2**low_bits, low[0] + 16 * low[1], two // 2**low_bits]
        return np.stack(groups, axis=1).astype(np.uint8).tobytes()

    order, depth = BIT_ORDERS[packing]
    places = np.arange(depth) if order == "little" else np.arange(depth)[::-1]
    bits = (flat[:, np.newaxis] >> places.astype(np.uint16)) & 1
    return np.packbits(bits.astype(np.uint8), bitorder=order).tobytes()


def random_frames(rng: np.random.Generator, *, frames=3, rows=6, columns=8, bits=12) -> np.ndarray:
    """Frames whose counts use every bit, (frame, y, x)."""
    dtype = np.uint8 if bits <= 8 else np.uint16
    return rng.integers(0, 1 << bits, (frames, rows, columns)).astype(dtype)


def write_mraw(
    path: Path,
    frames: np.ndarray,
    *,
    stored=16,
    depth=12,
    rate="2000",
    header="cihx",
    side="Lower",
    step=1,
    claimed: int | None = None,
) -> Path:
    """A Photron recording: counts and a header in the spelling of PFV 4 (cihx) or PFV 3 (cih)."""
    if stored == 12:
        counts = b"".join(pack_counts(frame, "HIGH_12") for frame in frames)
    else:
        counts = frames.astype("<u2" if stored == 16 else "|u1").tobytes()
    path.write_bytes(counts)

    count, rows, columns = frames.shape
    count = count if claimed is None else claimed
    values = {"rate": rate, "count": count, "step": step, "columns": columns, "rows": rows}
    values |= {"stored": stored, "depth": depth, "side": side, "empty": ""}
    if header == "cih":
        comment = b"Comment : \x83\x65\x83\x58\x83\x67\r\n"  # in the code page of Japan
        text = _HEADERS["cih"].format(**values).replace("\n", "\r\n").encode() + comment
        path.with_suffix(".cih").write_bytes(text)
        return path

    preamble = b"!!! This file can not be edited. !!!\0\0\0\0CIHX\0\0\0\0"
    xml = _HEADERS["cihx"].format(**values).encode()
    path.with_suffix(".cihx").write_bytes(preamble + xml)
    return path


def write_cine(
    path: Path,
    frames: np.ndarray,
    *,
    stored="16",
    height_sign=1,
    depth=12,
    rate=1000,
    times: np.ndarray | None = None,
    decimation=1,
    compression=0,
    padded_rows=False,
    gap=0,
    note=b"",
    serial=0,
) -> Path:
    """A Phantom recording; `stored` is "8", "16", "packed 10" or "packed 12".

    Frames packed to 10 bits are given as the 10-bit values. `gap` bytes lie before the first frame,
    `note` is the annotation of each frame, `times` are in seconds since 1970.
    """
    count, rows, columns = frames.shape
    packing = {"packed 10": (256, "HIGH_10"), "packed 12": (1024, "HIGH_12")}
    bitmap_compression, order = packing.get(stored, (0, ""))
    bits = 8 if stored == "8" else 16

    def encode(frame: np.ndarray) -> bytes:
        if order:  # packed frames begin with the highest row
            return pack_counts(frame, order)
        lines = frame[::-1] if height_sign > 0 else frame
        data = [line.astype(f"<u{bits // 8}").tobytes() for line in lines]
        if padded_rows:
            data = [line + b"\x55" * (-len(line) % 4) for line in data]
        return b"".join(data)

    images = [encode(frame) for frame in frames]
    bitmap = struct.pack(
        "<IiiHHIIiiII", 40, columns, height_sign * rows, 1, bits, bitmap_compression,
        len(images[0]), 45454, 45454, 0, 1 << depth,
    )  # fmt: skip

    setup = bytearray(5692)
    struct.pack_into("<H", setup, 0, min(rate, 65535))
    struct.pack_into("<2sH", setup, 140, b"ST", len(setup))
    struct.pack_into("<I", setup, 743, serial)
    struct.pack_into("<I", setup, 768, rate)
    struct.pack_into("<I", setup, 896, depth)
    struct.pack_into("<I", setup, 1556, decimation)

    tags = b""
    if times is not None:
        stamps = [(int(t) << 32) + round((t % 1) * 2**32) for t in times]
        block = struct.pack(f"<{count}Q", *stamps)
        tags += struct.pack("<IHH", 8 + len(block), 1002, 1) + block
    tags += struct.pack("<IHH", 8 + 4 * count, 1003, 0) + bytes(4 * count)  # exposures

    offset_table = 44 + 40 + len(setup) + len(tags)
    place, places = offset_table + 8 * count + gap, []
    for image in images:
        places.append(place)
        place += 8 + len(note) + len(image)

    header = struct.pack(
        "<2sHHHiIiIIIIQ", b"CI", 44, compression, 1, -100, 5000, -50, count, 44, 84, offset_table,
        1 << 62,
    )  # fmt: skip
    with path.open("wb") as file:
        file.write(header + bitmap + setup + tags + struct.pack(f"<{count}Q", *places))
        for start, image in zip(places, images, strict=True):
            file.seek(start)
            file.write(struct.pack("<I", 8 + len(note)) + note + struct.pack("<I", len(image)))
            file.write(image)
    return path


def write_seq(
    path: Path,
    frames: np.ndarray,
    *,
    version=5,
    bits=16,
    significant=12,
    image_format=100,
    rate=100.0,
    times: np.ndarray | None = None,
    align=512,
    claimed: int | None = None,
    compression=0,
    row_padding=0,
    oldest=0,
) -> Path:
    """A NorPix sequence with time stamps behind the counts, each frame at a multiple of `align`."""
    count, rows, columns = frames.shape
    order = ">" if image_format == 114 else "<"
    images = []
    for frame in frames:
        lines = frame.astype(f"{order}u{bits // 8}")
        images.append(b"".join(line.tobytes() + b"\x77" * row_padding for line in lines))
    step = -(-(len(images[0]) + 8) // align) * align

    start = 8192 if version >= 5 else 1024
    header = bytearray(start)
    struct.pack_into("<I", header, 0, 0xFEED)
    header[4:28] = "Norpix seq\n\0".encode("utf-16-le")
    struct.pack_into("<ii", header, 28, version, 1024)
    struct.pack_into(
        "<9Id", header, 548, columns, rows, bits, significant, len(images[0]), image_format,
        count if claimed is None else claimed, 0, step, rate,
    )  # fmt: skip
    struct.pack_into("<I", header, 620, compression)
    struct.pack_into("<I", header, 656, oldest)

    data = bytes(header)
    for number, image in enumerate(images):
        stamp = bytes(8)
        if times is not None:
            micro = round(times[number] * 1e6)
            rest = micro % 1_000_000
            stamp = struct.pack("<IHH", micro // 1_000_000, rest // 1000, rest % 1000)
            stamp = stamp if version >= 5 else stamp[:6] + b"\xff\xff"
        data += (image + stamp).ljust(step, b"\x99")
    path.write_bytes(data)
    return path


def write_genicam(
    path: Path,
    images: np.ndarray,
    pixel_format: str,
    *,
    sidecar="toml",
    header: bytes = b"",
    **entries: object,
) -> Path:
    """Raw frames and their description."""
    packings = {
        "Mono10p": "LOW_10",
        "Mono12p": "LOW_12",
        "Mono10Packed": "SPLIT_10",
        "Mono12Packed": "SPLIT_12",
        "Mono10pmsb": "HIGH_10",
        "Mono12pmsb": "HIGH_12",
    }
    if pixel_format in packings:
        data = b"".join(pack_counts(frame, packings[pixel_format]) for frame in images)
    else:
        data = images.astype("|u1" if pixel_format == "Mono8" else "<u2").tobytes()
    path.write_bytes(header + data)

    _, rows, columns = images.shape
    keys = {"width": columns, "height": rows, "pixel_format": pixel_format, **entries}
    if sidecar == "toml":
        lines = [f"{key} = {json.dumps(value)}" for key, value in keys.items()]
        path.with_suffix(".toml").write_text("\n".join(lines))
    else:
        path.with_suffix(".json").write_text(json.dumps(keys))
    return path


def write_b16(path: Path, frame: np.ndarray, *, start=512, colour=0) -> Path:
    """A PCO frame."""
    rows, columns = frame.shape
    header = struct.pack(
        "<4s6i", b"PCO-", start + frame.size * 2, start, columns, rows, -1, colour
    ).ljust(start, b"\0")
    path.write_bytes(header + frame.astype("<u2").tobytes())
    return path


def write_spe2(path: Path, frames: np.ndarray, *, kind=3, resolution=16, regions=1) -> Path:
    """A WinView recording; `kind` is the number of the type of its counts."""
    count, rows, columns = frames.shape
    header = bytearray(4100)
    struct.pack_into("<H", header, 42, columns)
    struct.pack_into("<h", header, 108, kind)
    struct.pack_into("<H", header, 194, resolution)
    struct.pack_into("<H", header, 656, rows)
    struct.pack_into("<i", header, 1446, count)
    struct.pack_into("<h", header, 1510, regions)
    struct.pack_into("<f", header, 1992, 2.5)
    struct.pack_into("<h", header, 4098, 0x5555)
    types = {0: "<f4", 1: "<i4", 2: "<i2", 3: "<u2", 5: "<f8", 6: "|u1", 8: "<u4"}
    path.write_bytes(bytes(header) + frames.astype(types[kind]).tobytes())
    return path


def write_spe3(
    path: Path, frames: np.ndarray, *, stamp=8, regions=1, behind: Sequence[bytes] = (), meta=""
) -> Path:
    """A LightField recording with `stamp` bytes, or those of `behind`, behind each frame."""
    count, rows, columns = frames.shape
    ends = behind or [b"\xaa" * stamp] * count
    stamp = len(ends[0])
    data = b"".join(
        frame.astype("<u2").tobytes() + end for frame, end in zip(frames, ends, strict=True)
    )
    region = _HEADERS["spe_region"].format(columns=columns, rows=rows, size=frames[0].size * 2)
    text = _HEADERS["spe"].format(
        count=count,
        size=frames[0].size * 2,
        stride=frames[0].size * 2 + stamp,
        regions=region * regions,
        meta=meta,
    )
    header = bytearray(4100)
    struct.pack_into("<Q", header, 678, 4100 + len(data))
    struct.pack_into("<f", header, 1992, 3.0)
    path.write_bytes(bytes(header) + data + text.encode())
    return path


def encode_imx(counts: np.ndarray) -> bytes:
    """Compress counts as the description in ReadIMX.cpp has it, with every kind of code."""
    values = counts.reshape(-1).astype(int).tolist()
    out, place = bytearray(), 0

    def difference(n: int) -> int:
        return values[n] - (values[n - 1] if n else 0)

    while place < len(values):
        run = 0
        while place + run < len(values) and abs(difference(place + run)) <= 7:
            run += 1
        run -= 1 - run % 2  # the pair with the end has one value: an odd number of them
        if run >= 3:
            halves = [difference(place + n) & 15 for n in range(run)] + [8]
            out.append(0x81)
            out += bytes(a << 4 | b for a, b in zip(halves[::2], halves[1::2], strict=True))
            place += run
        elif abs(difference(place)) <= 126:
            out.append(difference(place) & 0xFF)
            place += 1
        else:
            run = 1
            while place + run < len(values) and run < 255 and abs(difference(place + run)) > 126:
                run += 1
            out += b"\x80" if run == 1 else bytes([0x7F, run])
            out += struct.pack(f"<{run}H", *values[place : place + run])
            place += run
    return bytes(out)


def write_im7(
    path: Path,
    frames: np.ndarray,
    *,
    packing=0,
    buffer=-4,
    preview=(3, 2),
    attributes: Sequence[bytes] = (b"Signal0=LIF",),
) -> Path:
    """A LaVision image: packing 0 plain, 1 IMX, 2 zlib, 3 in 12 bits."""
    count, rows, columns = frames.shape
    header = struct.pack("<4h4i", 0, packing, buffer, 0, columns, rows, 1, count).ljust(256, b"\0")
    types = {-2: "|u1", -3: "<f4", -4: "<u2"}
    plain = frames.astype(types[buffer]).tobytes()
    if packing == 0:
        data = plain
    elif packing == 1:
        data = bytes(preview) + bytes(preview[0] * preview[1]) + encode_imx(frames)
    elif packing == 2:
        stream = zlib.compress(plain)
        data = struct.pack("<i", len(stream)) + stream
    else:
        head = columns // 4 * 4
        lines = frames.reshape(-1, columns)
        data = b"".join(
            pack_counts(line[:head], "LOW_12") + line[head:].astype("<u2").tobytes()
            for line in lines
        )
    texts = b"".join(struct.pack("<ii", 6, len(text)) + text for text in attributes)
    path.write_bytes(header + data + texts + bytes(8))
    return path


def fits_header(**cards) -> bytes:
    """Cards of 80 characters, the last one END, filled with blanks to blocks of 2880."""
    lines = []
    for key, value in cards.items():
        text = f"'{value:<8}'" if isinstance(value, str) and len(value) > 1 else str(value)
        lines.append(f"{key:<8}= {text:>20} / text = 'more'".ljust(80)[:80])
    text = "".join([*lines, "COMMENT no value here".ljust(80), "END".ljust(80)])
    return text.ljust(-(-len(text) // 2880) * 2880).encode()


def fits_image(bitpix: int, *axes: int, **cards) -> bytes:
    sizes = {f"NAXIS{n}": length for n, length in enumerate(axes, 1)}
    return fits_header(SIMPLE="T", BITPIX=bitpix, NAXIS=len(axes), **sizes, **cards)


def padded(data: bytes) -> bytes:
    return data.ljust(-(-len(data) // 2880) * 2880, b"\0")


def unsigned(counts: np.ndarray) -> bytes:
    """Counts less 32768, big-endian: the convention for 16 unsigned bits."""
    return padded((counts.astype(np.int32) - 32768).astype(">i2").tobytes())


def write_fits(path: Path, frames: np.ndarray) -> Path:
    """FITS after the standard 4.0: unsigned counts with their zero moved."""
    count, rows, columns = frames.shape
    path.write_bytes(fits_image(16, columns, rows, count, BZERO=32768) + unsigned(frames))
    return path


RAMP = np.repeat(np.arange(256, dtype=np.uint8)[:, None], 4, axis=1)


def bitmap_rows(image) -> bytes:
    """From the lowest row up, each filled to a multiple of four bytes."""
    return np.pad(image[::-1], ((0, 0), (0, -image.shape[1] % 4))).tobytes()


def write_bmp(path: Path, counts: np.ndarray) -> Path:
    """BMP of 8 bits with a palette of as many greys as there are counts."""
    greys = int(counts.max()) + 1
    rows, columns = counts.shape
    start = 54 + 4 * greys
    data = bitmap_rows(counts)
    head = struct.pack("<2sIII", b"BM", start + len(data), 0, start)
    form = struct.pack("<IiiHHIIiiII", 40, columns, rows, 1, 8, 0, len(data), 0, 0, greys, 0)
    path.write_bytes(head + form + RAMP[:greys].tobytes() + data)
    return path
