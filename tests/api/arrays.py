"""Arrays: reads and writes the container of server/doc/020, version 1."""
import struct

TYPES = {1: "d", 2: "f", 3: "I"}


def read(content):
    """Returns a dictionary: name to (columns, flat list)."""
    magic, version, count = struct.unpack_from("<8sII", content)
    assert (magic, version) == (b"GDARRAYS", 1), (magic, version)
    arrays = {}
    for i in range(count):
        name, kind, columns, rows, offset, size = struct.unpack_from("<32sIIQQQ", content, 16 + 64 * i)
        number = rows * (columns or 1)
        assert offset % 8 == 0 and size == number * struct.calcsize("<" + TYPES[kind])
        arrays[name.rstrip(b"\0").decode()] = (columns, list(struct.unpack_from(f"<{number}{TYPES[kind]}", content, offset)))
    return arrays


def write(**arrays):
    """Returns the container of the arrays name=(type letter, columns, flat list)."""
    kinds = {letter: kind for kind, letter in TYPES.items()}
    head, data = struct.pack("<8sII", b"GDARRAYS", 1, len(arrays)), b""
    for name, (letter, columns, numbers) in arrays.items():
        content = struct.pack(f"<{len(numbers)}{letter}", *numbers)
        offset = 16 + 64 * len(arrays) + len(data)
        head += struct.pack("<32sIIQQQ", name.encode(), kinds[letter], columns, len(numbers) // (columns or 1), offset, len(content))
        data += content + bytes(-len(content) % 8)
    return head + data


def read_npy(content):
    """Returns (shape, flat list)."""
    assert content[:8] == b"\x93NUMPY\x01\x00"
    size, = struct.unpack_from("<H", content, 8)
    assert (10 + size) % 64 == 0 and content[9 + size:10 + size] == b"\n"
    head = eval(content[10:10 + size])  # the daemon wrote this literal
    letter = {"<f8": "d", "<u4": "I"}[head["descr"]]
    number = 1
    for length in head["shape"]:
        number *= length
    assert len(content) == 10 + size + number * struct.calcsize("<" + letter) and not head["fortran_order"]
    return head["shape"], list(struct.unpack_from(f"<{number}{letter}", content, 10 + size))
