"""What the importer refuses, each in one sentence that names the node, its operator and the nearest that can be imported; what it
leaves to the user; and that every model computed node by node agrees with ONNX Runtime.

    import_test.py refusals | command | oracle FOLDER | again FOLDER NETWORKS

FOLDER is where `npm install onnxruntime-node` was run.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy

PACKAGES = str(pathlib.Path(__file__).parents[2] / "packaging/python")
sys.path.insert(0, PACKAGES)
try:
    import tactnet.onnx
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)
from builder import Builder  # noqa: E402


def conv(b, **attributes):
    return b.conv("x", 1, 4, 3, 3, **attributes)


def refused(b, *outputs, **options):
    try:
        tactnet.onnx.read(b.model(*outputs), "name", **options)
    except tactnet.onnx.CannotImport as error:
        return str(error)
    return "imported"


def unary(op, shape=(1, 1, 9, 7), **attributes):
    b = Builder(*shape)
    return refused(b, b.classifier(b(op, conv(b), **attributes), 4 * 7 * 5))


def cell(op, **attributes):
    b = Builder(9, 1, 3)
    count = {"GRU": 3, "LSTM": 4, "RNN": 1}[op]
    directions = 2 if attributes.get("direction") == "bidirectional" else 1
    y = b(op, "x", b.draw(directions, count * 4, 3), b.draw(directions, count * 4, 4), outputs=2, hidden_size=4, **attributes)[1]
    return refused(b, b.gemm(b("Squeeze", y, [0]), 4, 3))


def joined(op, other):
    b = Builder(1, 1, 9, 7)
    x = b("Relu", conv(b))
    return refused(b, b.classifier(b(op, x, other(b, x)), 4 * 7 * 5))


def built(make, *shape, **options):
    b = Builder(*(shape or (1, 1, 9, 7)))
    return refused(b, make(b), **options)


def machine(**changed):
    b = Builder(1, 2, ai_onnx_ml=1)
    settings = {"kernel_type": "RBF", "kernel_params": [1.0], "support_vectors": [1.0, 2.0, 3.0, 4.0], "vectors_per_class": [1, 1],
                "coefficients": [1.0, -1.0], "rho": [0.0], "classlabels_ints": [0, 1], **changed}
    b("SVMClassifier", b("Mul", "x", [0.1, 0.2]), domain="ai.onnx.ml", outputs=2, **settings)
    return refused(b, "t1_0")


CASES = {
    "a polynomial kernel": (machine(kernel_type="POLY"), "(SVMClassifier)", "POLY", "RBF"),
    "too few coefficients": (machine(coefficients=[1.0]), "(SVMClassifier)", "do not fit"),
    "an operator that is none of the library's": (unary("Selu"), "'Selu_1' (Selu)", "nearest that can be imported: Elu"),
    "one that nobody knows": (unary("Zebra"), "'Zebra_1' (Zebra)", "nearest"),
    "a function that is none": (unary("Sqrt"), "'Sqrt_1' (Sqrt)", "nearest"),
    "GELU by tanh": (unary("Gelu", approximate="tanh"), "'Gelu_1' (Gelu)", "without approximation"),
    "Keras' hard sigmoid": (unary("HardSigmoid"), "'HardSigmoid_1' (HardSigmoid)", "alpha = 1/6"),
    "both directions": (cell("GRU", direction="bidirectional"), "'GRU_0' (GRU)", "bidirectional", "direction forward"),
    "backwards": (cell("LSTM", direction="reverse"), "(LSTM)", "reverse", "direction forward"),
    "a plain recurrent layer": (cell("RNN"), "(RNN)", "nearest that can be imported: GRU"),
    "Keras' GRU": (cell("GRU", linear_before_reset=0), "linear_before_reset of 0", "nearest"),
    "a transposed convolution in groups": (built(lambda b: b("ConvTranspose", conv(b), b.draw(4, 1, 2, 2), group=2)), "(ConvTranspose)", "one group"),
    "a dilated pool": (built(lambda b: b.classifier(b("MaxPool", conv(b), kernel_shape=[2, 2], dilations=[2, 2]), 60)), "(MaxPool)", "dilations of 1"),
    "a window of padding": (built(lambda b: b.classifier(b("MaxPool", conv(b), kernel_shape=[2, 2], pads=[2, 2, 2, 2]), 320)), "(MaxPool)", "padding"),
    "a product of maps": (joined("Mul", lambda b, x: b.conv(x, 4, 4, 1, 1)), "'Mul_3' (Mul)", "gate"),
    "a square": (joined("Mul", lambda b, x: x), "(Mul)", "gate"),
    "a difference": (joined("Sub", lambda b, x: b.conv(x, 4, 4, 1, 1)), "'Sub_3' (Sub)", "Add"),
    "a division by the frame": (joined("Div", lambda b, x: b("Relu", x)), "(Div)", "nearest"),
    "a sum that broadcasts": (joined("Add", lambda b, x: b("GlobalAveragePool", x)), "'Add_3' (Add)", "residual"),
    "positions that differ": (built(lambda b: b.classifier(b("Resize", conv(b), "", [1.0, 1.0, 2.0, 2.0], mode="linear", coordinate_transformation_mode="align_corners"),
                                                           560)), "(Resize)", "half_pixel"),
    "a part of a map": (built(lambda b: b.classifier(b.conv(b("Slice", conv(b), [0], [2], [1]), 2, 3, 1, 1), 105)), "(Conv)", "nearest"),
    "channels in another order": (built(lambda b: b.classifier(b.conv(b("Transpose", conv(b), perm=[0, 1, 3, 2]), 4, 3, 1, 1), 105)), "(Conv)", "nearest"),
    "a softmax in the middle": (built(lambda b: b.gemm(b("Softmax", b.classifier(conv(b), 140, 4)), 4, 3)), "(Softmax)", "at the end"),
    "logarithms of probabilities": (built(lambda b: b("LogSoftmax", b.classifier(conv(b), 140, 4))), "(LogSoftmax)", "Softmax"),
    "weights that are not finite": (built(lambda b: b("Conv", "x", numpy.full((2, 1, 3, 3), numpy.inf))), "(Conv)", "finite"),
    "weights of zero": (built(lambda b: b("Conv", "x", numpy.zeros((2, 1, 3, 3)))), "weights are zero"),
    "no layer": (built(lambda b: b("Identity", "x")), "no layer"),
    "a batch of three": (built(conv, 3, 1, 9, 7), "3 frames"),
    "open extents": (built(conv, 1, 1, 0, 7), "--shape"),
    "names of classes": (built(lambda b: b.classifier(conv(b), 140, 4), classes=["a", "b"]), "4 different names"),
    "a constant twice": (built(lambda b: (b.classifier(conv(b), 140, 4), b.constants.append(b.constants[0]))[0]), "same name"),
    "an output that is not there": (built(conv, output="y"), "no output 'y'"),
    "a group norm across channels": (built(lambda b: b("Relu", b("InstanceNormalization", b("Transpose", conv(b), perm=[0, 2, 1, 3]), b.draw(7), b.draw(7)))),
                                     "(InstanceNormalization)", "group_norm"),
}


def check_refusals():
    wrong = 0
    for what, (sentence, *parts) in CASES.items():
        if any(part not in sentence for part in parts) or "\n" in sentence or sentence == "imported":
            print(f"{what}: expected a sentence with {parts}, found: {sentence}")
            wrong += 1
    print(f"{len(CASES)} refusals")
    return wrong


def command(*arguments, folder):
    return subprocess.run([sys.executable, "-m", "tactnet.onnx", *map(str, arguments)], capture_output=True, text=True, cwd=folder,
                          env={**os.environ, "PYTHONPATH": PACKAGES})


def check_command():
    """The command line: three files, one sentence and status 1, nothing half-written."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        b = Builder(1, 1, 9, 7)
        (path / "good net.onnx").write_bytes(b.model(b.classifier(b.norm(conv(b), 4), 140, 2)))
        done = command("good net.onnx", "--scale", 1 / 255, "--classes", "ball,mug", "--output", "out", folder=folder)
        assert done.returncode == 0, done.stderr
        written = sorted(p.name for p in (path / "out").iterdir())
        assert written == ["good_net.hpp", "good_net.safetensors", "good_net.txt"], written
        header = (path / "out/good_net.hpp").read_text()
        assert "using net = network< shape{9, 7}" not in header and "shape{9, 7}, conv2d<4, 3, 1, padding::valid>, batch_norm, dense<2>>;" in header, header
        assert "multiply-adds" in done.stdout and done.stdout == (path / "out/good_net.txt").read_text()
        folded = command("good net.onnx", "--scale", 1 / 255, "--fold", "--output", "folded", folder=folder)
        assert "batch_norm" not in (path / "folded/good_net.hpp").read_text() and "folded          a batch norm" in folded.stdout, folded.stdout
        (path / "bad.onnx").write_bytes(b"no model")
        for arguments in (["bad.onnx"], ["missing.onnx"], ["good net.onnx", "--shape", "1,2"], ["good net.onnx", "--classes", "a"]):
            found = command(*arguments, folder=folder)
            assert found.returncode == 1 and found.stderr.count("\n") == 1 and arguments[0] in found.stderr, (arguments, found)
        assert not list(path.glob("*.hpp")) and not list(path.glob("*.partial"))
    return 0


def oracle_in(folder):
    if not folder or not (pathlib.Path(folder) / "node_modules/onnxruntime-node").is_dir():
        print("skipped: needs onnxruntime-node, and TACTNET_ONNXRUNTIME for the folder in which npm installed it")
        sys.exit(77)
    from oracle import Oracle
    return Oracle(folder)


def differ(name, found, expected):
    """Whether outputs differ: 1e-5 of the largest shows a mistake in what is computed. The C++ test has the derived bounds."""
    if not isinstance(found, str) and all(abs(a - b).max() <= 1e-5 * abs(b).max() for a, b in zip(found, expected)):
        return 0
    print(f"{name}: expected {expected[0][:3]}, found {found if isinstance(found, str) else found[0][:3]}")
    return 1


def check_oracle(folder):
    """Layers in double precision and the runtime agree."""
    import operator_models
    import whole_models
    oracle, wrong, models = oracle_in(folder), 0, {**operator_models.MODELS, **whole_models.MODELS}
    for name, (data, options) in models.items():
        network = tactnet.onnx.read(data, name, **options)
        tensors = [network.tensor_of(frame, options.get("scale", 1.0)) for frame in network.frames]
        found = oracle.outputs(data, tensors, network.graph.output)
        wrong += differ(name, found if isinstance(found, str) else [network.in_order(row) for row in found],
                        [network.outputs_of(frame) for frame in network.frames])
    # Of a model in 8 bits, the runtime rounds maps and the layers do not: half a step each, on its way through the weights.
    data, scales = operator_models.quantised()
    network = tactnet.onnx.read(data, "quantised")
    assert str(network.layers[1]) == "relu" and len(network.layers) == 3, network.layers
    reach = numpy.full((1, 6, 5), scales[0] / 2)
    for layer, scale in zip((network.layers[0], network.layers[2]), scales[1:]):
        reach = layer.run(reach, {"weight": abs(layer.arrays["weight"]), "bias": 0 * layer.arrays["bias"]}) + scale / 2
    for frame, found in zip(network.frames, oracle.outputs(data, [network.tensor_of(f) for f in network.frames], network.graph.output)):
        saturated = abs(found) >= 127 * scales[2]
        wrong += bool((abs(found - network.outputs_of(frame)) > reach.ravel() * (1 + 1e-5))[~saturated].any() or saturated.all())
    for name, data in operator_models.MACHINES.items():
        machine = tactnet.onnx.read(data, name)
        labels = machine.parts["selftest.labels"]
        wrong += differ(name, oracle.outputs(data, machine.frames[:, None], "label"), labels[:, None]) + (len(set(labels)) == 1)
    print(f"{wrong} of {len(models) + len(operator_models.MACHINES)} models differ from the runtime")
    return wrong


def check_again(folder, networks):
    """What C++ has written as ONNX: the runtime's outputs, and an import that gives the same layers."""
    oracle, wrong, files = oracle_in(folder), 0, sorted(pathlib.Path(networks).glob("*.again.onnx"))
    for path in files:
        name, data = path.name[:-len(".again.onnx")], path.read_bytes()
        network = tactnet.onnx.read(data, name)
        with open(path.with_name(f"{name}.expected.safetensors"), "rb") as file:
            header = json.loads(file.read(int.from_bytes(file.read(8), "little")))
            stored = file.read()
        read = {key: numpy.frombuffer(stored[slice(*header[key]["data_offsets"])], kind).reshape(header[key]["shape"])
                for key, kind in (("input", numpy.uint8), ("outputs", numpy.float32))}
        rows, columns, channels = network.shape
        wrong += network.classes[0] != "class_00" and not name.startswith("linear")
        found = oracle.outputs(data, [f.reshape(1, channels, rows, columns).astype(numpy.float32) for f in read["input"]], network.graph.output)
        wrong += differ(name, found, read["outputs"])
        first = path.with_name(f"{name}.hpp").read_text().split("using net")[1]
        if tactnet.onnx.write.header(network).split("using net")[1] != first:
            print(f"{name}: expected {first}, found {tactnet.onnx.write.header(network)}")
            wrong += 1
    print(f"{wrong} of {len(files)} files that C++ has written differ")
    return wrong or len(files) < 40


if __name__ == "__main__":
    what, *arguments = sys.argv[1:]
    checks = {"refusals": check_refusals, "command": check_command, "oracle": check_oracle, "again": check_again}
    sys.exit(1 if checks[what](*arguments[: checks[what].__code__.co_argcount]) else 0)
