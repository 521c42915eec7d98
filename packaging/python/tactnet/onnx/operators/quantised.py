"""Quantised models (QDQ). Weights are what their bytes and scales say, and a zero point at the end of the bytes is the ReLU that exporters
leave out before it. Maps of the layers are not rounded; `eight_bit_steps` has the scales with which a network in 8 bits rounds them."""

import numpy

from ..graph import CannotImport
from . import evaluates, imports


def per_axis(node, values, x):
    """Scales or zero points of the whole tensor, or along an axis."""
    values = numpy.asarray(values, numpy.float64)
    if values.size == 1:
        return values.reshape(())
    axis = node.get("axis", 1) % x.ndim
    return values.reshape([-1 if i == axis else 1 for i in range(x.ndim)])


@evaluates("QuantizeLinear")
def evaluate_quantize(node, x, scale, zero=None):
    zero = numpy.zeros(1, numpy.uint8) if zero is None else zero
    ends = numpy.iinfo(zero.dtype)
    if node.on_data:
        return numpy.maximum(x, 0) if not node.on_frame and zero.size == 1 and zero.ravel()[0] == ends.min else x
    return numpy.clip(numpy.rint(x / per_axis(node, scale, x)) + per_axis(node, zero, x), ends.min, ends.max).astype(zero.dtype)


@evaluates("DequantizeLinear")
def evaluate_dequantize(node, x, scale, zero=None):
    if node.on_data:
        return x
    return (x.astype(numpy.float64) - per_axis(node, 0 if zero is None else zero, x)) * per_axis(node, scale, x)


@imports("QuantizeLinear", "DequantizeLinear")
def import_rounding(walk, node, here, _):
    node.require(walk.constant(node, 1).size == 1, "a map with a scale for each channel", "one scale for a map")
    return [], here


def rounding(walk, node):
    """Scale and zero point of a map, as of unsigned bytes."""
    scale, zero = walk.constant(node, 1), numpy.asarray(walk.constant(node, 2, numpy.zeros(1, numpy.uint8)))
    return (float(scale.ravel()[0]), int(zero.ravel()[0]) + (128 if zero.dtype == numpy.int8 else 0)) if scale.size == 1 else None


def with_scales(walk, node, layer):
    """The layer, with the scales of its weights if they are signed bytes around 0."""
    made = walk.graph.producers.get(node.inputs[1]) if len(node.inputs) > 1 else None
    if made is not None and made.op == "DequantizeLinear":
        zero = numpy.asarray(walk.constant(made, 2, numpy.zeros(1, numpy.int8)))
        scales = numpy.ravel(walk.constant(made, 1))
        if zero.dtype == numpy.int8 and not zero.any() and scales.size in (1, layer.output[2]):
            layer.weight_scales = numpy.broadcast_to(scales, layer.output[2])
    return layer


def eight_bit_steps(network):
    """The numbers of each step in 8 bits, of convolutions and dense layers with ReLU and max pools between them."""
    if network.rounding is None or abs(network.rounding[0] - network.scale) > 1e-6 * network.scale or network.rounding[1] or network.mean.any():
        raise CannotImport(f"its input has the scale and zero point {network.rounding}; the nearest that becomes a network in 8 bits: {network.scale:.9g} and "
                           "0, so that each count is a byte")
    steps = []
    for layer in network.layers:
        if layer.weight_scales is not None:
            scale = network.scale if not steps else 1.0  # counts are what the first layer reads, in steps of 1/128
            unit = layer.weight_scales * (steps[-1]["output"][0] if steps else scale)
            bias = numpy.rint(layer.arrays.get("bias", numpy.zeros(layer.output[2])) / unit) * unit
            steps.append({"weight": layer.arrays["weight"] * scale, "bias": bias, "scale": layer.weight_scales * scale,
                          "input": steps[-1]["output"] if steps else (1 / 128, 0)})
        elif str(layer) != "relu" and not str(layer).startswith("max_pool<") or not steps:
            raise CannotImport(f"the layer {layer} has no weights of signed bytes; the nearest that becomes a network in 8 bits: such convolutions and "
                               "dense layers, with ReLU and max pools after them")
        steps[-1]["output"] = layer.rounding or steps[-1].get("output")
    if any(step["output"] is None for step in steps[:-1]):
        raise CannotImport("a map between two layers has no scale; the nearest that becomes a network in 8 bits: QuantizeLinear after each layer")
    return steps
