"""Operators on single numbers, and affine ones with constants, which become parts of neighbouring layers."""

import numpy

from .. import arithmetic
from ..activations import slopes
from ..layers import Layer
from ..graph import NEAREST
from . import EVALUATIONS, REFUSED, evaluates, imports

EVALUATIONS.update({
    "Relu": lambda n, x: numpy.maximum(x, 0),
    "LeakyRelu": lambda n, x: numpy.where(x > 0, x, n.get("alpha", 0.01) * x),
    "Elu": lambda n, x: numpy.where(x > 0, x, n.get("alpha", 1.0) * numpy.expm1(numpy.minimum(x, 0))),
    "Selu": lambda n, x: n.get("gamma", 1.0507009873554805) * numpy.where(
        x > 0, x, n.get("alpha", 1.6732632423543772) * numpy.expm1(numpy.minimum(x, 0))),
    "Celu": lambda n, x: numpy.where(x > 0, x, n.get("alpha", 1.0) * numpy.expm1(numpy.minimum(x, 0) / n.get("alpha", 1.0))),
    "ThresholdedRelu": lambda n, x: numpy.where(x > n.get("alpha", 1.0), x, 0),
    "Sigmoid": lambda n, x: arithmetic.sigmoid(x), "Tanh": lambda n, x: numpy.tanh(x),
    "Softplus": lambda n, x: arithmetic.softplus(x), "Softsign": lambda n, x: x / (1 + abs(x)),
    "HardSigmoid": lambda n, x: numpy.clip(n.get("alpha", 0.2) * x + n.get("beta", 0.5), 0, 1),
    "HardSwish": lambda n, x: x * numpy.clip(x / 6 + 0.5, 0, 1),
    "Mish": lambda n, x: x * numpy.tanh(arithmetic.softplus(x)),
    "Gelu": lambda n, x: 0.5 * x * (1 + (arithmetic.error_function(x / numpy.sqrt(2)) if n.get("approximate", "none") == "none"
                                         else numpy.tanh(numpy.sqrt(2 / numpy.pi) * (x + 0.044715 * x ** 3)))),
    "Erf": lambda n, x: arithmetic.error_function(x), "Exp": lambda n, x: numpy.exp(x), "Log": lambda n, x: numpy.log(x),
    "Sqrt": lambda n, x: numpy.sqrt(x), "Abs": lambda n, x: abs(x), "Neg": lambda n, x: -x, "Reciprocal": lambda n, x: 1 / x,
    "Floor": lambda n, x: numpy.floor(x), "Ceil": lambda n, x: numpy.ceil(x), "Not": lambda n, x: ~x,
    "Pow": lambda n, x, y: x ** y, "Equal": lambda n, x, y: x == y, "Less": lambda n, x, y: x < y,
    "Greater": lambda n, x, y: x > y, "Where": lambda n, c, x, y: numpy.where(c, x, y), "Mod": lambda n, x, y: x % y,
    "PRelu": lambda n, x, s: numpy.where(x > 0, x, s * x),
    "Min": lambda n, *x: numpy.minimum.reduce(numpy.broadcast_arrays(*x)),
    "Max": lambda n, *x: numpy.maximum.reduce(numpy.broadcast_arrays(*x)),
    "Sum": lambda n, *x: sum(x[1:], x[0]),
})


@evaluates("Add", "Sub", "Mul", "Div")
def evaluate_arithmetic(node, x, y):
    if node.opset < 7 and node.get("broadcast") and "axis" in node.attributes:  # the axis that y begins at
        y = y.reshape(y.shape + (1,) * (x.ndim - node.get("axis") % x.ndim - y.ndim))
    whole = node.op == "Div" and x.dtype.kind in "iu" and y.dtype.kind in "iu"
    return x // y if whole else {"Add": numpy.add, "Sub": numpy.subtract, "Mul": numpy.multiply, "Div": numpy.divide}[node.op](x, y)


@evaluates("Clip")
def evaluate_clip(node, x, low=None, high=None):
    low = node.get("min", -numpy.inf) if low is None else low
    return numpy.minimum(numpy.maximum(x, low), node.get("max", numpy.inf) if high is None else high)


def affine(here, scale, shift):
    """x · scale + shift, with a number for each element; fold.py makes it a part of a neighbour."""
    rows, columns, channels = here.shape
    at = (channels, rows, columns)
    return Layer("affine", "affine", here.shape, lambda x, a: x * a["scale"].reshape(at) + a["shift"].reshape(at),
                 {"scale": numpy.array(scale, numpy.float64), "shift": numpy.array(shift, numpy.float64)})


@imports("Add", "Sub", "Mul", "Div", "Sum", "Neg")
def import_affine(walk, node, here, _):
    data = walk.graph.data_inputs(node)
    sums = node.op not in ("Mul", "Div")
    node.require(sums or len(data) == 1 and data[0] == node.inputs[0] or node.op == "Mul" and len(data) == 1,
                 "it multiplies or divides by what depends on the frame", "Mul by a factor for each channel, gate")

    def at(number):
        values = {**walk.graph.constants, data[0]: numpy.full(here.places.shape, number)}
        walk.graph.compute(node, values)
        return values[node.outputs[0]].astype(numpy.float64)
    shift = at(0.0)
    scale = numpy.round(at(1.0) - shift) if sums else at(1.0)
    scale, shift = here.in_order(scale), here.in_order(shift)
    node.require(scale is not None and shift is not None and here.places.size == here.size,
                 "its constant is larger than its input, or its input a part of a map", "a constant for each channel")
    node.require(numpy.isfinite(scale).all() and numpy.isfinite(shift).all(), "its constant is not finite", "finite numbers")
    return [affine(here, scale, shift)], here


@imports("PRelu")
def import_prelu(walk, node, here, _):
    values = here.in_order(walk.constant(node, 1))
    node.require(values is not None and here.places.size == here.size, "its slopes do not fit", "a slope for each channel")
    values = values.reshape(here.shape[2], -1)
    node.require((values == values[:, :1]).all(), "its slopes differ within a channel", "a slope for each channel")
    return [slopes(here, values[:, 0])], here


NEAR = {"HardSigmoid": "alpha = 1/6 and beta = 1/2, hard_sigmoid", "Clip": "Clip from 0 to 6, relu6, or Relu",
        "Elu": "an alpha of whole thousandths", "Gelu": "GELU without approximation, gelu"}
for operator in ("Relu", "LeakyRelu", "Elu", "Clip", "Sigmoid", "Tanh", "HardSigmoid", "Softplus", "Gelu", "Selu", "Celu", "Mish", "Erf", "Exp", "Log",
                 "Sqrt", "Abs", "Pow", "Min", "Max", "Softsign", "Reciprocal", "ThresholdedRelu", "HardSwish"):
    REFUSED[operator] = ("it computes, alone or with the nodes before it, no activation function of the library",
                         NEAR.get(operator, NEAREST.get(operator, "Relu, Clip(0, 6), Sigmoid, HardSwish or another that onnx.md lists")))
