"""Activation functions are recognised by what they compute, whatever nodes an exporter has written them with."""

from fractions import Fraction

import numpy

from .arithmetic import error_function, sigmoid, softplus
from .layers import Layer

# Operators that compute number by number.
ELEMENTWISE = {
    "Relu", "LeakyRelu", "PRelu", "Elu", "Selu", "Sigmoid", "HardSigmoid", "HardSwish", "Tanh", "Softplus", "Softsign", "Clip",
    "Erf", "Exp", "Log", "Sqrt", "Pow", "Abs", "Neg", "Reciprocal", "Add", "Sub", "Mul", "Div", "Min", "Max", "Gelu", "Celu",
    "QuantizeLinear", "DequantizeLinear", "Identity", "Cast", "Dropout", "Mish", "ThresholdedRelu", "Sum",
}


def hard_sigmoid(x):
    return numpy.clip((x + 3) / 6, 0, 1)


def gelu(x):
    return 0.5 * x * (1 + error_function(x / numpy.sqrt(2)))


# By the text of the layer: its name in weight files does not matter, since it has no arrays.
KNOWN = {
    "relu": lambda x: numpy.maximum(x, 0), "relu6": lambda x: numpy.clip(x, 0, 6), "sigmoid": sigmoid, "hyperbolic_tangent": numpy.tanh,
    "silu": lambda x: x * sigmoid(x), "gelu": gelu, "hard_sigmoid": hard_sigmoid, "hard_swish": lambda x: x * hard_sigmoid(x),
    "softplus": softplus,
}
GRID = numpy.concatenate([numpy.linspace(-30, 30, 3001), [-1000, -1e-3, 1e-3, 1000]])
KNOWN_VALUES: dict = {}


def same(found, expected):
    return bool(numpy.all(abs(found - expected) <= 3e-6 * (0.1 + abs(expected))))


def recognise(function):
    """A function from a map to the layer that computes `function`, or None."""
    from .graph import CannotImport
    try:
        with numpy.errstate(all="ignore"):
            found = numpy.asarray(function(GRID), numpy.float64)
    except CannotImport:
        return None
    finite = numpy.isfinite(found)
    if not finite[:3001].all():
        return square_root(function)
    if same(found, GRID):
        return None  # no function at all: its nodes are left out one by one
    for text, known in KNOWN.items():
        expected = KNOWN_VALUES.setdefault(text, known(GRID))
        if same(found, expected):
            return elementwise(text, known)
    one, below = found[GRID == 1e-3][0] * 1000, float(-found[0])
    if same(found, numpy.where(GRID > 0, GRID, -found[3001] / 1000 * GRID)) or abs(one - 1) < 1e-5 and same(
            found[GRID < 0], -found[3001] / 1000 * GRID[GRID < 0]):
        share = float(-found[3001] / 1000)
        if abs(round(1000 * share) - 1000 * share) < 1e-4 and 0 < round(1000 * share) < 1000:
            share = round(1000 * share) / 1000
            text = "leaky_relu<>" if share == 0.01 else f"leaky_relu<{round(1000 * share)}>"
            return elementwise(text, lambda x: numpy.where(x > 0, x, share * x))
        return lambda here: slopes(here, numpy.full(here.shape[2], share))
    if below > 0 and same(found, numpy.where(GRID > 0, GRID, below * numpy.expm1(numpy.minimum(GRID, 0)))):
        thousandths = round(1000 * below)
        if 0 < thousandths < 1000000 and abs(thousandths - 1000 * below) < 1e-3:
            text = "elu<>" if thousandths == 1000 else f"elu<{thousandths}>"
            alpha = thousandths / 1000
            return elementwise(text, lambda x: numpy.where(x > 0, x, alpha * numpy.expm1(numpy.minimum(x, 0))))
    return square_root(function)


def elementwise(text, function):
    return lambda here: Layer(text.split("<")[0], text, here.shape, lambda x, _: function(x))


def slopes(here, values):
    """parametric_relu with a slope for each channel."""
    return Layer("prelu", "parametric_relu", here.shape, lambda x, a: numpy.where(x > 0, x, a["weight"][:, None, None] * x),
                 {"weight": numpy.asarray(values, numpy.float64)})


def square_root(function):
    """√(x + offset) − √offset, 0 below 0."""
    x = numpy.linspace(0, 300, 301)
    with numpy.errstate(all="ignore"):
        found, below = function(x), function(-x)
    rise = found[1] - found[0]
    if not numpy.isfinite(found).all() or abs(found[0]) > 1e-6 or not 0 < rise < 1:
        return None
    offset = ((1 - rise ** 2) / (2 * rise)) ** 2  # √(1 + o) = rise + √o
    fraction = Fraction(offset).limit_denominator(100000)
    root = fraction ** 0.5
    if fraction <= 0 or not same(found, numpy.sqrt(x + float(fraction)) - root) or not same(below, 0 * x):
        return None
    ratio = f"square_root<std::ratio<{fraction.numerator}, {fraction.denominator}>>"
    return elementwise(ratio, lambda x: numpy.sqrt(numpy.maximum(x, 0) + float(fraction)) - root)
