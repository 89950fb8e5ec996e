"""Writers of camera files, after the descriptions of the formats and not after the readers.

Packed counts are written and decoded bit by bit, so that they are an independent reference.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

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
    flat = counts.reshape(-1).astype(int).tolist()
    if packing.startswith("SPLIT"):
        low_bits = int(packing[-2:]) - 8
        flat += [0] * (len(flat) % 2)
        out = bytearray()
        for one, two in zip(flat[::2], flat[1::2], strict=True):
            mask = (1 << low_bits) - 1
            out += bytes([one >> low_bits, (one & mask) | (two & mask) << 4, two >> low_bits])
        return bytes(out)

    order, depth = BIT_ORDERS[packing]
    step = 1 if order == "big" else -1
    text = "".join(f"{count:0{depth}b}"[::step] for count in flat)
    text += "0" * (-len(text) % 8)
    return bytes(int(text[n : n + 8][::step], 2) for n in range(0, len(text), 8))


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
    if header == "cih":
        text = (
            "#Camera Information Header\r\nDate : 2026/11/22\r\nCamera Type : FASTCAM SA-Z\r\n"
            f"Record Rate(fps) : {rate}\r\nShutter Speed(s) : 1/800000\r\nTrigger Mode : Start\r\n"
            f"Original Total Frame : 677\r\nTotal Frame : {count}\r\nStart Frame : 49300\r\n"
            f"Save Step : {step}\r\nImage Width : {columns}\r\nImage Height : {rows}\r\n"
            f"Color Type : Mono\r\nColor Bit : {stored}\r\nFile Format : MRaw\r\n"
            f"EffectiveBit Depth : {depth}\r\nEffectiveBit Side : {side}\r\n"
            "Comment Text : \r\n\r\n#Photron Fastcam Viewer Version Information (Resave):\r\n"
            "Saved Date : 2026/11/22\r\nD1024PCI.dll : 2.0.0.0\r\n"
        ).encode() + b"Comment : \x83\x65\x83\x58\x83\x67\r\n"  # in the code page of Japan
        path.with_suffix(".cih").write_bytes(text)
        return path

    size = f"<resolution>\n<width>{columns}</width>\n<height>{rows}</height>\n</resolution>"
    xml = (
        '<?xml version="1.0" encoding="utf-8"?>\n<cih>\n<fileInfo><version>1.0</version></fileInfo>'
        f"<imageFileInfo><fileFormat>Mraw</fileFormat>{size}</imageFileInfo>\n"
        f"<imageDataInfo>{size}<colorInfo><type>Raw</type><bit>{stored}</bit></colorInfo>\n"
        f"<effectiveBit><depth>{depth}</depth><side>{side}</side></effectiveBit></imageDataInfo>\n"
        f"<frameInfo><recordedFrame>2000</recordedFrame><totalFrame>{count}</totalFrame>"
        f"<startFrame>52</startFrame><skipFrame>{step}</skipFrame></frameInfo>\n"
        f"<recordInfo><recordRate>{rate}</recordRate><shutterSpeed>50000</shutterSpeed>"
        "<shutterSpeedNsec>20000</shutterSpeedNsec></recordInfo>\n"
        "<deviceInfo><recordRate>1</recordRate><resolution><width>1</width><height>1</height>"
        "</resolution></deviceInfo>\n</cih>\n"
    ).encode()
    preamble = b"!!! This file can not be edited. !!!\0\0\0\0CIHX\0\0\0\0"
    path.with_suffix(".cihx").write_bytes(preamble + xml)
    return path
