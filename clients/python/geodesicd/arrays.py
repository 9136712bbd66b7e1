"""The arrays container, version 1: the binary form of numbers in requests and answers
(server/doc/020)."""
from __future__ import annotations

import array
import importlib
import struct
import sys
from typing import Any, Dict, Mapping, Union

numpy: Any = None  # the numpy module, or None if numpy is not installed
try:
    numpy = importlib.import_module("numpy")
except ImportError:
    pass

MEDIA_TYPE = "application/octet-stream"
_HEAD, _ENTRY = struct.Struct("<8sII"), struct.Struct("<32sIIQQQ")
_LETTERS = {1: "d", 2: "f", 3: "I"}
_INDEX_MOST = 2**32 - 1
_TYPES = {letter: number for number, letter in _LETTERS.items()}


def little(values: "array.array[Any]") -> "array.array[Any]":
    if sys.byteorder == "big":
        values.byteswap()
    return values


def read(body: Union[bytes, bytearray]) -> Dict[str, Any]:
    """Returns the arrays of a container by name. They are writable and stored by rows: numpy
    arrays, or array.array if numpy is missing."""
    body = bytearray(body)
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
            arrays[name.rstrip(b"\0").decode()] = little(array.array(_LETTERS[kind], body[offset:offset + size]))
    return arrays


def floats(body: bytes) -> Any:
    """Converts little-endian float64 to a writable numpy array, or to an array.array if numpy is
    missing."""
    return numpy.frombuffer(bytearray(body), "<f8") if numpy is not None else little(array.array("d", body))


def _flat(values: Any) -> Any:
    """Returns (type letter as in array.array, columns, bytes) of a numpy array, an array.array, or
    a list of numbers or of triples. Columns are 0 if the rows are single numbers."""
    if numpy is not None and not isinstance(values, array.array):
        given = numpy.asarray(values)
        if given.dtype == bool and given.ndim == 1:
            given = numpy.flatnonzero(given)
        if given.dtype.kind not in "iuf":
            raise TypeError(f"arrays hold vertex indices or rows of three coordinates, not {given.ravel()[0]!r}")
        letter = "I" if given.dtype.kind in "iu" and given.ndim == 1 else "f" if given.dtype == numpy.float32 else "d"
        if letter == "I" and given.size and not 0 <= given.min() <= given.max() <= _INDEX_MOST:
            raise ValueError(f"indices are from 0 to {_INDEX_MOST}, not {given.min()} or {given.max()}")
        if letter != "I" and given.shape == (3,):
            given = given.reshape(1, 3)
        given = numpy.ascontiguousarray(given, {"I": "<u4", "f": "<f4", "d": "<f8"}[letter])
        return letter, given.shape[1] if given.ndim == 2 else 0, given.tobytes()
    if isinstance(values, array.array):
        letter = "I" if values.typecode in "bBhHiIlLqQ" else values.typecode
        return letter, 0 if letter == "I" else 3, little(array.array(letter, values)).tobytes()
    if values and hasattr(values[0], "__len__"):
        return "d", len(values[0]), little(array.array("d", (x for row in values for x in row))).tobytes()
    return "I", 0, little(array.array("I", values)).tobytes()


def write(arrays: Mapping[str, Any]) -> bytes:
    """Returns a container of the named arrays. Integers are indices of vertices or faces; other
    arrays hold rows of three coordinates. A flat array.array of floats holds such rows, too."""
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
