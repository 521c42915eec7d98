"""Quantised models (QDQ). Weights are what their bytes and scales say. Maps are not rounded: deploy<eight_bit> rounds them again, and a zero
point at the end of the bytes is the ReLU that exporters leave out before it."""

import numpy

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
