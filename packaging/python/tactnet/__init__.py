"""tactnet in Python: networks that recognise touched objects from pressure images, at any size (docs/train/python.md).

>>> from tactnet import Network
>>> from tactnet.layers import Conv2d, Dense, MaxPool, ReLU
>>> Network((14, 25), [Conv2d(8, 3), ReLU(), MaxPool(2), Dense(5)])
network<shape{14, 25}, conv2d<8, 3>, relu, max_pool<2>, dense<5>>
"""

from typing import TYPE_CHECKING

from .build import CompilationFailed, CompilerNotFound
from .network import Deployed, Network
from .objects import ClassMeans, Discriminant, fit_discriminant
from .sensing import Decoder, Scene, Sensor, decode

if TYPE_CHECKING:
    from ._core import (AugmentationChoice, Evidence, FileError, GainMonitor, PredictionSet, Recording, Stream, TrainingDiverged,
                        fit_largest_distance, force_statistics)
    from .classifier import Classifier

__all__ = ["AugmentationChoice", "ClassMeans", "Classifier", "CompilationFailed", "CompilerNotFound", "Decoder", "Deployed", "Discriminant", "Evidence",
           "FileError", "GainMonitor", "Network", "PredictionSet", "Recording", "Scene", "Sensor", "Stream", "TrainingDiverged", "decode",
           "fit_discriminant", "fit_largest_distance", "force_statistics"]


def __getattr__(name):
    # scikit-learn is imported, and the module of C++ compiled, only by those who use them.
    if name == "Classifier":
        from .classifier import Classifier
        return Classifier
    if name in __all__:
        from . import build
        return getattr(build.core(), name)
    raise AttributeError(f"module 'tactnet' has no attribute {name!r}")
