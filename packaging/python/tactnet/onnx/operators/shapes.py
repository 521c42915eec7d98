"""Operators that move elements. Places of a map go through NumPy's own functions, so that none needs a rule."""

import numpy

from ..layers import Layer, Map
from . import EVALUATIONS, REFUSED, evaluates, imports


def axes_of(node, given, rank):
    axes = given if given is not None else node.get("axes")
    return None if axes is None else tuple(int(a) % rank for a in numpy.ravel(axes))


def identity(node, x, *_):
    return (x, numpy.ones(x.shape, bool))[:max(1, len(node.outputs))]


def rows_of(x, axis):
    """A matrix whose rows begin at an axis."""
    return x.reshape(int(numpy.prod(x.shape[:axis if axis >= 0 else x.ndim + axis])), -1)


KINDS = {6: numpy.int32, 7: numpy.int64, 9: bool, 2: numpy.uint8, 3: numpy.int8}
EVALUATIONS.update({
    "Identity": identity, "Dropout": identity,
    "Cast": lambda n, x: x.astype(KINDS.get(n.get("to"), numpy.float64)),
    "Shape": lambda n, x: numpy.array(x.shape[n.get("start", 0):n.get("end")], numpy.int64),
    "Size": lambda n, x: numpy.array(x.size),
    "Flatten": lambda n, x: rows_of(x, n.get("axis", 1)),
    "Transpose": lambda n, x: x.transpose(n.get("perm")),
    "Squeeze": lambda n, x, axes=None: x.squeeze(axes_of(n, axes, x.ndim)),
    "Unsqueeze": lambda n, x, axes=None: numpy.expand_dims(x, tuple(int(a) for a in numpy.ravel(n.get("axes") if axes is None else axes))),
    "Gather": lambda n, x, indices: numpy.take(x, indices, n.get("axis", 0)),
})


def possible(shape):
    """Extents that memory has room for."""
    if numpy.prod(shape, dtype=float) > 1 << 26:
        raise ValueError(f"impossible extents {list(shape)}")
    return tuple(int(n) for n in shape)


@evaluates("Constant")
def evaluate_constant(node):
    for name in ("value", "value_float", "value_floats", "value_int", "value_ints"):
        if name in node.attributes:
            return numpy.asarray(node.get(name))
    node.fail("it has no value of numbers")


@evaluates("ConstantOfShape")
def evaluate_constant_of_shape(node, shape):
    return numpy.full(possible(shape), numpy.ravel(node.get("value", numpy.zeros(1)))[0])


@evaluates("Range")
def evaluate_range(node, first, end, step):
    if not 0 < abs(float((end - first) / step)) < 1 << 20:
        raise ValueError("impossible range")
    return numpy.arange(first, end, step)


@evaluates("Reshape")
def evaluate_reshape(node, x, shape=None):
    shape = [int(s) for s in (node.get("shape") if shape is None else shape)]
    if not node.get("allowzero", 0):
        shape = [x.shape[i] if s == 0 else s for i, s in enumerate(shape)]
    return x.reshape(shape)


@evaluates("Expand")
def evaluate_expand(node, x, shape):
    return x * numpy.ones(possible(shape), x.dtype)


@evaluates("Slice")
def evaluate_slice(node, x, starts=None, ends=None, axes=None, steps=None):
    starts = node.get("starts") if starts is None else starts
    ends = node.get("ends") if ends is None else ends
    axes = axes_of(node, axes, x.ndim) or range(len(starts))
    chosen = [slice(None)] * x.ndim
    for axis, first, end, step in zip(axes, starts, ends, [1] * len(starts) if steps is None else steps):
        first, end, step = int(first), int(end), int(step)
        chosen[axis] = slice(first, None if step < 0 and end < -x.shape[axis] else end, step)
    return x[tuple(chosen)]


@evaluates("Split")
def evaluate_split(node, x, sizes=None):
    sizes = node.get("split") if sizes is None else sizes
    axis, parts = node.get("axis", 0), len(node.outputs)
    return tuple(numpy.array_split(x, parts, axis) if sizes is None else numpy.split(x, numpy.cumsum(sizes)[:-1], axis))


@evaluates("Pad")
def evaluate_pad(node, x, pads=None, value=None, axes=None):
    pads = node.get("pads", node.get("paddings")) if pads is None else pads
    axes = axes_of(node, axes, x.ndim) or range(x.ndim)
    around = [(0, 0)] * x.ndim
    for i, axis in enumerate(axes):
        around[axis] = (int(pads[i]), int(pads[i + len(axes)]))
    if max(map(max, around)) > 1 << 12:
        raise ValueError("impossible padding")
    x = x[tuple(slice(max(0, -a), n - max(0, -b)) for (a, b), n in zip(around, x.shape))]
    around = [(max(0, a), max(0, b)) for a, b in around]
    mode = node.get("mode", "constant")
    if mode == "constant":
        return numpy.pad(x, around, constant_values=node.get("value", 0.0) if value is None else numpy.ravel(value)[0])
    return numpy.pad(x, around, mode={"reflect": "reflect", "edge": "edge"}[mode])


@imports("Identity", "Dropout", "Cast", "Reshape", "Flatten", "Transpose", "Squeeze", "Unsqueeze", "Gather", "Slice", "Split")
def import_places(walk, node, here, output):
    values = {**walk.graph.constants, walk.graph.data_inputs(node)[0]: here.places}
    if node.op == "Cast":
        node.require(node.get("to") in (1, 10, 11, 16), "it makes whole numbers of maps", "Cast to float")
        return [], here
    walk.graph.compute(node, values)
    after = Map(here.shape, values[node.outputs[output]])
    rows, columns, channels = here.shape
    last = numpy.arange(1, channels + 1) * rows - 1
    if after.places.size == channels and rows > 1 and columns == 1 and numpy.array_equal(after.places.ravel(), last):
        return [last_frame(channels)], Map.plain((1, 1, channels), after.places.shape)
    return [], after


def last_frame(features):
    return Layer("last", "last_frame", (1, 1, features), lambda x, _: x[:, -1:])


@imports("Pad")
def import_pad(walk, node, here, _):
    """A pad becomes part of the windows that follow it."""
    name, graph = node.outputs[0], walk.graph
    around = walk.constant(node, 1, node.get("pads", node.get("paddings")))
    value = float(numpy.ravel(walk.constant(node, 2, node.get("value", 0.0)))[0])
    around = numpy.asarray(around, int).reshape(2, -1)
    if not around.any():
        return [], here
    readers = {reader.op for reader in graph.nodes if name in reader.inputs}
    source = graph.producers.get(node.inputs[0])
    ignored = value < -1e38 or value == 0 and source is not None and source.op == "Relu"  # by a maximum
    fits = name != graph.output and bool(readers) and (readers <= {"Conv", "AveragePool"} and value == 0 or readers == {"MaxPool"} and ignored)
    node.require(fits and here.is_image() and node.get("mode", "constant") == "constant" and len(node.inputs) < 4
                 and not around[:, :2].any() and around.min() >= 0,
                 "it is no padding of a convolution or pool", "zeros before Conv or AveragePool, or their own pads")
    (top, *left), (bottom, *right) = around[:, 2:]
    walk.pads[name] = [int(n) for n in (top, *left, *[0] * (1 - len(left)), bottom, *right, *[0] * (1 - len(right)))]
    return [], here


for operator in ("Expand", "Shape", "Size", "ConstantOfShape", "Range", "Floor", "Ceil", "Mod", "Equal", "Less", "Greater", "Where", "Not"):
    REFUSED[operator] = ("it is no layer of maps", "the same with constants, which are computed once")
