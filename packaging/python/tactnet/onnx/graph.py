"""An ONNX file as a graph of nodes whose constants and shapes are known. The batch is fixed to one."""

import math
import re

import numpy
import onnx
from onnx import numpy_helper

SWITCHES = {"ceil_mode", "count_include_pad", "transA", "transB", "keepdims", "linear_before_reset", "allowzero", "noop_with_empty_axes",
            "training_mode", "input_forget", "layout", "broadcast"}
LARGEST = 1 << 26  # elements of a tensor: a damaged file may state any size


class CannotImport(Exception):
    """One sentence: what cannot be imported, and what is nearest to it."""

    def __init__(self, sentence):
        super().__init__(" ".join("".join(c if c.isprintable() else " " for c in sentence).split()))


class Node:
    """A node with its attributes as Python's numbers, lists, texts and arrays."""

    def __init__(self, proto, opset, place):
        self.op, self.opset = proto.op_type, opset
        self.inputs, self.outputs = list(proto.input), list(proto.output)
        self.name = proto.name or (self.outputs[0] if self.outputs else f"number {place}")
        self.attributes = {}
        for attribute in proto.attribute:
            try:
                value = onnx.helper.get_attribute_value(attribute)
            except Exception:  # of no known type
                self.fail(f"its attribute '{attribute.name}' has no value")
            if isinstance(value, bytes):
                value = value.decode("utf-8", "replace")
            elif isinstance(value, onnx.TensorProto):
                value = array_of(value, self.name)
            if attribute.name in SWITCHES:
                self.require(value in (0, 1), f"its attribute '{attribute.name}' is {value}", "0 or 1")
            self.attributes[attribute.name] = value

    def get(self, name, default=None):
        return self.attributes.get(name, default)

    def fail(self, reason, nearest=None):
        """Raises the sentence about this node."""
        end = f"; the nearest that can be imported: {nearest}" if nearest else ""
        raise CannotImport(f"node '{self.name}' ({self.op}): {reason}{end}")

    def require(self, holds, reason, nearest=None):
        if not holds:
            self.fail(reason, nearest)


def array_of(tensor, name):
    if tensor.data_location == onnx.TensorProto.EXTERNAL:
        raise CannotImport(f"tensor '{tensor.name or name}' lies in another file; save the model with its weights inside")
    if math.prod(tensor.dims) > LARGEST or any(extent < 0 for extent in tensor.dims):
        raise CannotImport(f"tensor '{tensor.name or name}' has impossible extents: {list(tensor.dims)}")
    try:
        array = numpy_helper.to_array(tensor)
        if array.dtype.kind not in "fiub":
            raise TypeError(f"numbers of type {array.dtype}")
        return array
    except Exception as error:  # a damaged file may state any type
        raise CannotImport(f"tensor '{tensor.name or name}' is damaged: {type(error).__name__}: {error}"[:200]) from None


class Graph:
    """Nodes in order, constants by name, and the one input."""

    def __init__(self, model, evaluations, sizes=None, output=None):
        self.evaluations = evaluations
        opsets = {entry.domain: entry.version for entry in model.opset_import}
        self.opset = opsets.get("", opsets.get("ai.onnx", 1))
        graph = model.graph
        self.constants = {tensor.name: array_of(tensor, tensor.name) for tensor in graph.initializer}
        if len(self.constants) < len(graph.initializer):
            raise CannotImport("several tensors of constants have the same name")
        self.nodes = [Node(proto, self.opset, place) for place, proto in enumerate(graph.node)]
        inputs = [value for value in graph.input if value.name not in self.constants]
        if len(inputs) != 1:
            raise CannotImport(f"the model has {len(inputs)} inputs; a network has one, the frame")
        self.input, self.input_shape = inputs[0].name, self._extents(inputs[0], sizes)
        if not graph.output:
            raise CannotImport("the model has no output")
        names = [value.name for value in graph.output]
        if output is not None and output not in names:
            raise CannotImport(f"there is no output '{output}', but {', '.join(names)}")
        # Of a classifier of scikit-learn, the label is the first output and the scores are the second.
        labels = {n.outputs[0] for n in self.nodes if n.op in ("LinearClassifier", "SVMClassifier") and n.outputs}
        direct = {n.inputs[0]: n.outputs[0] for n in self.nodes if n.op in ("Identity", "Cast") and n.inputs and n.outputs}
        labels |= {direct.get(name) for name in labels}
        scores = [name for name in names if name not in labels]
        self.output = output or (scores or names)[0]
        self.producers = {}
        for node in self.nodes:
            for name in node.outputs:
                if name and (name in self.producers or name in self.constants or name == self.input):
                    node.fail(f"'{name}' is computed twice")
                self.producers[name] = node
        if self.output not in self.producers:
            raise CannotImport(f"no node computes the output '{self.output}'")
        self._leave_out_unused()
        self._fold()
        self.place = {self.input: -1, **{name: i for i, node in enumerate(self.nodes) for name in node.outputs}}
        self._find_dominators()

    def _extents(self, value, sizes):
        if not value.type.HasField("tensor_type"):
            raise CannotImport(f"input '{value.name}' is no tensor")
        stated = [d.dim_value for d in value.type.tensor_type.shape.dim]
        if sizes is not None:
            stated = list(sizes)
        unknown = [i for i, extent in enumerate(stated) if extent <= 0]
        if unknown and unknown != [0] and not (unknown == [1] and len(stated) == 3):
            raise CannotImport(f"the input has more unknown extents than the batch: {stated}; state them with --shape")
        stated = [max(extent, 1) for extent in stated]
        if not 2 <= len(stated) <= 4 or math.prod(stated) > LARGEST:
            raise CannotImport(f"the input has the extents {stated}; a frame has 2 to 4 with the batch")
        if stated[0] != 1 and not (len(stated) == 3 and stated[1] == 1):
            raise CannotImport(f"the input '{value.name}' holds {stated[0]} frames; the nearest that can be imported: a batch of 1")
        return tuple(stated)

    def _leave_out_unused(self):
        """Keeps what the output needs, in an order in which inputs come first."""
        order, state, stack = [], {}, [(self.producers[self.output], False)]
        while stack:
            node, done = stack.pop()
            if done:
                state[id(node)] = "done"
                order.append(node)
            elif id(node) not in state:
                state[id(node)] = "open"
                stack.append((node, True))
                for name in node.inputs:
                    needed = self.producers.get(name)
                    if needed is not None and state.get(id(needed)) == "open":
                        node.fail("the graph has a loop")
                    if needed is not None and id(needed) not in state:
                        stack.append((needed, False))
        self.nodes = order

    def compute(self, node, values):
        """Sets the outputs of a node in `values`."""
        evaluation = self.evaluations.get(node.op)
        if evaluation is None:
            node.fail("there is no such layer", NEAREST.get(node.op, "the operators that the page onnx.md lists"))
        arguments = []
        for name in node.inputs:
            if name and name not in values:
                node.fail(f"nothing computes its input '{name}'")
            arguments.append(values[name] if name else None)
        while arguments and arguments[-1] is None:
            arguments.pop()
        try:
            with numpy.errstate(all="ignore"):
                found = evaluation(node, *arguments)
        except CannotImport:
            raise
        except Exception as error:  # a damaged file may state anything
            said = re.sub(r"^\S+\(\) ", "", str(error))  # without the name of our function
            node.fail(f"its inputs and attributes do not fit: {said}".splitlines()[0][:200])
        found = found if isinstance(found, tuple) else (found,)
        del node.outputs[len(found):]
        for name, value in zip(node.outputs, found):
            value = numpy.asarray(value)
            if value.size > LARGEST:
                node.fail(f"its output has the extents {list(value.shape)}")
            values[name] = value

    def _fold(self):
        """Computes once what depends on no input; shapes are constants, since the batch is one."""
        values = {**self.constants, self.input: numpy.zeros(self.input_shape)}
        data, self.folded = {self.input}, []
        for node in self.nodes:
            node.on_data, node.on_frame = any(name in data for name in node.inputs), self.input in node.inputs
            self.compute(node, values)
            if node.op in ("Shape", "Size") or not node.on_data:
                self.folded.append(node)
                self.constants.update((name, values[name]) for name in node.outputs if name)
            else:
                data.update(node.outputs)
                node.require(all(values[name].size for name in node.outputs if name), "its output is empty")
        self.nodes = [node for node in self.nodes if not any(name in self.constants for name in node.outputs)]
        self.shapes = {name: value.shape for name, value in values.items()}
        if self.output not in values:
            raise CannotImport(f"no node computes the output '{self.output}'")
        if self.output in self.constants:
            raise CannotImport("the output does not depend on the input")

    def data_inputs(self, node):
        """The inputs that depend on the frame."""
        return [name for name in node.inputs if name and name not in self.constants]

    def _find_dominators(self):
        """For each tensor, all tensors that every path from the input to it passes."""
        self.dominators = {self.input: frozenset([self.input])}
        for node in self.nodes:
            common = frozenset.intersection(*(self.dominators[name] for name in self.data_inputs(node)))
            for name in node.outputs:
                self.dominators[name] = common | {name}

    def common_start(self, names):
        """The last tensor that every path to each of these passes."""
        common = frozenset.intersection(*(self.dominators[name] for name in names))
        return max(common, key=self.place.__getitem__)

    def evaluate(self, frame):
        """All tensors that depend on the frame, and constants, in double precision."""
        values = {**self.constants, self.input: numpy.asarray(frame, numpy.float64).reshape(self.input_shape)}
        for node in self.nodes:
            self.compute(node, values)
        return values


NEAREST = {
    "Selu": "Elu, elu<thousandths>", "Mish": "silu", "Celu": "Elu, elu<thousandths>", "RNN": "GRU, gru<hidden>",
    "LogSoftmax": "Softmax, softmax", "ThresholdedRelu": "Relu, relu", "LpPool": "AveragePool, average_pool",
    "ConvInteger": "Conv between DequantizeLinear and QuantizeLinear", "TreeEnsembleClassifier": "LinearClassifier, dense",
    "QLinearConv": "Conv between DequantizeLinear and QuantizeLinear", "ArgMax": "the scores before it",
    "MaxUnpool": "Resize, upsample", "GridSample": "Resize, upsample_to", "Attention": "GRU, gru<hidden>",
    "LpNormalization": "LayerNormalization, layer_norm", "DepthToSpace": "ConvTranspose, transposed_conv2d",
    "If": "a network without branches that depend on the frame", "Loop": "GRU, gru<hidden>", "Scan": "GRU, gru<hidden>",
}
