"""Kernel machines of scikit-learn, as skl2onnx writes them: SVMClassifier, perhaps after a Scaler."""

import json

import numpy
import onnx

from . import operators, write
from .graph import CannotImport, Graph, Node
from .walk import walk


class Machine:
    """An imported kernel machine: the `parts` of its file, `classes`, and the frames of its self-test with their labels."""

    def __init__(self, model, source, name, classes=None, **_):
        self.source, self.name = source, write.identifier(name)
        proto = next(n for n in model.graph.node if n.op_type == "SVMClassifier")
        node = Node(proto, 1, 0)
        kind = node.get("kernel_type", "LINEAR")
        node.require(kind in ("RBF", "LINEAR"), f"a kernel of type {kind}", "RBF or LINEAR")
        counts = numpy.array(node.get("vectors_per_class", []), int)
        node.require(counts.size > 1, "it has no support vectors", "SVC, or LinearClassifier for a linear machine")
        labels = node.get("classlabels_strings") or node.get("classlabels_ints", [])
        named = [c.decode("utf-8", "replace") if isinstance(c, bytes) else str(c) for c in labels]
        self.classes = list(classes or named)
        node.require(len(set(self.classes)) == counts.size and counts.min() > 0, "its classes do not fit its vectors", "a name and a vector each")
        vectors, total = numpy.array(node.get("support_vectors", [])), int(counts.sum())
        coefficients, offsets = numpy.array(node.get("coefficients", [])), numpy.array(node.get("rho", []))
        machines = counts.size * (counts.size - 1) // 2
        node.require(vectors.size and vectors.size % total == 0 and coefficients.size == total * (counts.size - 1) and offsets.size == machines,
                     "its vectors, coefficients and offsets do not fit each other", "a model as skl2onnx writes it")
        self.gamma = float(node.get("kernel_params", [0.0])[0])
        vectors = vectors.reshape(total, -1)
        self.features, self.kernel = vectors.shape[1], "rbf" if kind == "RBF" else "linear"
        node.require(all(numpy.isfinite(a).all() for a in (vectors, coefficients, offsets)) and self.gamma >= 0, "a number is not finite",
                     "finite numbers, and gamma of 0 or more")
        self.parts = {"labels": numpy.arange(counts.size), "support_counts": counts, "support_vectors": vectors.astype(numpy.float32),
                      "coefficients": coefficients.reshape(counts.size - 1, total).T.copy(), "offsets": offsets.astype(numpy.float64)}
        if kind == "RBF":
            self.parts["gamma"] = numpy.array(self.gamma)
        scale, shift = self.scale, self.shift = self._standardisation(model, proto)
        if (scale != 1).any() or shift.any():
            node.require((scale > 0).all() and abs(shift).max() < 1e18 and 1e-18 < scale.min() and scale.max() < 1e18,
                         "it follows factors and offsets that are no usual numbers", "Scaler")
            self.parts.update({"standardise.mean": (-shift / scale).astype(numpy.float32), "standardise.deviation": (1 / scale).astype(numpy.float32)})
        self.frames = numpy.random.default_rng(1).integers(0, 256, (32, self.features)).astype(numpy.float32)
        rows = [self.label_of(frame * scale + shift) for frame in self.frames]
        self.parts.update({"selftest.input": self.frames, "selftest.labels": numpy.array(rows)})

    def _standardisation(self, model, proto):
        """Factor and shift of each feature before the machine."""
        values = [v for v in model.graph.input if v.name not in {t.name for t in model.graph.initializer}]
        if values and values[0].name == proto.input[0]:
            return numpy.ones(self.features), numpy.zeros(self.features)
        part = onnx.ModelProto()
        part.CopyFrom(model)
        del part.graph.output[:], part.graph.node[:]
        part.graph.node.extend(n for n in model.graph.node if n.op_type != "SVMClassifier")
        part.graph.output.add().name = proto.input[0]
        layers, here, _, _ = walk(Graph(part, operators.EVALUATIONS))
        arrays = [numpy.ones(here.size), numpy.zeros(here.size)]
        for layer in layers:
            if layer.kind != "affine":
                raise CannotImport(f"node '{proto.name}' (SVMClassifier): {layer} comes before it; the nearest that can be imported: Scaler")
            arrays = [arrays[0] * layer.arrays["scale"], arrays[1] * layer.arrays["scale"] + layer.arrays["shift"]]
        if here.size != self.features:
            raise CannotImport(f"node '{proto.name}' (SVMClassifier): {self.features} features of an input of {here.size}; the nearest that can "
                               "be imported: as many")
        return arrays

    def label_of(self, x):
        """One versus one, of features as the machine sees them."""
        vectors, counts = self.parts["support_vectors"].astype(numpy.float64), self.parts["support_counts"]
        products = numpy.exp(-self.gamma * ((vectors - x) ** 2).sum(1)) if self.kernel == "rbf" else vectors @ x
        ends = numpy.concatenate([[0], numpy.cumsum(counts)])
        votes, pair = numpy.zeros(counts.size, int), 0
        for i in range(counts.size):
            for j in range(i + 1, counts.size):
                own, other = slice(ends[i], ends[i + 1]), slice(ends[j], ends[j + 1])
                total = self.parts["coefficients"][own, j - 1] @ products[own] + self.parts["coefficients"][other, i] @ products[other]
                votes[i if total + self.parts["offsets"][pair] > 0 else j] += 1
                pair += 1
        return int(votes.argmax())

    def save(self, folder="."):
        """Writes NAME.hpp, NAME.safetensors and NAME.txt, and returns the report."""
        template = f"<tactnet::{self.kernel}_kernel, {self.features}>"
        header = write.header_of(self, "tactnet/svm.hpp", f'tactnet::load_kernel_machine{template}("{self.name}.safetensors")   // tactnet/io/svm_file.hpp',
                                 f"using machine = tactnet::kernel_machine{template};")
        metadata = {"format": "tactnet", "version": "1", "machine": "kernel", "kernel": self.kernel, "multiclass": "one versus one",
                    "classes": json.dumps(self.classes), "source": self.source}
        text = (f"{self.source}: a support vector machine\nkernel          {self.kernel}\nfeatures        {self.features}\n"
                f"classes         {len(self.classes)}\nsupport vectors {len(self.parts['support_vectors'])}\n"
                "left out        probabilities of its decision values\n")
        return write.save(folder, self.name, write.safetensors(self.parts, metadata), header, text)
