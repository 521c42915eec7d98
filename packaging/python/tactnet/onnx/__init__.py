"""From ONNX to a network of tactnet: `python3 -m tactnet.onnx model.onnx` (docs/train/onnx.md).

    network = tactnet.onnx.read("model.onnx")   # raises CannotImport with one sentence
    network.save("folder")                      # model.hpp, model.safetensors, model.txt
"""

import collections
import os

import numpy
import onnx

from . import operators
from .fold import Folded
from .graph import CannotImport, Graph
from .layers import all_layers, named_arrays, run_all
from .machines import Machine
from .walk import walk
from . import write

__all__ = ["CannotImport", "Machine", "Network", "read"]


class Network:
    """An imported network: `layers`, `arrays` by name, `classes`, `scale` and `mean` of the input, and its self-test."""

    def __init__(self, model, source, name, classes=None, fold=False, scale=1.0, mean=0.0, shape=None, output=None, frames=4):
        self.source, self.name = source, write.identifier(name)
        if not scale > 0 or not numpy.isfinite(mean):
            raise CannotImport(f"the scale {scale} or the mean {mean} of the input is none")
        self.graph = graph = Graph(model, operators.EVALUATIONS, shape, output)
        self.opset = graph.opset
        self.operators = collections.Counter(node.op for node in graph.nodes)
        layers, self.input, self.output, walked = walk(graph)
        self.rounding = walked.rounding
        end = self.output
        folded = Folded(layers, self.input, fold, scale, mean)
        self.layers, self.notes, self.epsilon, self.scale = folded.layers, list(dict.fromkeys(folded.notes)), folded.epsilon, folded.scale
        if self.operators["QuantizeLinear"]:
            self.notes.append(f"nothing: {self.operators['QuantizeLinear']} maps are rounded in 8 bits alone")
        if walked.repeated > 0:
            self.notes.append(f"nothing: {walked.repeated} nodes are computed once more, since branches share them")
        if not self.layers:
            raise CannotImport("the model has no layer")
        self.constant_nodes = len(graph.folded)
        self.shape = self.input.shape
        rows, columns, channels = self.shape
        extents = (channels, rows, columns) if channels > 1 else (rows, columns)
        self.mean = folded.mean.astype(numpy.float32).reshape(extents)
        self._check_numbers()
        self.parameters = sum(a.size for n, a in self.arrays.items() if not n.endswith(("running_mean", "running_var")))
        self.multiply_adds = sum(layer.multiply_adds for layer in self.all_layers())
        self.frames = numpy.random.default_rng(1).integers(0, 256, (frames, *extents), numpy.uint8)
        self._test(scale, mean, end, walked.logits)
        stored = [entry.value.split("\n") for entry in model.metadata_props if entry.key == "classes"]
        given = classes or walked.classes or (stored[0] if stored and len(stored[0]) == end.size else None)
        self.classes = list(given or [f"class_{i:02}" for i in range(end.size)])
        if len(self.classes) != end.size or len(set(self.classes)) != end.size or not all(self.classes):
            raise CannotImport(f"expected {end.size} different names of classes, found {', '.join(self.classes[:9])}")

    def all_layers(self):
        return all_layers(self.layers)

    def _check_numbers(self):
        with numpy.errstate(all="ignore"):
            self.arrays = {name: array.astype(numpy.float32) for name, array in named_arrays(self.layers)}
        for name, array in [*self.arrays.items(), ("input_mean", self.mean)]:
            if not numpy.isfinite(array).all() or abs(array).max() > 1e30:
                raise CannotImport(f"'{name}' is not finite in single precision, or beyond 1e30")
        matrices = [array for array in self.arrays.values() if array.ndim > 1]
        if matrices and not any(array.any() for array in matrices):
            raise CannotImport("all weights are zero: the outputs would be the same for every frame")
        if not 0 < numpy.float32(self.scale) < numpy.inf or not 0 < self.epsilon < 1:
            raise CannotImport(f"the scale {self.scale} of the input or epsilon {self.epsilon} is none")

    def outputs_of(self, counts):
        """What the layers make of one frame of counts, in double precision, as the library orders them."""
        rows, columns, channels = self.shape
        x = (numpy.asarray(counts, numpy.float64).reshape(self.mean.shape) - self.mean) * numpy.float32(self.scale)
        with numpy.errstate(all="ignore"):
            return run_all(self.layers, x.reshape(channels, rows, columns)).ravel()

    def tensor_of(self, counts, scale=1.0, mean=0.0):
        """The input of the ONNX model for one frame of counts."""
        return ((numpy.asarray(counts, numpy.float64).ravel() - mean) * scale)[self.input.places]

    def in_order(self, tensor, of=None):
        """The elements of the ONNX model's output, or of another tensor that is a map, as the library orders them."""
        here = of or self.output
        found = numpy.zeros(here.size)
        found[here.places.ravel()] = numpy.ravel(tensor)
        return found

    def _test(self, scale, mean, end, logits):
        """Computes the model node by node, and compares with the layers."""
        self.selftest_input, rows, worst = self.frames, [], 0.0
        for counts in self.frames:
            values = self.graph.evaluate(self.tensor_of(counts, scale, mean))
            if any(v.dtype.kind == "f" and not abs(v).max() < 1e18 for n, v in values.items() if n not in self.graph.constants):
                raise CannotImport("frames of counts make numbers that are not finite, or whose squares are not in single precision; the "
                                   "nearest that can be imported: a model of counts, or of counts that --mean and --scale normalise")
            tensor, here = logits or (self.graph.output, end)
            expected = self.in_order(values[tensor], here)
            found = self.outputs_of(counts)
            if logits:
                powers = numpy.exp(expected - expected.max())
                compared = powers / powers.sum()
            else:
                compared = expected
            worst = max(worst, float(abs(found - compared).max() / max(abs(compared).max(), 1e-30)))
            rows.append(expected)
        if not worst <= 1e-4:
            raise CannotImport(f"the layers {', '.join(map(str, self.layers))[:200]} would differ from the model by {worst:.1e} of its "
                               "largest output: numbers so far apart, or so close to a step, do not survive single precision")
        self.selftest_logits, self.difference = numpy.array(rows, numpy.float32), worst

    def save(self, folder="."):
        """Writes NAME.hpp, NAME.safetensors and NAME.txt, and returns the report."""
        return write.save(folder, self.name, write.weights(self), write.header(self), write.report(self))


def read(path, name=None, **options):
    """The Network of an ONNX file, or of its bytes; the Machine of one with an SVMClassifier. Options are those of Network."""
    try:
        model = onnx.load_model_from_string(path) if isinstance(path, bytes) else onnx.load(path, load_external_data=False)
    except Exception as error:  # the parser's own types differ between versions
        if isinstance(error, OSError):
            raise
        raise CannotImport("it is no ONNX file") from None
    source = "bytes" if isinstance(path, bytes) else os.path.basename(path)
    kind = Machine if any(node.op_type == "SVMClassifier" for node in model.graph.node) else Network
    try:
        return kind(model, source, name or os.path.splitext(source)[0], **options)
    except CannotImport:
        raise
    except (TypeError, ValueError, IndexError, KeyError, OverflowError) as error:  # a damaged file may state anything
        raise CannotImport(f"its parts do not fit each other: {type(error).__name__}: {error}"[:200]) from None
    except (RecursionError, MemoryError) as error:
        raise CannotImport(f"it is too large: {type(error).__name__}") from None
