"""Branches of one tensor that join: sums, concatenations, gates."""

import numpy

from ..layers import Layer, Map, as_branch, run_all, texts
from . import evaluates, joins


@evaluates("Concat")
def evaluate_concat(node, *x):
    return numpy.concatenate(x, node.get("axis", 1))


@joins("Add", "Sum")
def join_sum(walk, node, inputs, start, at):
    node.require(len(inputs) == len(node.inputs), "it adds constants to branches", "an Add of its own for each")
    layers, here, found = walk.branches(inputs, start, at)
    for _, end in found:
        node.require(end.shape == found[0][1].shape and numpy.array_equal(end.places, found[0][1].places),
                     "it adds maps of different shapes or orders", "branches of the same shape, residual")
    (main, end), *others = found
    for skip, _ in others:
        if not main and skip:
            main, skip = skip, main
        main = [residual(main, skip, end.shape)]
    return layers + main, end


def residual(main, skip, output):
    def write(layer):
        (_, first), (_, second) = layer.branches
        rest = f", {as_branch(second)}" if second else ""
        return f"residual<{as_branch(first)}{rest}>"
    layer = Layer("block", "", output, None, branches=[("", main), ("projection.", skip)], write=write)
    layer.run = lambda x, _: run_all(layer.branches[0][1], x) + run_all(layer.branches[1][1], x)
    return layer


@joins("Concat")
def join_concat(walk, node, inputs, start, at):
    node.require(len(inputs) == len(node.inputs), "it joins a branch with constants", "branches of one tensor")
    layers, here, found = walk.branches(inputs, start, at)
    if len(found) == 1:
        return layers + found[0][0], found[0][1]
    ends = [end for _, end in found]
    rows, columns = ends[0].shape[:2]
    node.require(all(end.shape[:2] == (rows, columns) for end in ends), "its branches have maps of different sizes",
                 "branches of the same rows and columns, concatenation")
    before = numpy.cumsum([0] + [end.size for end in ends])
    places = evaluate_concat(node, *(end.places + offset for end, offset in zip(ends, before)))
    branches = [(f"branch{i}.", branch) for i, (branch, _) in enumerate(found, 1)]
    layer = Layer("concat", "", (rows, columns, sum(end.shape[2] for end in ends)), None, branches=branches,
                  write=lambda l: f"concatenation<{', '.join(as_branch(branch) for _, branch in l.branches)}>")
    layer.run = lambda x, _: numpy.concatenate([run_all(branch, x) for _, branch in layer.branches])
    return layers + [layer], Map(layer.output, places)


@joins("Mul")
def join_gate(walk, node, inputs, start, at):
    near = "a map times a factor for each channel that layers compute from it, gate"
    node.require(len(inputs) == 2, "it multiplies a tensor by itself", near)
    layers, here, found = walk.branches(inputs, start, at)
    (own, a), (branch, b) = found if not found[0][0] else reversed(found)
    node.require(not own, "neither side is what the other is computed from", near)
    channels = a.shape[2]
    node.require(b.shape == (1, 1, channels) and a.size == a.places.size, "its factors are not one for each channel", near)
    try:
        factors = numpy.broadcast_to(b.places, a.places.shape)
    except ValueError:
        node.fail("its factors do not fit", near)
    node.require(numpy.array_equal(factors, a.places // a.area), "its factors belong to other channels", near)
    layer = Layer("gate", "", a.shape, None, branches=[("", branch)], write=lambda l: f"gate<{', '.join(texts(l.branches[0][1]))}>")
    layer.run = lambda x, _: x * run_all(layer.branches[0][1], x)
    return layers + [layer], a
