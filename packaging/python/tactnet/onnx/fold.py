"""Affine layers become parts of their neighbours: biases, batch norms that are folded, means and scales of the input."""

import numpy

from .graph import CannotImport
from .operators.elementwise import affine
from .operators.norms import batch_norm
from .layers import Map, all_layers


class Folded:
    """A list of layers without affine ones, the normalisation of its input, and what was folded."""

    def __init__(self, layers, here, fold_norms=False, scale=1.0, mean=0.0):
        self.notes, self.fold_norms = [], fold_norms
        self.scale, self.mean = scale, numpy.full(here.size, mean, numpy.float64)
        layers = self._list(layers)
        if layers and layers[0].kind == "affine":
            own, shift = layers[0].arrays["scale"], layers[0].arrays["shift"]
            if (own == own[0]).all() and own[0] > 0:
                self.mean -= shift / (scale * own[0])
                self.scale *= float(own[0])
                layers = layers[1:]
                self.notes.append("the first nodes: the mean and the scale of the input")
        self.layers = self._norms(layers, here.shape)
        epsilons = {l.epsilon for l in all_layers(self.layers) if l.kind in ("gn", "in", "ln")}
        if len(epsilons) > 1:
            raise CannotImport(f"norms have different values of epsilon ({', '.join(f'{e:g}' for e in sorted(epsilons))}); the nearest "
                               "that can be imported: one for all norms but batch norms")
        self.epsilon = epsilons.pop() if epsilons else min((l.epsilon for l in all_layers(self.layers) if l.epsilon), default=1e-5)
        for layer in all_layers(self.layers):
            if layer.kind == "bn" and layer.epsilon != self.epsilon:
                # The same numbers with the network's epsilon.
                variance = layer.arrays["running_var"]
                arrays = dict(layer.arrays, weight=layer.arrays["weight"] * numpy.sqrt((variance + self.epsilon) / (variance + layer.epsilon)))
                layer.__dict__.update(batch_norm(Map.plain(layer.output, layer.output), arrays, self.epsilon).__dict__)

    def _list(self, layers):
        found = []
        for layer in layers:
            layer.branches = [(name, self._list(inner)) for name, inner in layer.branches]
            if layer.kind == "bn" and self.fold_norms:
                layer = self._affine_of(layer)
            if layer.kind != "affine":
                found.append(layer)
            elif found and self._merge(found[-1], layer):
                if found[-1].kind != "affine":
                    self.notes.append(f"{'a batch norm' if layer.text == 'batch_norm' else 'constants'} after {found[-1]}")
            else:
                found.append(layer)
        for i in reversed(range(len(found) - 1)):
            if found[i].kind == "affine" and found[i + 1].kind == "fc":  # numbers for each element before a dense layer
                if i > 0 or not (found[i].arrays["scale"] == found[i].arrays["scale"][0]).all():
                    weight = found[i + 1].arrays["weight"]
                    found[i + 1].arrays.update(bias=found[i + 1].arrays["bias"] + weight @ found[i].arrays["shift"],
                                               weight=weight * found[i].arrays["scale"])
                    self.notes.append(f"constants before {found[i + 1]}")
                    del found[i]
        return [l for l in found if l.kind != "affine" or (l.arrays["scale"] != 1).any() or l.arrays["shift"].any()]

    def _affine_of(self, norm):
        a = norm.arrays
        scale = a["weight"] / numpy.sqrt(a["running_var"] + norm.epsilon)
        area = norm.output[0] * norm.output[1]
        layer = affine(Map.plain(norm.output, norm.output), numpy.repeat(scale, area),
                       numpy.repeat(a["bias"] - a["running_mean"] * scale, area))
        layer.text = "batch_norm"
        return layer

    def _merge(self, layer, affine):
        """Makes `affine` a part of the layer before it if that can be."""
        scale, shift = affine.arrays["scale"], affine.arrays["shift"]
        if layer.kind == "affine":
            layer.arrays.update(scale=layer.arrays["scale"] * scale, shift=layer.arrays["shift"] * scale + shift)
            return True
        if layer.kind == "ln" and layer.arrays["weight"].ndim == 3:
            scale, shift = (v.reshape(layer.arrays["weight"].shape) for v in (scale, shift))
            layer.arrays.update(weight=layer.arrays["weight"] * scale, bias=layer.arrays["bias"] * scale + shift)
            return True
        if layer.filter_axis is None and layer.kind not in ("bn", "gn", "in", "ln"):
            return False
        scale, shift = channels_of(scale, layer.output), channels_of(shift, layer.output)
        if scale is None or shift is None:
            return False
        extents = [1] * layer.arrays["weight"].ndim
        extents[layer.filter_axis or 0] = -1
        layer.arrays["weight"] = layer.arrays["weight"] * scale.reshape(extents)
        if "bias" in layer.arrays or shift.any():
            layer.arrays["bias"] = layer.arrays.get("bias", 0.0) * scale + shift
        return True

    def _norms(self, layers, shape):
        """What is left becomes batch norms of mean 0 and variance 1."""
        found = []
        for layer in layers:
            layer.branches = [(name, self._norms(inner, shape)) for name, inner in layer.branches]
            if layer.kind == "affine":
                scale, shift = (channels_of(layer.arrays[name], layer.output) for name in ("scale", "shift"))
                if scale is None or shift is None:
                    raise CannotImport("constants for each element stand where no layer takes them; the nearest that can be imported: "
                                       "the mean of the input, constants for each channel, or constants before a dense layer")
                layer = batch_norm(Map.plain(layer.output, layer.output), {
                    "weight": scale * numpy.sqrt(1 + 1e-5), "bias": shift, "running_mean": 0 * scale, "running_var": 0 * scale + 1}, 1e-5)
            found.append(layer)
        return found


def channels_of(values, shape):
    """A number for each channel, or None if they differ within one."""
    values = values.reshape(shape[2], -1)
    return values[:, 0] if (values == values[:, :1]).all() else None
