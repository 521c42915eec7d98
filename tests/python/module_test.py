"""The Python package: python3 module_test.py CHECK [PROGRAM], where PROGRAM is scores.cpp compiled."""

import concurrent.futures
import contextlib
import doctest
import importlib
import io
import os
import pathlib
import pickle
import re
import subprocess
import sys
import tempfile
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
    expected = numpy.array([float.fromhex(line) for line in run.stdout.split()], numpy.float32).reshape(2, 60, 5)
    for deployed, outputs in zip((single, eight), expected):
        assert (deployed.scores(frames, threads=2) == outputs).all()
        for form in (frames[7], frames[7].astype(numpy.float32), frames.astype(numpy.int64)[7], numpy.asfortranarray(frames[7]), frames[7].ravel()):
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
    assert single.classify(numpy.full((14, 25), numpy.nan)) is None
    message(ValueError, lambda: single.scores(numpy.full((2, 14, 25), [[[1]], [[numpy.inf]]])), "frame 1")
    message(ValueError, lambda: single.scores(frames[:, :5]), "14 x 25", "(60, 5, 25)")
    message(tactnet.FileError, lambda: network.load("scores_8.safetensors"), "scores_8.safetensors", "single precision")
    message(ValueError, lambda: network.fit(frames, labels + 3), "images: expected labels below 5, found 5")
    for wrong, *parts in ((dict(labels=labels + 0.7), "float64"), (dict(labels=labels - 1), "from -1 on"), (dict(labels=labels[:, None]), "(60, 1)"),
                          (dict(frames=frames + 1j), "complex128"), (dict(frames=frames.astype(str)), "real numbers"), (dict(validation=[1.7]), "mask", "float64"),
                          (dict(validation=[-1]), "from -1 on"), (dict(classes=list("aabcd")), "each once"), (dict(classes=["a", "b\n", "c", "d", "e"]), "each once"),
                          (dict(classes=list("abcd") + [""]), "''"), (dict(epoch=3), "'epoch'"),
                          (dict(rate=-1.0), "finite rate"), (dict(translation=numpy.nan), "finite translation"), (dict(rotation=numpy.inf), "finite rotation")):
        message(ValueError, lambda: network.fit(**{"frames": frames, "labels": labels, **wrong}), *parts)
    mask = numpy.arange(60) % 7 == 0
    assert tactnet.Network.named("tactnet4", (14, 25), 5).fit(frames, labels, epochs=2, validation=mask).to_bytes() == network.to_bytes()
    for path in ("/dev/full", "."):
        message(OSError, lambda: network.save(path), "expected a file")
    message(tactnet.TrainingDiverged, lambda: network.fit(frames, labels, rate=1e30), "lower the learning rate")


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
    for name in ("tactnet", "tactnet.layers", "tactnet.network", "tactnet.classifier", "tactnet.build"):
        assert not doctest.testmod(importlib.import_module(name)).failed, name
    undocumented = [name for name, each in vars(tactnet.layers).items() if name[0].isupper() and callable(each) and not each.__doc__]
    assert not undocumented, undocumented


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
