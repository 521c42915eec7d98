"""Damaged ONNX files: each is refused in one sentence, or makes a network whose layers compute what ONNX Runtime computes.

    mutate.py COUNT [FOLDER] [SEED]     FOLDER is where `npm install onnxruntime-node` was run; without it, what is imported is compared
                                        with the model computed node by node alone, as every import is
"""

import collections
import pathlib
import sys
import time

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "packaging/python"))
try:
    import onnx
    import tactnet.onnx
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)
import operator_models  # noqa: E402
import whole_models  # noqa: E402
from oracle import Oracle  # noqa: E402


def numbers_of(model):
    """(message, field, index) of all whole numbers and texts of a model that say what it is, without weights."""
    found, stack = [], [model.graph, *model.opset_import]
    while stack:
        message = stack.pop()
        for field, value in message.ListFields():
            values = value if field.label == field.LABEL_REPEATED else [value]
            if field.type == field.TYPE_MESSAGE:
                stack += list(values)
            elif field.name not in ("raw_data", "float_data", "doc_string"):
                found += [(message, field, i) for i in range(len(values))]
    return found


def mutate(data, random):
    """Bytes changed, cut or repeated; or, so that most files can be read at all, one number, text or node of the model."""
    kind = random.integers(0, 10)
    if kind < 3:
        data = bytearray(data)
        for _ in range(random.integers(1, 4)):
            place = random.integers(len(data))
            if kind == 0:
                data[place] = random.integers(256)
            elif kind == 1:
                data[place] ^= 1 << random.integers(8)
            else:
                end = min(len(data), place + int(random.integers(1, 40)))
                data[place:end] = b"" if random.integers(2) else data[place:end] * 2
        return bytes(data)
    model = onnx.load_model_from_string(data)
    nodes = model.graph.node
    if kind == 3 and len(nodes) > 1:
        place = int(random.integers(len(nodes)))
        if random.integers(2):
            del nodes[place]
        else:
            other = nodes[int(random.integers(len(nodes)))].op_type
            nodes[place].op_type = other
    elif kind == 4:  # inputs of nodes swapped
        a, b = nodes[int(random.integers(len(nodes)))], nodes[int(random.integers(len(nodes)))]
        if len(a.input) and len(b.input):
            i, j = int(random.integers(len(a.input))), int(random.integers(len(b.input)))
            a.input[i], b.input[j] = b.input[j], a.input[i]
    else:
        message, field, index = (lambda all_of: all_of[int(random.integers(len(all_of)))])(numbers_of(model))
        repeated = field.label == field.LABEL_REPEATED
        old = getattr(message, field.name)[index] if repeated else getattr(message, field.name)
        if isinstance(old, bool) or isinstance(old, int):
            new = int(random.choice([old + 1, old - 1, 0, 1, 2, 3, -1, old * 2, 7, 1 << 31, -(1 << 62)]))
            if field.type == field.TYPE_ENUM or field.cpp_type in (field.CPPTYPE_INT32, field.CPPTYPE_UINT32):
                new %= 1 << 31
        elif isinstance(old, float):
            new = float(random.choice([0, -old, old * 2, 1e-30, 1e30, float("inf"), float("nan"), old + 0.25]))
        else:
            new = random.choice([b"", b"x", b"SAME_LOWER", b"VALID", b"floor", b"reverse", b"linear", b"t0_0", b"t1_0", b"c0", b"c1"])
            new = bytes(new) if isinstance(old, bytes) else bytes(new).decode()
        try:
            if repeated:
                getattr(message, field.name)[index] = new
            else:
                setattr(message, field.name, new)
        except (ValueError, TypeError):
            return data[: int(random.integers(len(data)))]
    return model.SerializeToString()


def main():
    count, folder = int(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else ""
    random = numpy.random.default_rng(int(sys.argv[3]) if len(sys.argv) > 3 else 1)
    models = list({**operator_models.MODELS, **whole_models.MODELS}.items())
    models += [(name, (data, {})) for name, data in operator_models.MACHINES.items()]
    oracle = Oracle(folder) if (pathlib.Path(folder or "/") / "node_modules/onnxruntime-node").is_dir() else None
    found, wrong, slowest = collections.Counter(), 0, 0.0
    for i in range(count):
        name, (data, options) = models[int(random.integers(len(models)))]
        damaged = mutate(data, random)
        if random.integers(4) == 0:
            damaged = mutate(damaged, random) if onnx_readable(damaged) else damaged
        start = time.monotonic()
        try:
            network = tactnet.onnx.read(damaged, name, frames=2, **options)
        except tactnet.onnx.CannotImport as error:
            found["refused"] += 1
            if "\n" in str(error) or len(str(error)) < 10:
                print(f"{i}: no sentence: {error!r}")
                wrong += 1
            continue
        except Exception as error:  # noqa: BLE001
            print(f"{i}, {name}: {type(error).__name__}: {error}")
            pathlib.Path(f"crash_{i}.onnx").write_bytes(damaged)
            wrong += 1
            continue
        finally:
            slowest = max(slowest, time.monotonic() - start)
        if oracle is None:
            found["imported"] += 1
            continue
        if isinstance(network, tactnet.onnx.Machine):
            labels = oracle.outputs(damaged, network.frames[:, None], "label")
            found["machine" if not isinstance(labels, str) else "imported, refused by the runtime"] += 1
            if not isinstance(labels, str):
                wrong += check_labels(f"{i}, {name}", network, numpy.concatenate(labels))
            continue
        tensors = [network.tensor_of(frame, options.get("scale", 1.0)) for frame in network.frames]
        outputs = oracle.outputs(damaged, tensors, network.graph.output)
        if isinstance(outputs, str):
            found["imported, refused by the runtime"] += 1
            continue
        if any(row.size != network.output.size for row in outputs):
            print(f"{i}, {name}: the runtime has outputs of another size")
            wrong += 1
            continue
        if not all(numpy.isfinite(row).all() for row in outputs):  # numbers around 1e15, in the functions of the runtime
            found["imported, not finite in the runtime"] += 1
            continue
        outputs = [network.in_order(row) for row in outputs]
        expected = [network.outputs_of(frame) for frame in network.frames]
        if all(a.shape == b.shape and abs(a - b).max() <= 1e-4 * max(abs(b).max(), 1e-30) for a, b in zip(outputs, expected)) or close(
                outputs, expected, network):
            found["imported, equal"] += 1
        else:
            found["differs"] += 1
            print(f"{i}, {name}: expected {outputs[0][:4]}, found {expected[0][:4]}: {', '.join(map(str, network.layers))[:300]}")
            pathlib.Path(f"wrong_{i}.onnx").write_bytes(damaged)
            wrong += 1
    print(f"{count} damaged files: {dict(found)}; the slowest took {slowest:.2f} s; {wrong} wrong")
    return 1 if wrong else 0


def check_labels(what, machine, labels):
    """1 if a label differs for features that are as far from a decision as single precision tells."""
    around = [[machine.label_of(frame * machine.scale * (1 + e) + machine.shift) for e in (-1e-5, 0, 1e-5)] for frame in machine.frames]
    if len(labels) == len(around) and all(label in [float(machine.classes[n]) for n in near] for label, near in zip(labels, around)):
        return 0
    print(f"{what}: expected the labels {labels}, found {[near[1] for near in around]}")
    return 1


def close(outputs, expected, network):
    """Whether outputs differ by no more than inputs and weights that single precision has rounded make them differ: of weights such as
    1e17, that is much."""
    random, reach = numpy.random.default_rng(1), [0.0 for _ in expected]
    stored = [(layer, dict(layer.arrays)) for layer in network.all_layers()]
    for _ in range(3):
        for layer, arrays in stored:
            layer.arrays = {name: array * (1 + 2**-22 * random.standard_normal(array.shape)) for name, array in arrays.items()}
        for i, frame in enumerate(network.frames):
            reach[i] = max(reach[i], abs(network.outputs_of(frame * (1 + 2**-22 * random.standard_normal(frame.shape))) - expected[i]).max())
    for layer, arrays in stored:
        layer.arrays = arrays
    return all(a.shape == b.shape and abs(a - b).max() <= 8 * r for a, b, r in zip(outputs, expected, reach))


def onnx_readable(data):
    try:
        return len(onnx.load_model_from_string(data).graph.node) > 1
    except Exception:  # noqa: BLE001
        return False


sys.exit(main())
