"""Reads the PNG files of the tests: 8 bits, colour with or without alpha, not interlaced (ISO/IEC 15948)."""

import struct
import zlib
from pathlib import Path

import numpy


def chunks(path: Path):
    """Names and contents, after checking every sum."""
    data = Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, found = 8, []
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        content = data[at + 8:at + 8 + length]
        (check,) = struct.unpack(">I", data[at + 8 + length:at + 12 + length])
        assert zlib.crc32(name + content) == check, name
        found.append((name.decode(), content))
        at += 12 + length
    assert found[0][0] == "IHDR" and found[-1] == ("IEND", b"")
    return found


def read(path: Path) -> numpy.ndarray:
    """Pixels as rows of red, green, blue and, where there is one, alpha."""
    content = chunks(path)
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", content[0][1])
    assert (depth, interlaced) == (8, 0)
    size = {2: 3, 6: 4}[kind]
    raw = zlib.decompress(b"".join(data for name, data in content if name == "IDAT"))
    rows = numpy.frombuffer(raw, dtype=numpy.uint8).reshape(height, 1 + width * size)
    # What a pixel is filtered with stands at its left, above it, and left above it. The pixels of a diagonal need only
    # the two diagonals before it and are found together: `found[x + y + 2, y + 1]` is pixel x of row y, and what lies
    # outside is zero.
    found = numpy.zeros((width + height + 1, height + 1, size), dtype=numpy.int16)
    for y, row in enumerate(rows):
        found[y + 2:y + 2 + width, y + 1] = row[1:].reshape(width, size)
    _, by_left, by_above, by_mean, by_paeth = (rows[:, :1] == kind for kind in range(5))
    for diagonal in range(width + height - 1):
        here = slice(max(diagonal - width + 1, 0), min(diagonal + 1, height))
        inside, over = slice(here.start + 1, here.stop + 1), here
        a, b, c = found[diagonal + 1, inside], found[diagonal + 1, over], found[diagonal, over]
        far = abs(b - c), abs(a - c), abs(a + b - 2 * c)
        paeth = numpy.where((far[0] <= far[1]) & (far[0] <= far[2]), a, numpy.where(far[1] <= far[2], b, c))
        expected = a * by_left[here] + b * by_above[here] + (a + b) // 2 * by_mean[here] + paeth * by_paeth[here]
        found[diagonal + 2, inside] = (found[diagonal + 2, inside] + expected) & 255
    pixels = [found[y + 2:y + 2 + width, y + 1] for y in range(height)]
    return numpy.array(pixels, dtype=numpy.uint8)
