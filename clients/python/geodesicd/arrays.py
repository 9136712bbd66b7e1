"""The arrays container, version 1: numbers as bytes in requests and answers (server/doc/020 of the daemon)."""
import array
import struct
import sys
from typing import Any, Dict, Mapping

try:
    import numpy
except ImportError:
    numpy = None  # type: ignore[assignment]

MEDIA_TYPE = "application/octet-stream"
_HEAD, _ENTRY = struct.Struct("<8sII"), struct.Struct("<32sIIQQQ")
_LETTERS = {1: "d", 2: "f", 3: "I"}
_TYPES = {letter: number for number, letter in _LETTERS.items()}


def _little(values: "array.array[Any]") -> "array.array[Any]":
    if sys.byteorder == "big":
        values.byteswap()
    return values


def read(body: bytes) -> Dict[str, Any]:
    """The arrays by name: numpy's, or without numpy an array.array each, row after row."""
    magic, version, count = _HEAD.unpack_from(body)
    if (magic, version) != (b"GDARRAYS", 1):
        raise ValueError("no arrays container of version 1")
    arrays: Dict[str, Any] = {}
    for i in range(count):
        name, kind, columns, rows, offset, size = _ENTRY.unpack_from(body, _HEAD.size + _ENTRY.size * i)
        if numpy is not None:
            letter = {"d": "<f8", "f": "<f4", "I": "<u4"}[_LETTERS[kind]]
            values = numpy.frombuffer(body, letter, rows * (columns or 1), offset)
            arrays[name.rstrip(b"\0").decode()] = values.reshape(rows, columns) if columns else values
        else:
            arrays[name.rstrip(b"\0").decode()] = _little(array.array(_LETTERS[kind], body[offset:offset + size]))
    return arrays


def _flat(values: Any) -> Any:
    """(array.array-like letter, columns, bytes) of a numpy array, an array.array, or a list of numbers or of triples."""
    if numpy is not None and not isinstance(values, array.array):
        given = numpy.asarray(values)
        letter = "I" if given.dtype.kind in "iu" and given.ndim == 1 else "f" if given.dtype == numpy.float32 else "d"
        given = numpy.ascontiguousarray(given, {"I": "<u4", "f": "<f4", "d": "<f8"}[letter])
        return letter, given.shape[1] if given.ndim == 2 else 0, given.tobytes()
    if isinstance(values, array.array):
        letter = "I" if values.typecode in "bBhHiIlLqQ" else values.typecode
        return letter, 0 if letter == "I" else 3, _little(array.array(letter, values)).tobytes()
    if values and hasattr(values[0], "__len__"):
        return "d", len(values[0]), _little(array.array("d", (x for row in values for x in row))).tobytes()
    return "I", 0, _little(array.array("I", values)).tobytes()


def write(arrays: Mapping[str, Any]) -> bytes:
    """A container: of each name whole numbers, which are vertices or faces, or rows of three coordinates. An array.array of numbers is rows of three."""
    head, data = [_HEAD.pack(b"GDARRAYS", 1, len(arrays))], []
    offset = _HEAD.size + _ENTRY.size * len(arrays)
    for name, values in arrays.items():
        letter, columns, content = _flat(values)
        size = len(content)
        rows = size // struct.calcsize("<" + letter) // (columns or 1)
        head.append(_ENTRY.pack(name.encode(), _TYPES[letter], columns, rows, offset, size))
        data.append(content + bytes(-size % 8))
        offset += size + -size % 8
    return b"".join(head + data)
