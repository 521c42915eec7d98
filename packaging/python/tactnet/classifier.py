"""A network as an estimator of scikit-learn."""

from __future__ import annotations

from typing import Optional, Union

import numpy
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.multiclass import check_classification_targets, unique_labels
from sklearn.utils.validation import check_is_fitted

from . import build, layers
from .network import Network, group_indices


class Classifier(ClassifierMixin, BaseEstimator):
    """Recognises frames by one of the library's networks or a list of layers, at the size of the frames.

    Parameters
    ----------
    network : a name such as "tactnet6" (see Network.named), or a list of layers without the last dense one.
    rows, columns : the size of a frame, if X has a row of numbers for each; otherwise that of X. Without rows, a row of numbers is a
        frame of one row.
    outputs : of the network, if more than classes, so that another number of classes needs no other network; by default one per class.
    recipe : "default", "thorough" or "features" (docs/train/training.md).
    epochs, rate, augmentation : replace those of the recipe; `settings`, a dict, replaces others. augmentation="auto" finds out which
        reflections and movements suit the task: `network_.chosen` says which, and why.
    validation : the share of the frames that choose the best epoch and the temperature of probabilities: whole groups if `groups`
        are given; 0 for none.
    blocked : without groups, whether frames after each other stay together.
    seed, threads : the same seed gives the same bits on any number of threads.
    verbose : prints each epoch.

    X is (n, rows, columns), (n, channels, rows, columns) or (n, numbers): uint8 counts, which are varied and normalised as the recipe
    says, or floats, which enter the network as they are.
    """

    def __init__(self, network: Union[str, list] = "tactnet6", rows: Optional[int] = None, columns: Optional[int] = None,
                 outputs: Optional[int] = None, recipe: str = "default", epochs: Optional[int] = None, rate: Optional[float] = None,
                 settings: Optional[dict] = None, validation: float = 0.16, blocked: bool = False, seed: int = 0, threads: int = 1,
                 verbose: bool = False, augmentation: Optional[str] = None):
        self.network, self.rows, self.columns, self.outputs = network, rows, columns, outputs
        self.recipe, self.epochs, self.rate, self.settings, self.augmentation = recipe, epochs, rate, settings, augmentation
        self.validation, self.blocked, self.seed, self.threads, self.verbose = validation, blocked, seed, threads, verbose

    def fit(self, X, y, groups=None, validation_indices=None) -> "Classifier":
        """Trains. `groups` has the person, object or recording of each frame; `validation_indices` replaces the share `validation`."""
        X, y = self._validate_data(X, y, dtype=None, allow_nd=True, force_all_finite=True)
        X, shape = self._frames(X)
        check_classification_targets(y)
        self.classes_ = unique_labels(y)
        if len(self.classes_) < 2:
            raise ValueError("Classifier can't train when only one class is present.")
        labels = numpy.searchsorted(self.classes_, y)
        outputs = self.outputs or len(self.classes_)
        if isinstance(self.network, str):
            self.network_ = Network.named(self.network, shape, outputs)
        else:
            self.network_ = Network(shape, [*self.network, layers.Dense(outputs)])
        own = ("epochs", self.epochs), ("rate", self.rate), ("augmentation", self.augmentation)
        settings: dict = {**{name: value for name, value in own if value is not None}, **(self.settings or {})}
        held_out = self._held_out(labels, groups) if validation_indices is None else validation_indices
        self.history_: list = []
        self.network_.compile("trainable", "deployed")
        self.network_.fit(X, labels, [str(c) for c in self.classes_], held_out, self.recipe, self.seed, self.threads, report=self._report,
                          groups=groups, **settings)
        self.deployed_ = self.network_.deploy()
        return self

    def predict(self, X):
        """The class of each frame."""
        scores = self.decision_function(X)
        return self.classes_[scores.argmax(1) if scores.ndim > 1 else (scores > 0).astype(int)]

    def predict_proba(self, X):
        """The probability of each class, (n, classes)."""
        check_is_fitted(self)
        return self.deployed_.predict_proba(self._seen(X), self.threads)

    def decision_function(self, X):
        """Logits, (n, classes); of two classes, as scikit-learn expects, their difference (n,)."""
        check_is_fitted(self)
        scores = self.deployed_.scores(self._seen(X), self.threads)[:, :len(self.classes_)]
        return scores[:, 1] - scores[:, 0] if len(self.classes_) == 2 else scores

    def _seen(self, X):
        return self._frames(self._validate_data(X, dtype=None, allow_nd=True, reset=False, force_all_finite=True))[0]

    def _frames(self, X):
        """Frames in the order of the network, and their size."""
        if X.dtype.kind not in "biuf":
            X = X.astype(numpy.float64)
            if not numpy.isfinite(X).all():
                raise ValueError("Input contains NaN or infinity.")
        if X.ndim == 2:
            rows = self.rows or 1
            columns = self.columns or X.shape[1] // rows
            if rows * columns != X.shape[1]:
                raise ValueError(f"expected frames of {rows} x {columns} numbers, found rows of {X.shape[1]}")
            X = X.reshape(len(X), rows, columns)
        if X.ndim not in (3, 4):
            raise ValueError(f"expected X of shape (n, rows, columns), (n, channels, rows, columns) or (n, numbers), found {X.shape}")
        size = (*X.shape[-2:], *X.shape[1:-2])
        if (self.rows or size[0], self.columns or size[1]) != size[:2]:
            raise ValueError(f"expected frames of {self.rows} x {self.columns}, found {size[0]} x {size[1]}")
        return numpy.ascontiguousarray(X, numpy.uint8 if X.dtype == numpy.uint8 else numpy.float32), size

    def _held_out(self, labels, groups):
        """Indices of frames to validate with."""
        if self.validation <= 0:
            return []
        if groups is None:
            return build.core().split(labels, len(self.classes_), self.blocked, self.seed, self.validation, 0.0)[1]
        names, of_each = group_indices(groups, len(labels))
        order = numpy.random.default_rng(self.seed).permutation(len(names))
        chosen = order[:max(1, round(self.validation * len(names)))] if len(names) > 1 else []
        return numpy.flatnonzero(numpy.isin(of_each, chosen))

    def _report(self, epoch, epochs, loss, accuracy):
        self.history_.append((loss, accuracy))
        if self.verbose:
            print(f"epoch {epoch} of {epochs}: loss {loss:.4f}, validation accuracy {100 * accuracy:.2f} %")

    def __getstate__(self):
        state = {**super().__getstate__()}
        state.pop("deployed_", None)
        return state

    def __setstate__(self, state):
        super().__setstate__(state)
        if "network_" in self.__dict__ and self.network_.trained:
            self.deployed_ = self.network_.deploy()

    def _more_tags(self):
        return {"X_types": ["2darray", "3darray"], "non_deterministic": False, "poor_score": False}
