"""Networks of any layers at any size, compiled at first use."""

from __future__ import annotations

import concurrent.futures
import math
import os
import re
from typing import TYPE_CHECKING, Any, Iterable, List, Optional, Sequence, Set

import numpy

from . import build
from .files import write_safely
from .layers import Layer, whole

if TYPE_CHECKING:
    from . import _core


class Network:
    """A list of layers bound to a size: `Network((20, 35), [Conv2d(8, 5), BatchNorm(), ReLU(), MaxPool(2), Dense(22)])`.

    `size` is (rows, columns) or (rows, columns, channels); of a network of sequences it is (frames, 1, features). A network of
    the library by its name: `Network.named("tactnet6", (28, 50), 22)`. Nothing is compiled before it is needed. Layers that do
    not fit each other are a ValueError with the library's sentence and the numbers. Costs are attributes: `parameters`, `statistics` (of
    batch norms), `multiply_adds` of one frame, `multiply_adds_on_pixels` (without taps on padding), `activation_bytes` (the most at
    once, layer by layer); and `input_shape`, `output_shape` (rows, columns, channels).
    """

    def __init__(self, size: Sequence[int], layers: Iterable[Layer], name: str = "custom"):
        layers = list(layers)
        if not layers or not all(isinstance(layer, Layer) for layer in layers):
            raise TypeError(f"expected layers of tactnet.layers, found {layers!r}")
        self._bind(f"network<{_shape(size)}, {', '.join(layer.text for layer in layers)}>", name)

    @classmethod
    def named(cls, name: str, size: Sequence[int], classes: int) -> "Network":
        """One of the library's networks: tactnet4, tactnet4_3x3, tactnet4_strided, tactnet6, tactnet6_economical, tactnet6_symmetric, tactresnet."""
        own = name.replace("-", "_")
        if own not in NAMES:
            raise ValueError(f"network: expected one of {', '.join(NAMES)}, found {name!r}")
        return cls._of_type(f"{own}<{_shape(size)}, {whole(classes)}>", own.replace("_", "-"))

    @classmethod
    def from_onnx(cls, path, **options) -> "Network":
        """Imports an ONNX model with its weights (docs/train/onnx.md); options as `tactnet.onnx.read`. Needs the package onnx."""
        from . import onnx
        imported = onnx.read(path, **options)
        if not isinstance(imported, onnx.Network):
            raise onnx.CannotImport("it is a support vector machine, which tactnet_machine.hpp loads; the nearest: a network")
        network = cls._of_type(f"network<{_shape(imported.shape)}, {', '.join(map(str, imported.layers))}>", imported.name)
        network._imported = imported if imported.rounding else None
        return network.load_bytes(onnx.write.weights(imported), os.fspath(path) if not isinstance(path, bytes) else "ONNX")

    @classmethod
    def _of_type(cls, text: str, name: str) -> "Network":
        network = cls.__new__(cls)
        network._bind(text, name)
        return network

    def _bind(self, text: str, name: str) -> None:
        self.type, self.name = text, name
        self._code: Any = None
        self._parts: Set[str] = set()
        self._model: Optional[_core.Model] = None
        self.chosen: Optional[_core.AugmentationChoice] = None  # by the last fit with augmentation="auto"
        self._imported: Any = None  # of a quantised model of ONNX

    def __repr__(self) -> str:
        return self.type

    # What is compiled.

    def compile(self, *parts: str) -> _core.Code:
        """Compiles parts now, side by side: "described", "deployed", "trainable", "eight_bit", "stream". By default the first three."""
        missing = [part for part in parts or build.PARTS[:3] if part not in self._parts]
        core = build.core()
        if missing:
            with concurrent.futures.ThreadPoolExecutor(len(missing)) as pool:
                paths = list(pool.map(lambda part: build.part_path(self.type, part), missing))
            self._code = self._code or core.Code()
            for part, path in zip(missing, paths):
                self._code.add(str(path))
                self._parts.add(part)
        return self._code

    def __getattr__(self, name: str):
        if name in CONSTANTS:
            return getattr(self._code or self.compile("described"), name)
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    @property
    def outputs(self) -> int:
        return int(numpy.prod(self.output_shape))

    # Its numbers.

    @property
    def trained(self) -> bool:
        return self._model is not None

    def _trained(self) -> _core.Model:
        if self._model is None:
            raise ValueError("expected a trained network, found one without weights: call fit or load first")
        return self._model

    @property
    def classes(self) -> List[str]:
        """Names of the first outputs."""
        return self._trained().classes

    @property
    def temperature(self) -> float:
        """What logits are divided by for probabilities."""
        return self._trained().temperature

    @property
    def weights(self) -> dict:
        """Copies of all arrays by PyTorch's names."""
        return self._trained().arrays

    def fit(self, frames, labels, classes: Optional[Sequence[str]] = None, validation=(), recipe: str = "default", seed: int = 0,
            threads: int = 1, start: Optional["Network"] = None, report=None, groups=None, **settings) -> "Network":
        """Trains on frames (n, rows, columns) or (n, channels, rows, columns).

        uint8 are counts: they are varied and normalised as the recipe says. Floats enter the network as they are.
        `labels` are indices of classes; `validation` are indices of frames that are not learnt from, but choose the epoch and
        the temperature. `recipe` is "default", "thorough" or "features"; `settings` replace its own, such as epochs=20, rate=0.01,
        batch=64, translation=2, augmentation="none". Without epochs=, fewer than 352 training frames get more. The same seed gives
        the same bits on any number of threads.

        augmentation="auto" finds out which reflections and movements suit the task, as the program does, from frames of uint8; then
        `chosen` has what was chosen, and why. `groups` (n,), the person, object or recording of each frame, make the choice surer.
        `report(epoch, epochs, loss, accuracy)` is called after each epoch.
        """
        frames, labels, chosen = numpy.asarray(frames), numpy.asarray(labels), numpy.asarray(validation)
        if labels.shape != (len(frames),) or labels.dtype.kind not in "iub" or (labels < 0).any():
            raise ValueError(f"expected a label for each of {len(frames)} frames, a whole number from 0 on, found {_what(labels)}")
        if frames.dtype.kind not in "iubfO":
            raise ValueError(f"expected frames of real numbers, found {_what(frames)}")
        names = [f"class_{i:02}" for i in range(self.outputs)] if classes is None else [str(name) for name in classes]
        if len(set(names)) < len(names) or any(not name or re.search(r"[\x00-\x1f\x7f-\x9f\ud800-\udfff]", name) for name in names):
            raise ValueError(f"classes: expected names without control characters, each once, found {names!r:.200}")
        if chosen.size and (chosen.dtype.kind not in "iub" or (chosen < 0).any()):
            raise ValueError(f"validation: expected indices of frames, or a mask, found {_what(chosen)}")
        kept = numpy.zeros(len(frames), bool)
        kept[chosen if chosen.size else []] = True
        code, core, training = self.compile("trainable"), build.core(), numpy.flatnonzero(~kept)
        own = core.Recipe(recipe, *code.input_shape[:2], len(training))
        for name, value in settings.items():
            if not hasattr(own, name):
                settable = ", ".join(each for each in dir(own) if not each.startswith("_"))
                raise ValueError(f"recipe: expected the name of a setting ({settable}), found {name!r}")
            if isinstance(value, (int, float, numpy.number)) and not 0 <= value < math.inf:
                raise ValueError(f"recipe: expected a finite {name} of 0 or more, found {value!r}")
            words = getattr(core, name).__members__ if name in ("input", "augmentation") else None
            if words is not None and value not in words and (name, value) != ("augmentation", "auto"):
                raise ValueError(f"recipe: expected {name} of {', '.join(words)}{', auto' * (name == 'augmentation')}, found {value!r}")
            if (name, value) != ("augmentation", "auto"):
                setattr(own, name, value if words is None else words[value])
        self.chosen = None
        if settings.get("augmentation") == "auto":
            of_each = () if groups is None else group_indices(groups, len(frames))[1]
            fixed = ("reflect_rows" in settings, "reflect_columns" in settings, bool({"translation", "rotation", "scale"} & settings.keys()))
            choice = core.choose(code, frames, labels, names, training, of_each, own, seed, threads, *fixed)
            self.chosen, own = choice, choice.recipe
        self._model = core.train(code, frames, labels, names, training, numpy.flatnonzero(kept), own, seed, threads,
                                 start and start._trained(), report or (lambda *_: None))
        return self

    def load(self, path) -> "Network":
        """Reads a weight file and runs its self-test. tactnet.FileError says what does not fit."""
        with open(path, "rb") as file:
            return self.load_bytes(file.read(), os.fspath(path))

    def load_bytes(self, data: bytes, name: str = "weights") -> "Network":
        """Reads the bytes of a weight file; `name` is what messages call it."""
        code = self.compile(self._selftest_part())
        self._model = build.core().Model.load(code, data, name)
        return self

    def save(self, path, selftest=None) -> None:
        """Writes the weights, all or nothing; `selftest` are some frames of uint8 that loading computes again."""
        write_safely(os.fspath(path), self.to_bytes(selftest))

    def _selftest_part(self) -> str:
        """What computes logits: deployed networks give probabilities after a softmax, and those of sequences take one frame at a time."""
        return "trainable" if re.search(r"\bsoftmax>$|\b(gru|lstm|causal_conv1d|last_frame)\b", self.type) else "deployed"

    def to_bytes(self, selftest=None) -> bytes:
        """The bytes of a weight file."""
        if selftest is not None:
            self.compile(self._selftest_part())
        return self._trained().file(self.name, _counts(selftest))

    def __getstate__(self) -> dict:
        return {"type": self.type, "name": self.name, "weights": self.to_bytes() if self.trained else None}

    def __setstate__(self, state: dict) -> None:
        self._bind(state["type"], state["name"])
        if state["weights"] is not None:
            self.load_bytes(state["weights"])

    # To use it.

    def deploy(self, bits: int = 32, images=None) -> "Deployed":
        """The network in its fastest form; in 8 bits its ranges are found from training images (n, rows, columns), best of uint8. Those of a quantised
        model of ONNX are in the model: without images they are used."""
        model = self._trained()
        if bits == 8:
            if images is None and self._imported is None:
                raise ValueError("expected training images, which set the ranges of 8 bits, found none")
            code = self.compile("eight_bit")
            if images is None:
                from .onnx.operators.quantised import eight_bit_steps
                return Deployed(build.core().deploy_steps(code, eight_bit_steps(self._imported), model.classes), self.name)
            return Deployed(model.deploy_in_8_bits(numpy.asarray(images)), self.name)
        if bits != 32:
            raise ValueError(f"expected 32 or 8 bits, found {bits}")
        self.compile("deployed")
        return Deployed(model.deploy(), self.name)

    def load_deployed(self, path) -> "Deployed":
        """Reads a file in 8 bits, which `Deployed.save` or the program wrote."""
        with open(path, "rb") as file:
            return Deployed(build.core().load_8_bits(self.compile("eight_bit"), file.read(), os.fspath(path)), self.name)

    def stream(self, bits: int = 32, sequences=None) -> _core.Stream:
        """A network of sequences, frame by frame. In 8 bits its ranges are found from training sequences (n, features, frames)."""
        model = self._trained()
        self.compile("stream")
        frames, _, features = self.input_shape
        if bits == 8:
            if numpy.shape(sequences)[1:] not in ((features, frames), (features, frames, 1)):
                raise ValueError(f"expected training sequences (n, {features}, {frames}), found shape {numpy.shape(sequences)}")
            return model.stream_in_8_bits(numpy.ascontiguousarray(sequences, numpy.float32))
        if bits != 32:
            raise ValueError(f"expected 32 or 8 bits, found {bits}")
        return model.stream()


class Deployed:
    """A network in its fastest form; any number of threads may call it.

    Frames are (rows, columns) or (channels, rows, columns) of uint8 or float32 counts, one or n after the other, and are read
    without a copy if they are contiguous. NaN, infinity and numbers beyond single precision are a ValueError.
    """

    def __init__(self, own: _core.Deployed, name: str):
        self._own, self.name = own, name
        self.scores, self.predict_proba, self.classify, self.features = own.scores, own.predict_proba, own.classify, own.features
        self.classes, self.temperature, self.bits = own.classes, own.temperature, own.bits
        self.weight_bytes, self.workspace_bytes = own.weight_bytes, own.workspace_bytes

    def predict(self, frames, threads: int = 1):
        """The name of the most likely class, or an array of names."""
        found = numpy.asarray(self.classes)[self.scores(frames, threads)[..., :len(self.classes)].argmax(-1)]
        return found if found.ndim else str(found)

    def export_header(self, path, namespace: str, frame) -> None:
        """Writes a C++ header with the network and a self-test of `frame` (rows, columns) of uint8."""
        write_safely(os.fspath(path), self._own.header(self.name, namespace, _counts(frame)).encode())

    def save(self, path, selftest=None) -> None:
        """Writes a network in 8 bits. Of one in single precision, save the Network."""
        if self.bits != 8:
            raise ValueError("expected a network in 8 bits, found one in single precision: Network.save writes its weights")
        write_safely(os.fspath(path), self._own.file(self.name, _counts(selftest)))


CONSTANTS = ("input_shape", "output_shape", "parameters", "statistics", "multiply_adds", "multiply_adds_on_pixels", "activation_bytes",
             "ends_in_softmax", "needs_counts")
NAMES = ("tactnet4", "tactnet4_3x3", "tactnet4_strided", "tactnet6", "tactnet6_economical", "tactnet6_symmetric", "tactresnet")


def _shape(size: Sequence[int]) -> str:
    extents = [whole(n) for n in size]
    if len(extents) not in (2, 3):
        raise ValueError(f"expected a size (rows, columns) or (rows, columns, channels), found {size!r}")
    if math.prod(extents) > 2 ** 30:
        raise ValueError(f"expected a size of at most 2^30 numbers, found {size!r}")
    return f"shape{{{', '.join(map(str, extents[:2] if extents[2:] in ([], [1]) else extents))}}}"


def group_indices(groups, count: int):
    """The names of groups, and the index of each frame's."""
    names, of_each = numpy.unique(numpy.ravel(groups), return_inverse=True)
    if len(of_each) != count:
        raise ValueError(f"expected a group for each of {count} frames, found {len(of_each)}")
    return names, of_each


def _what(array) -> str:
    return f"{array.dtype} of shape {array.shape}" + (f" from {array.min()} on" if array.size and array.dtype.kind in "iu" else "")


def _counts(frames):
    if frames is None:
        return numpy.zeros(0, numpy.uint8)
    frames = numpy.ascontiguousarray(frames)
    if frames.dtype != numpy.uint8:
        raise ValueError(f"expected counts of uint8, found {frames.dtype}")
    return frames
