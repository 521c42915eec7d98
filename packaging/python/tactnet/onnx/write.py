"""The files that an import writes: header, weights, report."""

import json
import os
import re
import struct

import numpy

from ..files import write_safely

TYPES = {"float32": "F32", "float64": "F64", "uint8": "U8", "int64": "I64"}
RESERVED = {"tactnet", "std", "net", "int", "float", "double", "char", "bool", "new", "class", "default", "switch", "this", "main",
            "template", "namespace", "public", "private", "union", "struct", "long", "short", "auto", "register", "export"}


def identifier(text):
    """A name for a namespace."""
    name = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_").lower() or "model"
    return f"{name}_network" if name in RESERVED or name[0].isdigit() else name


def safetensors(arrays, metadata):
    header, data = {"__metadata__": metadata}, b""
    for name, array in arrays.items():
        array = numpy.array(array, order="C")
        header[name] = {"dtype": TYPES[array.dtype.name], "shape": list(array.shape), "data_offsets": [len(data), len(data) + array.nbytes]}
        data += array.astype(array.dtype.newbyteorder("<")).tobytes()
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    return struct.pack("<Q", len(text)) + text + data


def wrapped(parts, first, width=110):
    """`first` and the parts, separated by commas, in lines of about this width."""
    lines, line = [], first
    for i, part in enumerate(parts):
        part += "," if i + 1 < len(parts) else ""
        if len(line) + 1 + len(part) > width and line.strip():
            lines.append(line)
            line = " " * 8 + part
        else:
            line += ("" if line.endswith("<") else " ") + part
    return "\n".join(lines + [line])


def header(network):
    rows, columns, channels = network.shape
    shape = f"shape{{{rows}, {columns}{f', {channels}' if channels > 1 else ''}}}"
    layers = wrapped([shape] + [str(layer) for layer in network.layers], "using net = network<")
    stream = any(layer.kind in ("gru", "lstm", "last") or str(layer).startswith("causal") for layer in network.all_layers())
    use = f'tactnet::load_model<{network.name}::net>("{network.name}.safetensors"), then tactnet::deploy_stream (tactnet/deployment/stream.hpp)' if stream else \
        f'tactnet::load_deployed<{network.name}::net>("{network.name}.safetensors")'
    ratio = "\n#include <ratio>\n" if "std::ratio" in layers else ""
    note = f"\n// which repeats the self-test: {len(network.selftest_input)} frames of counts and what the ONNX model makes of them."
    return header_of(network, "tactnet/tactnet.hpp", use, f"""using namespace tactnet;

{layers}>;

static_assert(net::parameters == {network.parameters});
static_assert(net::multiply_adds == {network.multiply_adds});""", ratio, note)


def header_of(imported, include, use, body, more="", note=""):
    return f"""#pragma once

#include <{include}>
{more}
// Written by python3 -m tactnet.onnx from {imported.source}. Load it with
//     {use}{note}

namespace {imported.name} {{

{body}

}} // namespace {imported.name}
"""


def save(folder, name, safetensors, header, text):
    """Writes NAME.safetensors, NAME.hpp and NAME.txt, and returns the report."""
    os.makedirs(folder, exist_ok=True)
    for ending, data in (("safetensors", safetensors), ("hpp", header.encode()), ("txt", text.encode())):
        write_safely(os.path.join(folder, f"{name}.{ending}"), data)
    return text


def weights(network):
    arrays = dict(network.arrays)
    if network.mean.any():
        arrays["input_mean"] = network.mean
    arrays["selftest.input"], arrays["selftest.logits"] = network.selftest_input, network.selftest_logits
    metadata = {"format": "tactnet", "version": "1", "network": network.name, "rows": str(network.shape[0]), "columns": str(network.shape[1]),
                "classes": json.dumps(network.classes), "input": "mean" if network.mean.any() else "scale",
                "input_scale": repr(float(network.scale)), "epsilon": repr(float(network.epsilon)), "source": network.source}
    return safetensors(arrays, metadata)


def report(network):
    rows, columns, channels = network.shape
    counts = ", ".join(f"{count} {op}" for op, count in sorted(network.operators.items()))
    lines = [f"{network.source}: operator set {network.opset}",
             f"operators       {counts}",
             f"input           {rows} x {columns} x {channels}, (count - mean) x {network.scale:.9g}" + (
                 f", mean from {network.mean.min():.6g} to {network.mean.max():.6g}" if network.mean.any() else ", no mean"),
             f"layers          {wrapped([str(layer) for layer in network.layers], '').strip()}",
             f"classes         {len(network.classes)}",
             f"parameters      {network.parameters}",
             f"multiply-adds   {network.multiply_adds}",
             f"constants       {network.constant_nodes} nodes computed once",
             *(f"folded          {note}" for note in network.notes),
             f"checked         {len(network.selftest_input)} frames: the layers differ from the nodes by {network.difference:.1e} of the largest "
             "output"]
    return "\n".join(lines) + "\n"
