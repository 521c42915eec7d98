"""From a graph to a list of layers: backwards from the output, branch by branch."""

import numpy

from . import operators
from .activations import ELEMENTWISE, recognise
from .graph import CannotImport
from .layers import Map

operators.install()


class Walk:
    """One attempt with one reading of the input's extents. `reached` counts nodes that became layers."""

    def __init__(self, graph):
        self.graph, self.reached = graph, 0
        self.logits = self.classes = None  # the tensor before a softmax, and its map; names of classes
        self.rounding = None  # of the input of a quantised model
        self.pads = {}  # of tensors that Pad makes, for the windows that read them

    def constant(self, node, index, default=None):
        """A constant input of a node, in double precision if it has numbers with a point."""
        name = node.inputs[index] if index < len(node.inputs) else ""
        if not name:
            return default
        if name not in self.graph.constants:
            node.fail(f"'{name}' depends on the frame", "the same node with a constant there")
        value = self.graph.constants[name]
        return value.astype(numpy.float64) if value.dtype.kind == "f" else value

    def path(self, name, start, at):
        """The layers between two tensors, and the map at the end; `at` is the map at the start."""
        if name == start:
            return [], at
        graph, node = self.graph, self.graph.producers[name]
        node.require(start in graph.dominators[name], "it joins branches that begin at different tensors",
                     "branches of one tensor that join in Add, Concat or Mul")
        self.reached += 1
        try:
            layers, here = self._path(name, node, start, at)
            if node.op == "DequantizeLinear":
                (layers[-1] if layers else self).rounding = operators.quantised.rounding(self, node)
            return layers, here
        except (CannotImport, RecursionError):
            raise
        except Exception as error:  # a damaged file may state anything
            node.fail(f"its inputs and attributes do not fit: {type(error).__name__}: {error}"[:200])

    def _path(self, name, node, start, at):
        graph = self.graph
        node.require(self.reached < 8 * len(graph.nodes) + 64, "branches share nodes", "branches of nodes of their own")
        found = self._activation(name, start)
        if found:
            layers, here = self.path(found[0], start, at)
            return layers + [found[1](here)], Map(here.shape, here.places)
        chosen = self._part_of_concat(name, node)
        if chosen:
            source, places = chosen
            layers, here = self.path(source, start, at)
            return layers, Map(here.shape, places(here.places))
        inputs = graph.data_inputs(node)
        if len(set(inputs)) > 1 or node.op in ("Concat",):
            join = operators.JOINS.get(node.op)
            node.require(join, "it joins branches", "Add, Concat, or Mul by a factor for each channel")
            return join(self, node, inputs, start, at)
        importer = operators.IMPORTS.get(node.op)
        refused = operators.REFUSED.get(node.op)
        node.require(importer or refused, "it cannot be a layer where it stands", "the activation functions that onnx.md lists")
        layers, here = self.path(inputs[0], start, at)
        if refused:
            node.fail(*refused)
        extra, here = importer(self, node, here, node.outputs.index(name))
        if here.places.shape != graph.shapes[name] and name not in self.pads:
            node.fail(f"its output has the extents {list(graph.shapes[name])}, and that of the layer {list(here.places.shape)}")
        return layers + extra, here

    def _part_of_concat(self, name, node):
        """Of a node that takes elements of a concatenation, all from one tensor: that tensor, and which of its places. So PyTorch takes
        the state of the last of several recurrent layers."""
        graph = self.graph
        concat = graph.producers.get(node.inputs[0]) if node.op in ("Gather", "Slice", "Split", "Squeeze") else None
        if concat is None or concat.op != "Concat":
            return None

        def taken(fill):
            values = {**graph.constants, **{tensor: fill(i, graph.shapes[tensor]) for i, tensor in enumerate(concat.inputs)}}
            graph.compute(concat, values)
            graph.compute(node, values)
            return values[name]
        parts = numpy.unique(taken(lambda i, shape: numpy.full(shape, i)))
        source = concat.inputs[int(parts[0])]
        if parts.size != 1 or source in graph.constants or concat.inputs.count(source) > 1:
            return None
        return source, lambda places: taken(lambda i, shape: places if concat.inputs[i] == source else numpy.full(shape, -1))

    def branches(self, names, start, at):
        """The layers up to where branches part, the map there, and the layers and maps of each branch."""
        part = self.graph.common_start(names)
        if self.graph.place[part] < self.graph.place[start]:
            self.graph.producers[names[0]].fail("its branch leaves another one", "branches inside each other")
        before, here = self.path(part, start, at)
        return before, here, [self.path(name, part, here) for name in names]

    def _activation(self, name, start):
        """The activation function that the nodes from the farthest tensor on compute."""
        graph, best = self.graph, None
        if graph.producers[name].op not in ELEMENTWISE:
            return None
        tensors = sorted(graph.dominators[name], key=graph.place.__getitem__, reverse=True)
        for tensor in tensors[1:]:
            if graph.place[tensor] < graph.place[start] or graph.shapes[tensor] != graph.shapes[name]:
                break
            try:
                function = self._function(name, tensor)
            except KeyError:
                break
            layer = recognise(function)
            if layer:
                best = tensor, layer
        return best

    def _function(self, name, tensor):
        """The nodes between two tensors as a function of numbers; KeyError if they are not one."""
        nodes, stack, seen = [], [name], set()
        while stack:
            current = stack.pop()
            if current == tensor or current in seen:
                continue
            seen.add(current)
            if current in self.graph.constants:
                if self.graph.constants[current].size != 1:
                    raise KeyError(current)
                continue
            node = self.graph.producers[current]
            if node.op not in ELEMENTWISE:
                raise KeyError(node.op)
            nodes.append(node)
            stack += [i for i in node.inputs if i]
        nodes = sorted({id(n): n for n in nodes}.values(), key=lambda n: self.graph.place[n.outputs[0]])
        constants = {c: self.graph.constants[c].reshape(()) for c in seen if c in self.graph.constants}

        def function(x):
            values = {**constants, tensor: x}
            for node in nodes:
                self.graph.compute(node, values)
            return numpy.broadcast_to(values[name], x.shape)
        return function


def readings(graph):
    """The maps that the input's extents can mean, the likeliest first."""
    e = graph.input_shape
    size = int(numpy.prod(e))
    if len(e) == 4:
        channels_first = Map.plain((e[2], e[3], e[1]), e)
        last = Map((e[1], e[2], e[3]), numpy.arange(size).reshape(e[3], e[1], e[2]).transpose(1, 2, 0)[None])
        return [last, channels_first] if e[3] in (1, 3) and e[1] not in (1, 3) else [channels_first, last]
    if len(e) == 3 and e[0] != 1:
        return [Map((e[0], 1, e[2]), numpy.arange(size).reshape(e[2], e[0]).T[:, None])]  # frames, batch, features
    if len(e) == 3:
        sequence = Map((e[1], 1, e[2]), numpy.arange(size).reshape(e[2], e[1]).T[None])
        return [Map.plain((e[1], e[2], 1), e), sequence, Map.plain((e[2], 1, e[1]), e)]
    found = [Map.plain((1, e[1], 1), e)]
    for node in graph.nodes:  # an image that a vector becomes
        shape = graph.shapes[node.outputs[0]]
        if node.op == "Reshape" and node.inputs[0] == graph.input and len(shape) == 4 and shape[0] == 1:
            found.insert(0, Map.plain((shape[2], shape[3], shape[1]), e))
    return found


def walk(graph):
    """(layers, map of the input, map of the output, the walk). The error is that of the reading that came farthest."""
    best, farthest = None, -1
    for here in readings(graph):
        attempt = Walk(graph)
        try:
            layers, end = attempt.path(graph.output, graph.input, here)
            if end.places.size != end.size or len(numpy.unique(end.places)) != end.size:
                graph.producers[graph.output].fail("the output is a part of a map", "the whole map")
            attempt.repeated = attempt.reached - len(graph.nodes)
            return layers, here, end, attempt
        except CannotImport as error:
            if attempt.reached > farthest:
                best, farthest = error, attempt.reached
    raise best
