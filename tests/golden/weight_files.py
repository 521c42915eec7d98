"""Reads and writes numpy arrays by name in safetensors files, for the scripts that write what other libraries compute."""

import json
import struct

import numpy

TYPES = {"F32": "<f4", "F64": "<f8", "U8": "u1"}


def read(path):
    """The arrays of the types above."""
    data = path.read_bytes()
    (length,) = struct.unpack("<Q", data[:8])
    arrays = {}
    for name, entry in json.loads(data[8 : 8 + length]).items():
        if name != "__metadata__" and entry["dtype"] in TYPES:
            begin, end = (8 + length + offset for offset in entry["data_offsets"])
            arrays[name] = numpy.frombuffer(data[begin:end], TYPES[entry["dtype"]]).reshape(entry["shape"])
    return arrays


def write(path, arrays, metadata=None):
    kinds = {numpy.dtype(kind): name for name, kind in TYPES.items()}
    header, data = {"__metadata__": metadata} if metadata else {}, b""
    for name, array in arrays.items():
        offsets = [len(data), len(data) + array.nbytes]
        header[name] = {"dtype": kinds[array.dtype], "shape": array.shape, "data_offsets": offsets}
        data += array.tobytes()
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    path.write_bytes(struct.pack("<Q", len(text)) + text + data)
