"""Known and unknown objects, by the features of a network (docs/recognise/decision.md)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy

from . import build
from .layers import whole
from .sensing import _code

if TYPE_CHECKING:
    from . import _core


def Discriminant(features: int, dimensions: int) -> _core.Discriminant:
    """A map of `features` numbers to `dimensions`, all zeros: assign the `state` of another one."""
    return build.core().Discriminant(_code("object", f"discriminant<{whole(features)}, {whole(dimensions)}>"))


def fit_discriminant(features, labels, dimensions: int, classes: Optional[int] = None, shrinkage: float = 0.5) -> _core.Discriminant:
    """The map in which classes lie far apart and the touches of a class close together.

    `features` (n, features) are of `Deployed.features`, `labels` (n,) the indices of classes, of which each has a frame. `dimensions` are
    at most classes - 1. `shrinkage`, from above 0 to 1, makes up for few frames.
    """
    features, labels = numpy.asarray(features), numpy.asarray(labels)
    if features.ndim != 2 or labels.ndim != 1 or labels.dtype.kind not in "iub" or (labels < 0).any():
        raise ValueError(f"fit_discriminant: expected features (n, features) and labels from 0 on, found {features.shape} and {labels!r:.80}")
    found = Discriminant(features.shape[1], dimensions)
    found.fit(features, labels, int(labels.max()) + 1 if classes is None and labels.size else classes or 0, shrinkage)
    return found


def ClassMeans(dimensions: int, classes: int) -> _core.ClassMeans:
    """The means of at most `classes` classes of points of `dimensions`: the nearest one, new objects, unknown ones. For one thread at a time.

    >>> means = ClassMeans(2, 3)
    >>> means.learn([0, 0, 2], [[0, 1], [0, -1], [4, 0]])
    3
    >>> int(means.nearest([3, 0])["index"]), means.touches(0), means.spread(0)
    (2, 2, 1.0)
    """
    return build.core().ClassMeans(_code("object", f"class_means<{whole(dimensions)}, {whole(classes)}>"))
