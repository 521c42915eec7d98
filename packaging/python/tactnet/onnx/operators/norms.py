"""Norms: batch norms, which stay layers of their own, and those with moments of each frame."""

from fractions import Fraction

import numpy

from .. import arithmetic
from ..layers import Layer
from . import evaluates, imports, joins
from .elementwise import affine
from .shapes import axes_of


def along(values, rank, axis=1):
    """One number per channel, to broadcast."""
    return numpy.reshape(values, (1,) * axis + (-1,) + (1,) * (rank - axis - 1))


@evaluates("BatchNormalization")
def evaluate_batch_norm(node, x, scale, shift, mean, variance):
    scale, shift, mean, variance = (along(v, x.ndim) for v in (scale, shift, mean, variance))
    return (x - mean) / numpy.sqrt(variance + node.get("epsilon", 1e-5)) * scale + shift


@evaluates("InstanceNormalization")
def evaluate_instance_norm(node, x, scale, shift):
    return arithmetic.normalise(x, tuple(range(2, x.ndim)), node.get("epsilon", 1e-5)) * along(scale, x.ndim) + along(shift, x.ndim)


@evaluates("LayerNormalization")
def evaluate_layer_norm(node, x, scale, shift=None):
    axis = node.get("axis", -1) % x.ndim
    found = arithmetic.normalise(x, tuple(range(axis, x.ndim)), node.get("epsilon", 1e-5)) * scale
    return found if shift is None else found + shift


@evaluates("GroupNormalization")
def evaluate_group_norm(node, x, scale, shift):
    groups = node.get("num_groups")
    found = arithmetic.normalise(x.reshape(groups, -1), 1, node.get("epsilon", 1e-5)).reshape(x.shape)
    repeat = 1 if len(scale) == x.shape[1] else x.shape[1] // groups
    return found * along(numpy.repeat(scale, repeat), x.ndim) + along(numpy.repeat(shift, repeat), x.ndim)


@evaluates("LRN")
def evaluate_lrn(node, x):
    size = node.get("size")
    if not 0 < size < 1 << 16:
        raise ValueError(f"size {size}")
    return arithmetic.local_responses(x[0], size, node.get("alpha", 1e-4), node.get("beta", 0.75), node.get("bias", 1.0), (size - 1) // 2)[None]


def per_channel(node, here, values, what):
    """A number for each channel of the map, from values that broadcast to the tensor."""
    found = here.in_order(values)
    node.require(found is not None and here.places.size == here.size, f"its {what} does not fit its input", "one for each channel")
    found = found.reshape(here.shape[2], -1)
    node.require((found == found[:, :1]).all(), f"its {what} differs within a channel of the map", "one for each channel")
    return found[:, 0]


def batch_norm(here, arrays, epsilon):
    def run(x, a):
        mean, variance, weight, bias = (a[name][:, None, None] for name in ("running_mean", "running_var", "weight", "bias"))
        return (x - mean) / numpy.sqrt(variance + epsilon) * weight + bias
    return Layer("bn", "batch_norm", here.shape, run, arrays, epsilon=epsilon)


@imports("BatchNormalization")
def import_batch_norm(walk, node, here, _):
    values = [along(walk.constant(node, i), here.places.ndim) for i in range(1, 5)]
    epsilon = node.get("epsilon", 1e-5)
    node.require(epsilon > 0 and values[3].min() >= 0 and all(numpy.isfinite(v).all() for v in values),
                 "its variance or epsilon is no such number", "variances of 0 or more")
    node.require(not node.get("training_mode", 0), "it trains", "training_mode of 0")
    if not here.places.size == here.size or any(v.size != here.shape[2] for v in values):
        # After a flatten: a number for each element, for the dense layer that follows.
        scale = values[0] / numpy.sqrt(values[3] + epsilon)
        parts = [here.in_order(v) for v in (scale, values[1] - values[2] * scale)]
        node.require(parts[0] is not None and parts[1] is not None and here.places.size == here.size, "its arrays do not fit", "one for each channel")
        return [affine(here, *parts)], here
    scale, shift, mean, variance = (per_channel(node, here, v, "scale, shift, mean or variance") for v in values)
    return [batch_norm(here, {"weight": scale, "bias": shift, "running_mean": mean, "running_var": variance}, epsilon)], here


def sample_norm(node, here, kind, text, axes_shape, axes, weight, bias, epsilon):
    """`axes_shape` is the map as the norm sees it, `axes` what it normalises; weights are for channels or elements."""
    node.require(epsilon > 0, "its epsilon is not above 0", "epsilon of 1e-5")
    node.require(numpy.prod([axes_shape[a] for a in axes]) > 1, "a single value has no variance", "a norm of two values or more")
    node.require(numpy.isfinite(weight).all() and numpy.isfinite(bias).all(), "a weight is not finite", "finite numbers")

    def run(x, a):
        found = arithmetic.normalise(x.reshape(axes_shape), axes, epsilon).reshape(x.shape)
        expand = (lambda v: v.reshape(x.shape)) if weight.ndim == 3 else (lambda v: v[:, None, None])
        return found * expand(a["weight"]) + expand(a["bias"])
    return Layer(kind, text, here.shape, run, {"weight": weight, "bias": bias}, epsilon=epsilon)


def group_norm(node, here, groups, weight, bias, epsilon):
    rows, columns, channels = here.shape
    kind, text = ("in", "instance_norm") if groups == channels and here.area > 1 else ("gn", f"group_norm<{groups}>")
    return sample_norm(node, here, kind, text, (groups, channels // groups, rows, columns), (1, 2, 3), weight, bias, epsilon)


@imports("InstanceNormalization", "GroupNormalization")
def import_groups(walk, node, here, _):
    """PyTorch writes group norms as instance norms of a reshaped map: what counts is which places lie in a group."""
    places = here.places.reshape((node.get("num_groups"), -1) if node.op == "GroupNormalization" else (here.places.shape[1], -1))
    groups, channels = len(places), here.shape[2]
    node.require(channels % groups == 0 and here.places.size == here.size and numpy.array_equal(
        numpy.sort(places, 1), numpy.arange(here.size).reshape(groups, -1)), "its groups are no successive channels",
        "groups of successive channels, group_norm")
    values = [walk.constant(node, i) for i in (1, 2)]
    node.require(all(v.size in (groups, channels) for v in values), "its weights do not fit", "a weight for each channel")
    weight, bias = (numpy.repeat(v, channels // v.size) for v in values)
    return [group_norm(node, here, groups, weight, bias, node.get("epsilon", 1e-5))], here


def layer_norm(node, here, axes, scale, shift, epsilon):
    """The norm of a tensor over its last axes, with weights that broadcast to it."""
    rows, columns, channels = here.shape
    together = here.places.reshape(-1, int(numpy.prod([here.places.shape[a] for a in axes]))) if tuple(axes) == tuple(
        range(here.places.ndim - len(axes), here.places.ndim)) else numpy.moveaxis(here.places, axes, range(-len(axes), 0)).reshape(
        -1, int(numpy.prod([here.places.shape[a] for a in axes])))
    near = "a norm over the whole frame, or over the channels of each pixel: layer_norm"
    node.require(here.places.size == here.size, "its input is a part of a map", near)
    if len(together) == 1 and here.area > 1:
        weight, bias = (here.in_order(v) for v in (scale, shift))
        node.require(weight is not None and bias is not None, "its weights do not fit", near)
        weight, bias = (v.reshape(channels, rows, columns) for v in (weight, bias))
        return sample_norm(node, here, "ln", "layer_norm<norm_over::frame>", (channels, rows, columns), (0, 1, 2), weight, bias, epsilon)
    pixels = numpy.sort(together, 1)
    node.require(together.shape == (here.area, channels) and (pixels[:, :1] + numpy.arange(channels) * here.area == pixels).all(),
                 "it normalises other elements", near)
    weight, bias = (per_channel(node, here, v, "weight") for v in (scale, shift))
    return sample_norm(node, here, "ln", "layer_norm<norm_over::channels>", (channels, rows, columns), (0,), weight, bias, epsilon)


@imports("LayerNormalization")
def import_layer_norm(walk, node, here, _):
    axis = node.get("axis", -1) % here.places.ndim
    return [layer_norm(node, here, tuple(range(axis, here.places.ndim)), walk.constant(node, 1), walk.constant(node, 2, numpy.zeros(1)),
                       node.get("epsilon", 1e-5))], here


@joins("Div")
def join_layer_norm(walk, node, inputs, start, at):
    """(x − mean) ÷ √(mean of squares + ε), as exporters write a layer norm before operator set 17."""
    graph, near = walk.graph, "LayerNormalization, or its form by ReduceMean, Sub, Pow, ReduceMean, Add, Sqrt and Div"
    made = graph.producers.get
    difference, root = made(node.inputs[0]), made(node.inputs[1])
    node.require(difference is not None and difference.op == "Sub" and root is not None and root.op == "Sqrt", "it divides branches", near)
    total, mean = made(root.inputs[0]), made(difference.inputs[1])
    node.require(total is not None and total.op == "Add" and mean is not None and mean.op == "ReduceMean", "it divides branches", near)
    epsilons = [float(graph.constants[n].ravel()[0]) for n in total.inputs if n in graph.constants and graph.constants[n].size == 1]
    variance = next((made(n) for n in total.inputs if n not in graph.constants), None)
    node.require(len(epsilons) == 1 and variance is not None and variance.op == "ReduceMean", "it divides branches", near)
    square = made(variance.inputs[0])
    again = None if square is None else made(square.inputs[0])
    exponent = graph.constants.get(square.inputs[1]) if square is not None and square.op == "Pow" else None
    squares = square is not None and (exponent is not None and exponent.size == 1 and float(exponent.ravel()[0]) == 2
                                      or square.op == "Mul" and square.inputs[0] == square.inputs[1])
    x = difference.inputs[0]
    node.require(squares and again is not None and again.op == "Sub" and mean.inputs[0] == x and again.inputs[0] == x
                 and (again is difference or made(again.inputs[1]) is not None and made(again.inputs[1]).op == "ReduceMean"
                      and made(again.inputs[1]).inputs[0] == x), "it divides branches", near)
    layers, here = walk.path(x, start, at)
    axes = {axes_of(n, walk.constant(n, 1), here.places.ndim) for n in (mean, variance)}
    node.require(len(axes) == 1 and None not in axes and all(n.get("keepdims", 1) for n in (mean, variance)), "its axes differ", near)
    return layers + [layer_norm(node, here, sorted(axes.pop()), numpy.ones(1), numpy.zeros(1), epsilons[0])], here


@imports("LRN")
def import_lrn(walk, node, here, _):
    size, values = node.get("size"), [node.get("alpha", 1e-4), node.get("beta", 0.75), node.get("bias", 1.0)]
    node.require(here.is_image() and size % 2 == 1, "a window of an even number of channels", "an odd size, local_response_norm")
    node.require(values[0] >= 0 and values[1] >= 0 and values[2] > 0, "its constants are below 0", "alpha, beta and bias above 0")
    ratios = [Fraction(f"{v:.6g}") for v in values]
    node.require(max(max(r.numerator, r.denominator) for r in ratios) < 1 << 31, "its constants are no usual fractions", "alpha of 1e-4, beta of 0.75")
    text = "local_response_norm<" + ", ".join([str(size)] + [f"std::ratio<{r.numerator}, {r.denominator}>" for r in ratios]) + ">"
    alpha, beta, k = map(float, ratios)
    return [Layer("lrn", text, here.shape, lambda x, _: arithmetic.local_responses(x, size, alpha, beta, k, size // 2))], here
