"""Imports all test models: a header, weights and expected outputs for each, and the units that compare them.

    write_networks.py FOLDER UNITS [RUNTIME]     RUNTIME is where `npm install onnxruntime-node` was run

Expected are the outputs of the runtime, or without one those of the models computed node by node in double precision.
"""

import pathlib
import sys

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "packaging/python"))
import operator_models  # noqa: E402
import tactnet.onnx  # noqa: E402
import whole_models  # noqa: E402
from oracle import Oracle  # noqa: E402
from tactnet.onnx import write  # noqa: E402

FRAMES = 3


def main():
    folder, units = pathlib.Path(sys.argv[1]), int(sys.argv[2])
    oracle = Oracle(sys.argv[3]) if len(sys.argv) > 3 and sys.argv[3] else None
    models = {**operator_models.MODELS, **whole_models.MODELS}
    folder.mkdir(parents=True, exist_ok=True)
    texts = [[] for _ in range(units)]
    for place, (name, (data, options)) in enumerate(models.items()):
        network = tactnet.onnx.read(data, name, **options)
        network.save(folder)
        frames = numpy.random.default_rng(place + 2).integers(0, 256, (FRAMES, *network.mean.shape), numpy.uint8)
        scale = options.get("scale", 1.0)
        if oracle is None:
            rows = [network.outputs_of(frame) for frame in frames]
        else:
            rows = oracle.outputs(data, [network.tensor_of(frame, scale) for frame in frames], network.graph.output)
            if isinstance(rows, str):
                sys.exit(f"{name}: the runtime refuses the model: {rows}")
            rows = [network.in_order(row) for row in rows]
        (folder / f"{name}.expected.safetensors").write_bytes(write.safetensors({
            "input": frames, "outputs": numpy.array(rows, numpy.float32)}, {}))
        stream = "deploy_stream" in write.header(network)
        texts[place % units].append((name, f"imported::compare<{network.name}::net, {str(stream).lower()}>"))
    for place, (name, data) in enumerate(operator_models.MACHINES.items()):
        imported = tactnet.onnx.read(data, name)
        if oracle is not None:  # its labels in the file, in place of those of the importer
            rows = oracle.outputs(data, imported.frames[:, None], "label")
            imported.parts["selftest.labels"] = numpy.concatenate(rows).astype(numpy.int64)
        imported.save(folder)
        texts[place % units].append((name, f"imported::wrong_labels<{name}::machine>"))
    for number, cases in enumerate(texts):
        lines = ['#include "imported.hpp"\n', *(f'#include "{name}.hpp"\n' for name, _ in cases)]
        for name, call in cases:
            if name.startswith("machine_"):
                lines.append(f'\nTEST_CASE("onnx: {name}") {{\n    CHECK({call}("{folder.as_posix()}", "{name}") == 0);\n}}\n')
                continue
            lines.append(f'\nTEST_CASE("onnx: {name}") {{\n    const auto found = {call}("{folder.as_posix()}", "{name}");\n'
                         "    CHECK(found.network);\n    CHECK(found.runtime);\n}\n")
        path, text = folder / f"networks_{number}.cpp", "".join(lines)
        if not path.exists() or path.read_text() != text:
            path.write_text(text)
    print(f"{len(models) + len(operator_models.MACHINES)} models, expected outputs {'of the runtime' if oracle else 'computed node by node'}")


main()
