"""Models of ONNX node by node, with weights drawn from a seed."""

import numpy
from onnx import TensorProto, helper, numpy_helper


class Builder:
    def __init__(self, *shape, opset=13, seed=1, **domains):
        self.shape, self.opsets = shape, [helper.make_opsetid("", opset)] + [
            helper.make_opsetid(name.replace("_", "."), version) for name, version in domains.items()]
        self.nodes, self.constants, self.random = [], [], numpy.random.default_rng(seed)

    def constant(self, values):
        values = numpy.asarray(values)
        values = values.astype(numpy.float32) if values.dtype.kind == "f" else values.astype(numpy.int64)
        name = f"c{len(self.constants)}"
        self.constants.append(numpy_helper.from_array(values, name))
        return name

    def draw(self, *shape, low=None, high=None):
        """Weights of about the size that keeps the size of maps."""
        spread = (6 / max(1, int(numpy.prod(shape[1:])))) ** 0.5 if len(shape) > 1 else 0.5
        return self.random.uniform(-spread if low is None else low, spread if high is None else high, shape)

    def __call__(self, op, *inputs, outputs=1, domain="", **attributes):
        """Adds a node; inputs are names, arrays or lists of numbers. Returns the names of its outputs."""
        names = [i if isinstance(i, str) else self.constant(i) for i in inputs]
        made = [f"t{len(self.nodes)}_{i}" for i in range(outputs)]
        self.nodes.append(helper.make_node(op, names, made, f"{op}_{len(self.nodes)}", domain=domain, **attributes))
        return made[0] if outputs == 1 else made

    def conv(self, x, channels, filters, *kernel, bias=True, groups=1, **attributes):
        weights = [self.draw(filters, channels // groups, *kernel)] + ([self.draw(filters)] if bias else [])
        return self("Conv", x, *weights, kernel_shape=list(kernel), group=groups, **attributes)

    def norm(self, x, channels, variance=1, **attributes):
        return self("BatchNormalization", x, self.draw(channels, low=0.5, high=1.5), self.draw(channels), self.draw(channels),
                    self.draw(channels, low=0.5 * variance, high=2.0 * variance), **attributes)

    def gemm(self, x, inputs, outputs):
        return self("Gemm", x, self.draw(outputs, inputs), self.draw(outputs), transB=1)

    def classifier(self, x, inputs, outputs=5):
        return self.gemm(self("Flatten", x), inputs, outputs)

    def model(self, *outputs, batch=None):
        made = helper.make_graph(
            self.nodes, "graph", [helper.make_tensor_value_info("x", TensorProto.FLOAT, [self.shape[0] if batch is None else batch, *self.shape[1:]])],
            [helper.make_tensor_value_info(o, TensorProto.INT64 if o.startswith("label") else TensorProto.FLOAT, None) for o in outputs],
            self.constants)
        return helper.make_model(made, opset_imports=self.opsets, ir_version=8).SerializeToString()
