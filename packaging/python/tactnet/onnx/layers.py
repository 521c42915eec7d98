"""Layers of the library: how they read in a header, what their arrays are called, what they cost and compute."""

import math
from dataclasses import dataclass, field
from typing import Callable, Optional

import numpy

from ..spelling import call, extent  # noqa: F401 what operators spell layers with


@dataclass
class Map:
    """What a tensor of ONNX is in the library: a map of `shape` (rows, columns, channels), and for each element of the
    tensor its place in that map, channel by channel and row by row. Reshapes and transposes change the places only."""
    shape: tuple
    places: numpy.ndarray

    @classmethod
    def plain(cls, shape, extents):
        return cls(tuple(shape), numpy.arange(math.prod(shape)).reshape(extents))

    @property
    def area(self):
        return self.shape[0] * self.shape[1]

    @property
    def size(self):
        return math.prod(self.shape)

    def is_plain(self):
        """Whether the tensor holds the whole map, channel by channel and row by row."""
        return numpy.array_equal(self.places.ravel(), numpy.arange(self.size))

    def is_image(self):
        """Whether it is a tensor of ONNX's form [1, channels, rows, columns], or [1, channels, rows] of one column."""
        rows, columns, channels = self.shape
        extents = self.places.shape
        return self.is_plain() and (extents == (1, channels, rows, columns) or (columns == 1 and extents == (1, channels, rows)))

    def in_order(self, values):
        """Values that broadcast to the tensor, in the order of the map; None for values of another shape."""
        try:
            values = numpy.broadcast_to(values, self.places.shape)
        except ValueError:
            return None
        result = numpy.zeros(self.size)
        result[self.places.ravel()] = values.ravel()
        return result


@dataclass
class Layer:
    """A layer bound to its input. `run(x, arrays)` computes a map [channels, rows, columns] in double precision."""
    kind: str  # its name in weight files
    text: str
    output: tuple  # rows, columns, channels
    run: Callable
    arrays: dict = field(default_factory=dict)
    multiply_adds: int = 0
    numbered: bool = True
    branches: list = field(default_factory=list)  # (beginning of names, layers)
    write: Optional[Callable] = None  # the text, where it depends on arrays or branches
    epsilon: Optional[float] = None  # of a norm
    filter_axis: Optional[int] = None  # of weights with a bias, which an affine layer after them becomes part of
    rounding: Optional[tuple] = None  # scale and zero point of its output in a quantised model
    weight_scales: Optional[numpy.ndarray] = None  # of each filter

    def __call__(self, x):
        return self.run(x, self.arrays)

    def __str__(self):
        return self.write(self) if self.write else self.text


def run_all(layers, x):
    for layer in layers:
        x = layer(x)
    return x


def named_arrays(layers, prefix=""):
    """(name, array) of a list, as tactnet numbers them: by kind, and from 1."""
    kinds = [layer.kind for layer in layers]
    found = []
    for i, layer in enumerate(layers):
        number = str(kinds[:i].count(layer.kind) + 1) if layer.numbered or kinds.count(layer.kind) > 1 else ""
        own = f"{prefix}{layer.kind}{number}."
        found += [(own + name, array) for name, array in layer.arrays.items()]
        for beginning, inner in layer.branches:
            found += named_arrays(inner, own + beginning)
    return found


def all_layers(layers):
    for layer in layers:
        yield layer
        for _, inner in layer.branches:
            yield from all_layers(inner)


def texts(layers):
    return [str(layer) for layer in layers]


def as_branch(layers):
    """A list as one template argument."""
    if not layers:
        return "identity_layer"
    return str(layers[0]) if len(layers) == 1 else f"sequence<{', '.join(texts(layers))}>"
