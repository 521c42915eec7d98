"""The Python package: python3 module_test.py CHECK [PROGRAM], where PROGRAM is scores.cpp compiled."""

import concurrent.futures
import contextlib
import doctest
import importlib
import io
import json
import os
import pathlib
import pickle
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "packaging/python"))
try:
    import numpy
    import sklearn.model_selection
    import tactnet
    from tactnet import build
    from tactnet.layers import *  # noqa: F403
    build.core()
except (ImportError, build.CompilerNotFound) as error:
    print(f"skipped: {error}")
    sys.exit(77)


def touches(count, classes, rows, columns):
    """Bars, each class at its place, and noise."""
    frames = numpy.random.default_rng(1).integers(0, 20, (count, rows, columns)).astype(numpy.uint8)
    labels = numpy.arange(count) % classes
    for frame, label in zip(frames, labels):
        frame[label * rows // classes:(label + 1) * rows // classes, 2:-3] += 150
    return frames, labels


def message(kind, call, *parts):
    try:
        call()
    except kind as error:
        missing = [part for part in parts if part not in str(error)]
        assert not missing, f"{missing} are not in: {error}"
        return
    raise AssertionError(f"expected {kind.__name__}: {parts}")


def same_bits(program):
    """A network that was trained here gives the outputs of C++, alone, in batches and in 8 bits, and costs little more."""
    frames, labels = touches(60, 5, 14, 25)
    frames[:10] %= 20  # of air
    network = tactnet.Network.named("tactnet4", (14, 25), 5)
    assert (network.input_shape, network.outputs, network.parameters, network.multiply_adds) == ((14, 25, 1), 5, 4085, 130416)
    network.fit(frames, labels, epochs=2, validation=range(0, 60, 7))
    again = tactnet.Network.named("tactnet4", (14, 25), 5).fit(frames, labels, epochs=2, validation=range(0, 60, 7), threads=2)
    assert again.to_bytes() == network.to_bytes(), "threads change a training"
    single, eight = network.deploy(), network.deploy(bits=8, images=frames)
    network.save("scores.safetensors", frames[:3])
    eight.save("scores_8.safetensors", frames[:3])
    assert (network.load_deployed("scores_8.safetensors").scores(frames) == eight.scores(frames)).all()
    frames.tofile("frames.bin")
    run = subprocess.run([program, "scores.safetensors", "frames.bin", "scores_8.safetensors"], capture_output=True, text=True, check=True)
    numbers = numpy.array([float.fromhex(line) for line in run.stdout.split()])
    expected, touched = numbers[:600].reshape(2, 60, 5), 600 + 50 * 351 + 350 + 1
    same_touches(numbers[600:touched], frames, expected[1, -1])
    same_objects(numbers[touched:], frames, labels, single)
    assert (eight.features(frames) % 1 == 0).all() and eight.features(frames).shape == single.features(frames).shape
    for deployed, outputs in zip((single, eight), expected):
        assert (deployed.scores(frames, threads=2) == outputs).all()
        for form in (frames[7], *map(frames[7].astype, ("f4", "u4", ">u2", ">f4")), frames.astype(numpy.int64)[7], numpy.asfortranarray(frames[7]),
                     frames[7].ravel()):
            assert (deployed.scores(form) == outputs[7]).all()
        assert deployed.classify(frames[7]) == (deployed.predict(frames[7]), deployed.predict_proba(frames)[7].max())
        assert abs(deployed.predict_proba(frames).sum(1) - 1).max() < 1e-12
    begin = time.perf_counter()
    for _ in range(20000):
        single.scores(frames[0])
    nanoseconds = (time.perf_counter() - begin) / 20000 * 1e9
    print(f"a call takes {nanoseconds:.0f} ns, in C++ {run.stderr.split()[0]}")
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        assert all((found == expected[0]).all() for found in pool.map(lambda _: single.scores(frames), range(20)))
    single.export_header("exported.hpp", "tactile::own", frames[0])
    assert "namespace tactile::own" in pathlib.Path("exported.hpp").read_text()
    plain = tactnet.Network.named("tactnet4", (14, 25), 5).fit(frames, labels, epochs=1, augmentation="none")
    assert b"reflected_axes" in plain.to_bytes() and b"reflected_axes" not in network.to_bytes()
    plain.deploy().export_header("plain.hpp", "plain", frames[0])
    assert "reflection_rule_view{{false, {}}, {false, {}}}" in pathlib.Path("plain.hpp").read_text()
    assert single.classify(numpy.full((14, 25), numpy.nan)) is None
    message(ValueError, lambda: single.scores(numpy.full((2, 14, 25), [[[1]], [[numpy.inf]]])), "frame 1")
    message(ValueError, lambda: single.scores(frames[:, :5]), "14 x 25", "(60, 5, 25)")
    message(tactnet.FileError, lambda: network.load("scores_8.safetensors"), "scores_8.safetensors", "single precision")
    message(ValueError, lambda: network.fit(frames, labels + 3), "images: expected labels below 5, found 5")
    for wrong, *parts in ((dict(labels=labels + 0.7), "float64"), (dict(labels=labels - 1), "from -1 on"), (dict(labels=labels[:, None]), "(60, 1)"),
                          (dict(frames=frames + 1j), "complex128"), (dict(frames=frames.astype(str)), "real numbers"), (dict(validation=[1.7]), "mask", "float64"),
                          (dict(validation=[-1]), "from -1 on"), (dict(classes=list("aabcd")), "each once"), (dict(classes=["a", "b\n", "c", "d", "e"]), "each once"),
                          (dict(classes=list("abcd") + [""]), "''"), (dict(epoch=3), "'epoch'", "reflect_rows"), (dict(augmentation="some"), "each_epoch, sixfold, auto, found 'some'"),
                          (dict(rate=-1.0), "finite rate"), (dict(translation=numpy.nan), "finite translation"), (dict(rotation=numpy.inf), "finite rotation")):
        message(ValueError, lambda: network.fit(**{"frames": frames, "labels": labels, **wrong}), *parts)
    mask = numpy.arange(60) % 7 == 0
    assert tactnet.Network.named("tactnet4", (14, 25), 5).fit(frames, labels, epochs=2, validation=mask).to_bytes() == network.to_bytes()
    for path in ("/dev/full", "."):
        message(OSError, lambda: network.save(path), "expected a file")
    message(tactnet.TrainingDiverged, lambda: network.fit(frames, labels, rate=1e30), "lower the learning rate")


def same_touches(numbers, frames, logits):
    """Health, contacts, a simulation and evidence as in C++."""
    sensor = tactnet.Sensor((14, 25), full=200)
    sensor.learn(frames[:10])
    state = sensor.state
    clean, contacts = sensor.update(frames[10:])
    of_each = numbers[:50 * 351].reshape(50, 351)
    assert (clean.reshape(50, 350) == of_each[:, :-1]).all() and (contacts["area"] == of_each[:, -1]).all() and contacts["firm"].any()
    for stored in ("u4", ">u2", ">f4"):
        other = tactnet.Sensor((14, 25), full=200)
        other.learn(frames[:10].astype(stored))
        assert (other.update(frames[10:].astype(stored))[0] == clean).all(), stored
    again = tactnet.Sensor((14, 25), full=4095)
    again.learn(frames[0].astype(numpy.uint16) * 16)
    assert again.update(frames[0].astype(numpy.uint16) * 16)[0].max() < 20 and not again.update(frames[0] * 0)[1]["touching"]
    broken = frames[0].astype(numpy.float32)
    broken[3, 4] = numpy.nan
    again.update(broken)
    assert again.faults[0][:3] == (3, 4, "broken") and not again.worn_out
    again.state = state
    assert not again.faults
    message(ValueError, lambda: setattr(again, "state", state[1:]), "state: ")
    message(ValueError, lambda: again.update(frames[0].T), "14 x 25", "(25, 14)")
    scene = tactnet.Scene((14, 25), ["contact<winkler>", "noise{.additive = 300}", "quantisation<8>"], unit=7)
    heights = (255 - frames[-1].astype(numpy.float32)) * numpy.float32(1e-5)
    measured, pascals, contact = scene.touch(heights, newtons=5, seed=3, frame=2)
    assert (measured.ravel() == numbers[50 * 351:-1]).all() and abs(contact["force"] - 5) < 1e-6 and pascals.shape == (14, 25)
    assert (scene.touch(numpy.stack([heights] * 3), newtons=5, seed=3)[0][2] == measured).all()
    message(ValueError, lambda: scene.touch(heights, newtons=5, metres=1), "found both")
    message(ValueError, lambda: tactnet.Scene((14, 25), ["contact<winkler>", "quantisation<8>", "noise"]), "order of physics")
    evidence = tactnet.Evidence(5, temperature=2)
    assert evidence.most_likely() is None and evidence.add(logits) == 1
    evidence.end_grasp()
    assert evidence.add(numpy.stack([logits, numpy.nan * logits])) == 1 and evidence.grasps == 2
    assert evidence.most_likely()[1] == numbers[-1] and evidence.decide(1e-9) is None and evidence.decide(1)[0] == logits.argmax()
    held_out = numpy.random.default_rng(4).normal(size=(200, 5)).astype(numpy.float32)
    members = tactnet.PredictionSet(held_out, held_out.argmax(1), 0.9).predict(held_out)
    assert members[range(200), held_out.argmax(1)].mean() >= 0.9 and members.sum(1).min() == 1
    for wrong in (lambda: tactnet.Evidence(0), lambda: evidence.add(logits[:4]), lambda: tactnet.PredictionSet(held_out, held_out.argmax(1), 2),
                  lambda: tactnet.PredictionSet(held_out, held_out.argmax(1) + 0.5), lambda: tactnet.PredictionSet(held_out, held_out.argmax(1)).predict(3)):
        message(ValueError, wrong, "expected", "found")
    assert any(len(tenths_beside(lambda: evidence.add(numpy.repeat(logits[None], 400000, 0)))) > 2 for _ in range(5))


def tenths_beside(call):
    """The tenths of the time of a call in which other threads go on; one or two if it holds the lock."""
    times, ticks, interval = [], set(), sys.getswitchinterval()
    thread = threading.Thread(target=lambda: times.extend((time.perf_counter(), call(), time.perf_counter())))
    sys.setswitchinterval(1e-5)
    thread.start()
    while thread.is_alive():
        ticks.add(round(time.perf_counter(), 3))
    sys.setswitchinterval(interval)
    return {int(10 * (tick - times[0]) / (times[2] - times[0])) for tick in ticks if times[0] < tick < times[2]}


def same_objects(numbers, frames, labels, deployed):
    """Features, their discriminant, class means and a gain as in C++."""
    rows = deployed.features(frames)
    assert (rows.ravel() == numbers[:rows.size]).all() and (deployed.features(frames[7].astype("f4")) == rows[7]).all()
    found = tactnet.fit_discriminant(rows, labels, 4)
    points, expected = found.project(rows), numbers[rows.size:-2]
    assert (points[:50].ravel() == expected[:200]).all() and (points[50:] == expected[200:].reshape(10, 7)[:, :4]).all()
    assert found.project(rows[:1]).shape == (1, 4) and tactnet.fit_discriminant(rows, labels.astype("u1"), 4).state == found.state
    means = tactnet.ClassMeans(4, 8)
    assert means.learn(labels[:50], points[:50]) == 50 and means.touches(1) == 10 and means.touches(7) == 0
    nearest = means.nearest(points[50:])
    assert (numpy.array(nearest.tolist()) == expected[200:].reshape(10, 7)[:, 4:]).all() and means.nearest(points[50]) == nearest[0]
    assert means.nearest(points[50:51]).shape == (1,)
    assert means.state == pathlib.Path("means.state").read_bytes()
    again, copied = tactnet.ClassMeans(4, 8), tactnet.Discriminant(rows.shape[1], 4)
    assert again.nearest(points[0])["index"] == -1 and again.nearest(points[0])["relative_distance"] == numpy.inf
    again.state, copied.state = means.state, found.state
    assert (again.nearest(points) == means.nearest(points)).all() and (copied.project(rows[3]) == points[3]).all()
    assert again.learn(7, points[:5] * 100) == 5 and again.learn(8, points[0]) == 0 and again.learn(7, points[0] * numpy.nan) == 0
    assert again.nearest(points[0] * 100)["index"] == 7 and again.spread(7) != means.spread(7)
    again.forget(7)
    assert again.touches(7) == 0 and means.nearest(points[0] * numpy.nan)["index"] == -1
    assert tactnet.fit_largest_distance(numpy.arange(99), 0.05) == 94 and tactnet.fit_largest_distance([1, 2]) == numpy.inf
    trained = tactnet.force_statistics(frames, 8)
    monitor = tactnet.GainMonitor(trained, memory=20)
    assert monitor.gain == 1 and not monitor.drifted
    for touch in range(30):
        monitor.add_touch(3000 + 500 * touch)
    assert (monitor.gain, monitor.uncertainty) == tuple(numbers[-2:]) and tactnet.GainMonitor((0, 0)).gain == 1
    for call, *parts in ((lambda: means.learn(0, points[:, :3]), "(60, 3)"), (lambda: means.learn([1, 2], points), "60 points, found 2"),
                         (lambda: setattr(means, "state", found.state), "state: expected as many bytes"), (lambda: found.project(points), "(60, 4)"),
                         (lambda: tactnet.fit_discriminant(rows, labels, 4, classes=4), "expected more than 4 classes, found 4"),
                         (lambda: tactnet.fit_discriminant(rows, labels[:-1], 4), "for each of 59 labels"),
                         (lambda: tactnet.fit_discriminant(rows, labels - 1, 4), "labels from 0 on"),
                         (lambda: tactnet.fit_discriminant(rows, labels, 4, shrinkage=0), "a shrinkage above 0 and at most 1, found"),
                         (lambda: tactnet.fit_largest_distance([1], 1), "a share of false alarms above 0 and below 1"),
                         (lambda: tactnet.force_statistics(frames[0]), "images (n, rows, columns), found (14, 25)"),
                         (lambda: means.learn(labels + 0.5, points), "whole numbers from 0 on, found float64 of shape (60,)"),
                         (lambda: means.learn(-1, points), "whole numbers from 0 on, found int64 of shape (), some below 0"),
                         (lambda: found.fit(rows.reshape(30, -1), labels, 5), "expected rows of"),
                         (lambda: tactnet.ClassMeans(4, 0), "at least 1, found 0")):
        message(ValueError, call, *parts)


def recordings(_):
    """Whole recordings without a copy, bytes as they come, and damage in one sentence."""
    frames = touches(4, 2, 5, 7)[0].astype(numpy.float32)
    numpy.save("frames.npy", frames)
    recording = tactnet.decode("frames.npy")
    assert (recording.frames == frames).all() and recording.frames.base is recording and not recording.frames.flags.writeable
    assert recording.certain_frames == 4 and recording.damage is None and recording.description["columns"] == 7 and numpy.isnan(recording.seconds).all()
    data = pathlib.Path("frames.npy").read_bytes()
    message(tactnet.FileError, lambda: tactnet.decode(memoryview(data)[:-9]), "bytes: ", "expected", "found")
    damaged = tactnet.decode(data[:-9], keep_damaged=True)
    assert (damaged.frames == frames[:3]).all() and "expected" in damaged.damage
    sensor = {"rows": 2, "columns": 3, "cell": "uint16", "marker": "AA 55", "checksum": {"kind": "sum8"}}
    packets = b"".join(b"\xaa\x55" + body + bytes([sum(b"\xaa\x55" + body) % 256]) for body in (bytes(range(n, n + 12)) for n in (1, 5, 9)))
    device = tactnet.Decoder(sensor)
    found = numpy.concatenate([device.push(packets[i:i + 1]) for i in range(len(packets))] + [device.finish()])
    assert (found == tactnet.decode(packets, sensor).frames).all() and found.shape == (3, 2, 3) and found[0, 0, 1] == 3 + 4 * 256 and device.error is None
    device = tactnet.Decoder(sensor)
    assert [len(device.push(part)) for part in (packets, packets[:5] + b"x" + packets[6:15], packets)] == [3, 0, 3]
    assert "frame 4: expected the marker of a frame" in device.error
    message(ValueError, lambda: tactnet.Decoder({**sensor, "rows": 0}), "'rows'", "found 0")


def classifier(_):
    """scikit-learn's tools on frames of an odd size, with a list of layers, names as labels, and groups."""
    frames, labels = touches(90, 3, 9, 11)
    names, groups = numpy.array(["ball", "bar", "hand"])[labels], numpy.arange(90) // 6
    own = tactnet.Classifier([Conv2d(4, 3), BatchNorm(), ReLU(), MaxPool(2)], epochs=6, settings={"translation": 0, "reflect_rows": 0})
    scores = sklearn.model_selection.cross_val_score(own, frames, names, groups=groups, cv=sklearn.model_selection.GroupKFold(3))
    assert scores.min() == 1, scores
    own.fit(frames, names, groups=groups)
    assert own.score(frames, names) == 1 and list(own.classes_) == own.network_.classes and len(own.history_) == 6
    again = pickle.loads(pickle.dumps(own))
    assert (again.predict_proba(frames) == own.predict_proba(frames)).all() and (again.predict(frames) == own.predict(frames)).all()
    assert sklearn.base.clone(own).get_params() == own.get_params()
    held_out = own._held_out(labels, groups)
    assert 0 < len(held_out) < 90 and not set(groups[held_out]) & set(numpy.delete(groups, held_out))
    flat = tactnet.Classifier(own.network, rows=9, columns=11, epochs=6, settings=own.settings).fit(frames.reshape(90, 99), names, groups=groups)
    assert (flat.predict_proba(frames.reshape(90, 99)) == own.predict_proba(frames)).all()


def networks(_):
    """Streams, softmax, and what does not fit: the library's sentences."""
    network = tactnet.Network((12, 1, 4), [GRU(5), LastFrame(), Dense(2)])
    sequences = numpy.random.default_rng(2).normal(size=(40, 4, 12, 1)).astype(numpy.float32)
    network.fit(sequences, (sequences.sum((1, 2, 3)) > 0).astype(int), epochs=2)
    stream, frames = network.stream(), sequences[0, :, :, 0].T
    outputs = stream.step(frames)
    state = stream.state
    later = stream.step(frames[0])
    stream.state = state
    assert outputs.shape == (12, 2) and (later == stream.step(frames[0])).all() and not (later == outputs[0]).all()
    stream.reset()
    assert (outputs[0] == stream.step(frames[0])).all()
    assert abs(network.stream(bits=8, sequences=sequences).step(frames) - outputs).max() < 0.05
    message(ValueError, lambda: setattr(stream, "state", state[:-1]), "state of this stream")
    message(ValueError, lambda: stream.step(frames * numpy.nan), "frame 0")
    assert (pickle.loads(pickle.dumps(network)).stream().step(frames) == outputs).all()
    small = tactnet.Network((3, 4), [Dense(2), Softmax()]).fit(*touches(20, 2, 3, 4), epochs=2)
    data = small.to_bytes(touches(20, 2, 3, 4)[0])
    assert tactnet.Network((3, 4), [Dense(2), Softmax()]).load_bytes(data).deploy().predict_proba(numpy.ones((3, 4))).sum() == 1
    message(tactnet.FileError, lambda: small.load_bytes(data[:-5] + b"\0" * 5), "checksum")
    message(ValueError, lambda: tactnet.Network((7, 13), [Conv2d(8, 5), MaxPool(2), MaxPool(2), Conv2d(16, 3, padding="valid"), Dense(22)]).parameters,
            "conv2d: the kernel is larger than the padded input", "PaddedRows = 2", "KernelRows = 3")
    message(tactnet.CompilationFailed, lambda: tactnet.Network((7, 13), [Cpp("conv3d<2>")]).parameters, "conv3d")
    message(ValueError, lambda: tactnet.Network((7, 13), [Dense(2)]).deploy(), "trained network")
    for shape in (sequences.transpose(0, 2, 1, 3), sequences[:, :, :-1], None):
        message(ValueError, lambda: network.stream(bits=8, sequences=shape), "(n, 4, 12)")
    for wrong in (lambda: Dense(0), lambda: LeakyReLU(0.0015), lambda: network.stream(bits=16), lambda: tactnet.Network.named("tactnet6", (2 ** 32, 2 ** 32), 2), lambda: Conv2d(2, 3, padding=(1, 2)), lambda: tactnet.Network((7,), [Dense(2)]), lambda: tactnet.Network.named("tactnet5", (7, 13), 2)):
        message(ValueError, wrong, "expected", "found")


def compiler(_):
    """From the cache in no time; without a compiler, what is kept is used, and the rest is a sentence."""
    kept = tactnet.Network((3, 4), [Dense(3)])
    kept.compile("described")
    script = """if True:
        import sys, time
        sys.path.insert(0, sys.argv[1])
        import tactnet
        from tactnet.layers import Dense
        begin = time.perf_counter()
        print(tactnet.Network((3, 4), [Dense(3)]).parameters, time.perf_counter() - begin)
        try:
            tactnet.Network((3, 4), [Dense(4)]).parameters
        except tactnet.CompilerNotFound as error:
            print(error)
    """
    run = subprocess.run([sys.executable, "-c", script, str(build.PACKAGE.parent)], capture_output=True, text=True, env={
        **os.environ, "CXX": "no-such-compiler", "TACTNET_CACHE": str(build.cache())})
    assert run.returncode == 0 and run.stdout.startswith("39 "), run.stderr + run.stdout
    assert "expected a C++20 compiler" in run.stdout and "network<shape{3, 4}, dense<4>>" in run.stdout, run.stdout
    print("from the cache:", run.stdout.split()[1], "s")
    with tempfile.TemporaryDirectory() as folder:  # two processes compile once
        again = [subprocess.Popen([sys.executable, "-c", "import sys; sys.path.insert(0, sys.argv[1]); from tactnet import build; "
                                   "import pathlib; build.part_path('network<shape{3, 4}, dense<3>>', 'described', pathlib.Path(sys.argv[2]))",
                                   str(build.PACKAGE.parent), folder], stderr=subprocess.DEVNULL) for _ in range(2)]
        assert [process.wait() for process in again] == [0, 0]
        assert len(list(pathlib.Path(folder).glob("*.so"))) == 1 and not list(pathlib.Path(folder).glob("*.lock"))


def doctests(_):
    for name in ("tactnet", "tactnet.layers", "tactnet.network", "tactnet.classifier", "tactnet.sensing", "tactnet.objects", "tactnet.build"):
        assert not doctest.testmod(importlib.import_module(name)).failed, name
    undocumented = [name for name, each in vars(tactnet.layers).items() if name[0].isupper() and callable(each) and not each.__doc__]
    assert not undocumented, undocumented


def quantised(_):
    """A quantised model of ONNX with its own scales: the bytes of integer arithmetic, and the runtime's outputs but for their rounding."""
    sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "onnx"))
    try:
        import operator_models
        from oracle import Oracle
    except ImportError as error:
        print(f"skipped: {error}")
        sys.exit(77)
    from tactnet.onnx.operators.quantised import eight_bit_steps
    data, scales = operator_models.quantised()
    network = tactnet.Network.from_onnx(data)
    layers, steps = [layer for layer in network._imported.layers if layer.arrays], eight_bit_steps(network._imported)
    frames = numpy.random.default_rng(1).integers(0, 256, (300, 6, 5)).astype(numpy.uint8)
    found, sums = network.deploy(bits=8).scores(frames), []
    for frame in frames:
        x, of_input = frame[None].astype(float), 1.0
        for layer, step, scale in zip(layers, steps, scales[1:]):
            unit = step["scale"] * of_input
            factors = numpy.rint(step["weight"] / step["scale"].reshape(-1, *[1] * (step["weight"].ndim - 1)))
            x, of_input = layer.run(x, {"weight": factors, "bias": numpy.rint(step["bias"] / unit)}), scale
            last = x * unit[:, None, None]
            x = numpy.clip(numpy.rint(last / scale), 0, 255)
        sums.append(last.ravel())
    assert abs(found - sums).max() <= 1e-6 * abs(found).max(), abs(found - sums).max()
    folder = os.environ.get("TACTNET_ONNXRUNTIME")
    if folder and pathlib.Path(folder, "node_modules/onnxruntime-node").is_dir():
        runtime = numpy.array(Oracle(folder).outputs(data, [f[None, None] for f in frames], network._imported.graph.output)).reshape(found.shape)
        apart = abs(found - runtime)[abs(runtime) < 127 * scales[2]]
        print(f"{apart.size} outputs, at most {apart.max() / scales[2]:.3f} of a step from those of the runtime")
        assert apart.max() <= scales[2] / 2 * (1 + 1e-5)
    network._imported = tactnet.onnx.read(operator_models.quantised(2.0)[0])
    message(tactnet.onnx.CannotImport, lambda: network.deploy(bits=8), "scale and zero point (2.0, 0)", "nearest")
    network._imported = None
    message(ValueError, lambda: network.deploy(bits=8), "training images")


def types(_):
    """mypy finds no mistake in the package, and mistakes of those who use it; the stub has what the module has."""
    try:
        from mypy import api, stubtest
    except ImportError:
        sys.exit(77)
    os.environ["MYPYPATH"] = str(build.PACKAGE.parent)
    found = api.run(["--ignore-missing-imports", "--no-incremental", "-p", "tactnet"])
    assert found[2] == 0, found
    pathlib.Path("use.py").write_text("""import tactnet
from tactnet.layers import Dense
network = tactnet.Network((2, 3), [Dense(2), "relu"])
name: int = network.deploy().classify([1])
tactnet.decode("frames.npy").frames.shape.x
tactnet.Sensor((2, 3)).update([1], 2)
tactnet.Evidence("2").add([1.0])
""")
    wrong = {int(line.split(":")[1]) for line in api.run(["--ignore-missing-imports", "--no-incremental", "use.py"])[0].splitlines() if ": error:" in line}
    assert wrong == {3, 4, 5, 6, 7}, wrong
    output = io.StringIO()
    with contextlib.redirect_stdout(output):
        stubtest.test_stubs(stubtest.parse_options(["--concise", "tactnet._core"]))
    missing = [line for line in output.getvalue().splitlines() if " present " in line and not re.search(r"_core\.(Recipe\.|input |augmentation )", line)]
    assert not missing, missing


def folds(program):
    """`tactnet evaluate` and cross_val_score give each fold of whole groups the same accuracy."""
    frames, labels = touches(72, 3, 14, 25)
    frames[::5] = frames[::5, ::-1] // 2
    order, people = numpy.argsort(labels, kind="stable"), numpy.arange(72) // 12
    for i in order:
        folder = pathlib.Path(f"data/class_{labels[i]}")
        folder.mkdir(parents=True, exist_ok=True)
        numpy.save(folder / f"person{people[i]}_{i:02}.npy", frames[i])
    subprocess.run([program, "evaluate", "--data", "data", "--method", "tactnet4", "--sizes", "14x25", "--group", r"person(\d+)", "--split", "group-folds", "--folds",
                    "3", "--epochs", "9", "--augmentation", "none", "--validation", "0", "--jobs", "1"], check=True, capture_output=True)
    expected = {int(line["settings"]["seed"]): line["accuracy"] for line in map(json.loads, open("results/evaluation.jsonl"))}
    X, y, found = frames[order], labels[order], {}
    for seed, split in enumerate(sklearn.model_selection.GroupKFold(3).split(X, y, people[order])):
        own = tactnet.Classifier("tactnet4", outputs=22, epochs=9, validation=0, settings={"augmentation": "none"}, seed=seed)
        found[seed] = sklearn.model_selection.cross_val_score(own, X, y, cv=[split])[0]
    assert found == expected and len(set(found.values())) > 1, (found, expected)


def auto(program):
    """augmentation="auto" chooses as `tactnet train`, and trains with that; fewer frames get more epochs."""
    random, labels, people = numpy.random.default_rng(5), numpy.repeat(range(3), 48), numpy.tile(numpy.arange(48) // 8, 3)
    frames = random.integers(0, 12, (144, 14, 25)).astype(numpy.uint8)
    for frame, label, row in zip(frames, labels, random.integers(2, 5, 144)):  # left and right are each other's reflection, below is empty
        frame[row:row + 4, (2, 10, 19)[label]:(6, 15, 23)[label]] += 150
    names = ["left", "middle", "right"]
    for i in range(144):
        folder = pathlib.Path(f"data/{names[labels[i]]}")
        folder.mkdir(parents=True, exist_ok=True)
        numpy.save(folder / f"person{people[i]}_{i:03}.npy", frames[i])
    run = subprocess.run([program, "train", "--data", "data", "--method", "tactnet4", "--rows", "14", "--columns", "25", "--group", r"person(\d+)", "--split",
                          "grouped", "--validation", "0", "--test", "0", "--epochs", "40", "--seed", "3", "--output", "trained.safetensors"], check=True, capture_output=True, text=True)
    expected = tactnet.Network.named("tactnet4", (14, 25), 22).load("trained.safetensors")
    network = tactnet.Network.named("tactnet4", (14, 25), 22)
    network.fit(frames, labels, names, seed=3, groups=people, epochs=40, augmentation="auto")
    chosen, said = network.chosen, re.findall("augmentation: (.*)", run.stdout + run.stderr)
    assert said == chosen.reasons and said, (said, chosen.reasons)
    assert chosen.reflections[1] == [2, 1, 0] and chosen.trials and chosen.recipe.reflect_columns == 0.5, chosen.reasons
    assert (chosen.function == "root") == any(what == "with the square root of counts" and adopted for what, _, _, adopted in chosen.trials)
    assert network.temperature == expected.temperature == 1 and (network.deploy().predict(frames) == expected.deploy().predict(frames)).all()
    assert abs(network.weights["conv1.weight"] - expected.weights["conv1.weight"]).max() < 0.01  # instruction sets round differently
    network.fit(frames, labels, names, seed=3, epochs=4, augmentation="auto", reflect_rows=0.25, reflect_columns=0)
    assert not network.chosen.trials and network.chosen.recipe.reflect_rows == 0.25 and network.chosen.reflections == ([], None)
    assert network.fit(frames, labels, epochs=1).chosen is None
    message(ValueError, lambda: network.fit(frames, labels, augmentation="auto", groups=people[1:]), "a group for each of 144 frames, found 143")
    message(ValueError, lambda: network.fit(frames, labels * 10**7, names, augmentation="auto", groups=people), "labels below 3, found 10000000")
    own = tactnet.Classifier("tactnet4", outputs=22, epochs=2, augmentation="auto").fit(frames, labels, groups=people)
    assert own.network_.chosen.reflections[1] == [2, 1, 0]
    epochs = {(name, count): build.core().Recipe(name, 14, 25, count).epochs for name in ("default", "features") for count in (0, 88, 400)}
    assert list(epochs.values()) == [440, 1760, 440, 30, 30, 30], epochs
    # A file of a network that compresses counts: the program's, and this one's.
    subprocess.run([program, "train", "--data", "data", "--method", "tactnet4", "--rows", "14", "--columns", "25", "--augmentation", "none", "--test", "0",
                    "--epochs", "1", "--input-function", "log", "--self-test", "5", "--output", "log.safetensors"], check=True, capture_output=True)
    network.load("log.safetensors").save("again.safetensors", frames[:5])
    deployed, eight = network.deploy(), network.deploy(bits=8, images=frames)
    for data in (network.to_bytes(), eight._own.file("tactnet4", frames[:0])):
        assert b'"input_function":"log"' in data and b'"input_knee":"8"' in data
    again = pickle.loads(pickle.dumps(network)).load("again.safetensors").deploy()
    scores = deployed.scores(frames)
    assert (again.scores(frames) == scores).all() and abs(eight.scores(frames) - scores).max() < 0.05 * abs(scores).max()


def estimator(_):
    """scikit-learn's own checks, on rows of numbers: frames of one row. Each number of features and classes is compiled."""
    from sklearn.utils.estimator_checks import check_estimator
    warnings.simplefilter("ignore")
    for own, check in check_estimator(tactnet.Classifier([], epochs=60, rate=0.1, validation=0), generate_only=True):
        try:
            check(own)
        except unittest.SkipTest as skipped:  # of pandas, where it is missing
            print(skipped)


def page(_):
    """The blocks of docs/train/python.md, one after the other, print what follows them."""
    printed, names = None, {}
    text = pathlib.Path(__file__).parents[2].joinpath("docs/train/python.md").read_text()
    for language, block in re.findall(r"^```(python|text)\n(.*?)^```", text, re.M | re.S):
        if language == "python":
            output = io.StringIO()
            with contextlib.redirect_stdout(output):
                exec(block, names)
            printed = output.getvalue()
        else:
            assert printed == block, f"expected {block}, found {printed}"


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as here:
        os.chdir(here)
        globals()[sys.argv[1]](sys.argv[2] if len(sys.argv) > 2 else None)
        os.chdir("/")
