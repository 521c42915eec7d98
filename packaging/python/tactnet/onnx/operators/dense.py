"""Products with matrices, softmax, and the linear machines of scikit-learn."""

import numpy

from .. import arithmetic
from ..layers import Layer, Map
from . import EVALUATIONS, REFUSED, evaluates, imports
from .convolution import convolution
from .elementwise import affine
from .quantised import with_scales
from .shapes import rows_of


@evaluates("Gemm")
def evaluate_gemm(node, a, b, c=None):
    a, b = a.T if node.get("transA", 0) else a, b.T if node.get("transB", 0) else b
    found = node.get("alpha", 1.0) * (a @ b)
    return found if c is None else found + node.get("beta", 1.0) * c


EVALUATIONS["MatMul"] = lambda node, a, b: a @ b


@evaluates("Softmax", "LogSoftmax")
def evaluate_softmax(node, x):
    axis = node.get("axis", -1 if node.opset >= 13 else 1)
    found = arithmetic.softmax(rows_of(x, axis), 1).reshape(x.shape) if node.opset < 13 else arithmetic.softmax(x, axis)
    return numpy.log(found) if node.op == "LogSoftmax" else found


def dense(here, weight, bias):
    """Weights [outputs, inputs in the order of the map]."""
    def run(x, a):
        return (a["weight"] @ x.ravel() + a["bias"])[:, None, None]
    return Layer("fc", f"dense<{len(weight)}>", (1, 1, len(weight)), run, {"weight": weight, "bias": bias}, weight.size,
                 numbered=False, filter_axis=0)


def product(walk, node, here, weight, bias):
    """A layer for x @ weight + bias, where the last axis of x has `inputs` elements."""
    node.require(weight.ndim == 2 and here.places.shape[-1] == weight.shape[0], f"weights of {list(weight.shape)} do not fit",
                 "weights [inputs, outputs]")
    node.require(numpy.isfinite(weight).all() and numpy.isfinite(bias).all(), "a weight is not finite", "finite numbers")
    inputs, outputs = weight.shape
    places = here.places.reshape(-1, inputs)
    rows, columns, channels = here.shape
    if len(places) == 1 and inputs == here.size and len(numpy.unique(places)) == inputs:
        own = numpy.zeros((outputs, inputs))
        own[:, places[0]] = weight.T
        return [with_scales(walk, node, dense(here, own, bias))], Map.plain((1, 1, outputs), here.places.shape[:-1] + (outputs,))
    # The channels of each pixel, as in a linear layer after a transpose to channels last.
    pixels = places[:, 0]
    node.require(inputs == channels and len(pixels) == here.area and numpy.array_equal(
        places, pixels[:, None] + numpy.arange(channels) * here.area) and len(numpy.unique(pixels)) == here.area,
        "it multiplies neither the whole map nor the channels of each pixel", "Flatten before it, dense")
    layer = convolution(here, weight.T[:, :, None, None], bias, (1, 1), [0, 0, 0, 0])
    end = (pixels[:, None] + numpy.arange(outputs) * here.area).reshape(here.places.shape[:-1] + (outputs,))
    return [layer], Map((rows, columns, outputs), end)


@imports("Gemm", "MatMul")
def import_product(walk, node, here, _):
    node.require(node.inputs[0] not in walk.graph.constants and node.inputs[1] in walk.graph.constants,
                 "its left side is constant", "MatMul of the map by weights")
    weight = walk.constant(node, 1)
    if node.op == "MatMul":
        node.require(weight.ndim == 2, "its weights are no matrix", "weights [inputs, outputs]")
        return product(walk, node, here, weight, numpy.zeros(weight.shape[1]))
    node.require(not node.get("transA", 0), "it transposes its input", "transA of 0")
    weight = node.get("alpha", 1.0) * (weight.T if node.get("transB", 0) else weight)
    bias = node.get("beta", 1.0) * numpy.broadcast_to(walk.constant(node, 2, numpy.zeros(1)), (1, weight.shape[1])).ravel()
    return product(walk, node, here, weight, bias)


@imports("Softmax")
def import_softmax(walk, node, here, _):
    node.require(node.outputs[0] == walk.graph.output or set(after(walk.graph, node.outputs[0])) <= {"Identity", "Reshape", "Flatten", "Cast"},
                 "it is not the last layer", "Softmax at the end")
    axis = node.get("axis", -1 if node.opset >= 13 else 1) % here.places.ndim
    moved = numpy.moveaxis(here.places, axis, -1) if node.opset >= 13 else rows_of(here.places, axis)
    groups = moved.reshape(-1, moved.shape[-1])
    node.require(groups.shape == (1, here.shape[2]) and here.area == 1, "it covers something else than the channels of one pixel",
                 "Softmax over the classes")
    walk.logits = node.inputs[0], here
    return [softmax_layer(here)], here


def softmax_layer(here):
    return Layer("softmax", "softmax", here.shape, lambda x, _: arithmetic.softmax(x, 0), numbered=False)


REFUSED["LogSoftmax"] = ("there is no such layer", "Softmax, or the logits before it, which name the same class")


def after(graph, name):
    """The operators of all nodes that depend on a tensor."""
    reached, found = {name}, []
    for node in graph.nodes:
        if reached & set(node.inputs):
            reached.update(node.outputs)
            found.append(node.op)
    return found


# scikit-learn by skl2onnx (domain ai.onnx.ml).

def linear_parts(node):
    intercepts = numpy.ravel(node.get("intercepts", [0.0]))
    if node.op == "LinearRegressor" and node.get("targets", 1) != len(intercepts):
        raise ValueError("its targets are not as many as its intercepts")
    return numpy.reshape(node.get("coefficients"), (len(intercepts), -1)), intercepts


def transformed(node, scores):
    kind = node.get("post_transform", "NONE")
    if node.get("as_logits"):
        return scores / 2 if kind == "LOGISTIC" else scores
    if kind == "SOFTMAX":
        return arithmetic.softmax(scores, -1)
    return {"NONE": lambda x: x, "LOGISTIC": arithmetic.sigmoid}[kind](scores)


@evaluates("LinearClassifier", "LinearRegressor")
def evaluate_linear(node, x):
    coefficients, intercepts = linear_parts(node)
    scores = x @ coefficients.T + intercepts
    if node.op == "LinearRegressor":
        return scores
    if scores.shape[1] == 1:
        raise ValueError("one score for two classes")
    return scores.argmax(1), transformed(node, scores)


@imports("LinearClassifier", "LinearRegressor")
def import_linear(walk, node, here, output):
    coefficients, intercepts = linear_parts(node)
    node.require(output == 1 or node.op == "LinearRegressor", "its label is no output of a network", "its scores")
    walk.classes = node.get("classlabels_strings") or [str(c) for c in node.get("classlabels_ints", [])]
    walk.classes = [c.decode("utf-8", "replace") if isinstance(c, bytes) else c for c in walk.classes]
    kind = node.get("post_transform", "NONE")
    if kind == "LOGISTIC":  # the shares of two classes, σ(−z) and σ(z), are a softmax of −z ÷ 2 and z ÷ 2
        node.require(len(intercepts) == 2 and numpy.allclose(coefficients[0], -coefficients[1]) and numpy.isclose(
            intercepts[0], -intercepts[1]), "logistic scores of several classes", "the multinomial classifier, softmax")
        coefficients, intercepts = coefficients / 2, intercepts / 2
    node.require(kind in ("NONE", "SOFTMAX", "LOGISTIC"), f"post_transform {kind}", "NONE, SOFTMAX or LOGISTIC")
    layers, end = product(walk, node, here, coefficients.T, intercepts)
    if kind != "NONE":
        # The scores before the softmax are what a self-test compares; `classify` computes probabilities of them.
        node.attributes["as_logits"] = True
        walk.logits = node.outputs[1], end
        layers.append(softmax_layer(end))
    return layers, end


EVALUATIONS["Scaler"] = lambda node, x: (x - numpy.asarray(node.get("offset"))) * numpy.asarray(node.get("scale"))


@imports("Scaler")
def import_scaler(walk, node, here, _):
    scale, offset = (here.in_order(numpy.asarray(node.get(name))) for name in ("scale", "offset"))
    node.require(scale is not None and offset is not None, "its offset and scale do not fit", "one for each feature")
    return [affine(here, scale, -offset * scale)], here


@evaluates("Normalizer")
def evaluate_normalizer(node, x):
    return x / {"L1": lambda v: abs(v).sum(-1, keepdims=True), "L2": lambda v: numpy.sqrt((v ** 2).sum(-1, keepdims=True)),
                "MAX": lambda v: v.max(-1, keepdims=True)}[node.get("norm", "MAX")](x)


@imports("Normalizer")
def import_normalizer(walk, node, here, _):
    source = walk.graph.producers.get(node.inputs[0])
    node.require(source is not None and source.op == "LinearClassifier" and node.get("norm") == "L1" and source.get("as_logits"),
                 "it normalises something else than probabilities", "Softmax")
    return [], here
