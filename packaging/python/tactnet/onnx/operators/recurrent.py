"""Layers that run through frames: GRU and LSTM of one direction."""

import numpy

from .. import arithmetic
from ..layers import Layer, Map
from . import evaluates, imports
from .shapes import last_frame

# ONNX's gates in PyTorch's order.
ORDER = {"GRU": (1, 0, 2), "LSTM": (0, 2, 3, 1)}


def parts(node, w, r, b, at=0):
    """Weights and biases of one direction in PyTorch's order of gates."""
    gates, hidden = len(ORDER[node.op]), r.shape[-1]

    def ordered(values):
        return numpy.concatenate([values[g * hidden:(g + 1) * hidden] for g in ORDER[node.op]])
    biases = numpy.zeros(2 * gates * hidden) if b is None else b[at]
    if w[at].shape[0] != gates * hidden or r[at].shape[0] != gates * hidden or biases.size != 2 * gates * hidden:
        raise ValueError("its weights do not fit each other")
    return ordered(w[at]), ordered(r[at]), ordered(biases[:gates * hidden]), ordered(biases[gates * hidden:])


def run_cell(node, x, w, r, wb, rb):
    return arithmetic.gru(x, w, r, wb, rb, bool(node.get("linear_before_reset", 0))) if node.op == "GRU" else arithmetic.lstm(x, w, r, wb, rb)


def check(node):
    node.require(node.get("direction", "forward") == "forward", f"a layer of direction {node.get('direction')}",
                 "direction forward: gru<hidden>, lstm<hidden>")
    node.require(not node.get("activations") or [a.decode() if isinstance(a, bytes) else a for a in node.get("activations")] in
                 (["Sigmoid", "Tanh"], ["Sigmoid", "Tanh", "Tanh"]), "other activation functions", "Sigmoid and Tanh")
    node.require("clip" not in node.attributes and not node.get("input_forget", 0), "a clipped or coupled cell", "a cell without clip")
    node.require(not node.get("layout", 0), "layout 1", "layout 0, with a Transpose before it")


@evaluates("GRU", "LSTM")
def evaluate_recurrent(node, x, w, r, b=None, lengths=None, *states):
    check(node)
    node.require(x.ndim == 3 and x.shape[1] == 1, "a batch of several sequences", "a batch of 1")
    node.require(all(s is None or not numpy.any(s) for s in states), "a state before the first frame, or peepholes", "states of zero")
    node.require(lengths is None or int(numpy.ravel(lengths)[0]) == len(x), "lengths of sequences", "whole sequences")
    found = run_cell(node, x[:, 0], *parts(node, w, r, b))
    return (found[:, None, None], found[None, -1:], found[None, -1:])[:max(1, len(node.outputs))]


@imports("GRU", "LSTM")
def import_recurrent(walk, node, here, output):
    check(node)
    node.require(node.op == "LSTM" or node.get("linear_before_reset", 0), "linear_before_reset of 0", "linear_before_reset of 1, as PyTorch writes")
    node.require(output < 2, "the state of the cell as an output", "the hidden state")
    frames, columns, features = here.shape
    node.require(columns == 1 and here.places.shape == (frames, 1, features) and numpy.array_equal(
        here.places[:, 0], numpy.arange(here.size).reshape(features, frames).T), "its input is no sequence [frames, 1, features]",
        "an input of frames and features, with Transpose before it if the batch comes first")
    w, r, wb, rb = parts(node, walk.constant(node, 1), walk.constant(node, 2), walk.constant(node, 3))
    node.require(all(numpy.isfinite(a).all() for a in (w, r, wb, rb)), "a weight is not finite", "finite numbers")
    kind, hidden = node.op.lower(), r.shape[1]
    node.require(w.shape[1] == features, "its weights do not fit its input", "weights of as many columns as features")

    def run(x, a):
        return run_cell(node, x[:, :, 0].T, *(a[n] for n in ("weight_ih_l0", "weight_hh_l0", "bias_ih_l0", "bias_hh_l0"))).T[:, :, None]
    layer = Layer(kind, f"{kind}<{hidden}>", (frames, 1, hidden), run,
                  {"weight_ih_l0": w, "weight_hh_l0": r, "bias_ih_l0": wb, "bias_hh_l0": rb}, frames * (w.size + r.size), numbered=False)
    if output == 1:
        return [layer, last_frame(hidden)], Map.plain((1, 1, hidden), (1, 1, hidden))
    places = numpy.arange(frames * hidden).reshape(hidden, frames).T[:, None, None]
    return [layer], Map(layer.output, places)
