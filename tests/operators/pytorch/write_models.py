#!/usr/bin/env python3
"""Writes a weight file for each network of norms_and_gates.cpp: what PyTorch's own layers make of images of
odd sizes, as a self-test that load_model repeats.

Parameters are drawn, so that none hides a mistake, and the logits are computed in double precision.

    write_models.py FOLDER
"""

import json
import pathlib
import sys

import torch
from torch import nn

sys.path.append(str(pathlib.Path(__file__).parents[2] / "golden"))
import weight_files


class ChannelsLast(nn.LayerNorm):
    """ConvNeXt's norm: over the channels of each pixel."""

    def forward(self, x):
        return super().forward(x.permute(0, 2, 3, 1)).permute(0, 3, 1, 2)


class SqueezeExcitation(nn.Module):
    """torchvision's, which needs no torchvision here."""

    def __init__(self, channels, squeezed, scale):
        super().__init__()
        self.fc1, self.fc2 = nn.Conv2d(channels, squeezed, 1), nn.Conv2d(squeezed, channels, 1)
        self.scale = scale

    def forward(self, x):
        factors = self.fc1(nn.functional.adaptive_avg_pool2d(x, 1)).relu()
        return x * self.scale(self.fc2(factors))


class LayerScale(nn.Module):
    """timm's, which begins as ones here."""

    def __init__(self, channels):
        super().__init__()
        self.gamma = nn.Parameter(torch.ones(channels))

    def forward(self, x):
        return x * self.gamma[:, None, None]


class Residual(nn.Sequential):
    def forward(self, x):
        return x + super().forward(x)


def network(**layers):
    return named(nn.Sequential(), layers)


def residual(**layers):
    return named(Residual(), layers)


def named(module, layers):
    for name, layer in layers.items():
        module.add_module(name, layer)
    return module


SCALE = 1 / 64
ROWS, COLUMNS = 9, 11
NETWORKS = {
    "group_norm": (3, network(conv1=nn.Conv2d(3, 20, 3, padding=1), gn1=nn.GroupNorm(5, 20))),
    "instance_norm": (3, network(in1=nn.InstanceNorm2d(3, affine=True))),
    "layer_norm_frame": (3, network(ln1=nn.LayerNorm((3, ROWS, COLUMNS)))),
    "squeeze_excitation": (3, network(se=SqueezeExcitation(3, 2, nn.Sigmoid()))),
    "mobile": (
        3,
        network(
            conv1=nn.Conv2d(3, 12, 3, padding=1),
            act=nn.Hardswish(),
            se=SqueezeExcitation(12, 5, nn.Hardsigmoid()),
            conv2=nn.Conv2d(12, 4, 1),
        ),
    ),
    "convnext": (
        3,
        network(
            conv1=nn.Conv2d(3, 8, 3, padding=1),
            block1=residual(
                dwconv=nn.Conv2d(8, 8, 7, padding=3, groups=8),
                norm=ChannelsLast(8),
                pwconv1=nn.Conv2d(8, 24, 1),
                act=nn.GELU(),
                pwconv2=nn.Conv2d(24, 8, 1),
                ls=LayerScale(8),
            ),
        ),
    ),
    "layer_norm_channels": (3, network(conv1=nn.Conv2d(3, 7, 3, padding=1), ln1=ChannelsLast(7))),
}


def main(folder):
    torch.manual_seed(20261126)
    folder.mkdir(parents=True, exist_ok=True)
    for name, (channels, module) in NETWORKS.items():
        for parameter in module.parameters():
            nn.init.uniform_(parameter, -0.8, 0.8)
        arrays = {key: value.numpy().copy() for key, value in module.state_dict().items()}
        images = torch.randint(0, 256, (3, channels, ROWS, COLUMNS), dtype=torch.uint8)
        images[1] = 7  # a frame without deviation
        with torch.no_grad():
            logits = module.double()(images.double() * SCALE).flatten(1).float()
        arrays |= {"selftest.input": images.numpy(), "selftest.logits": logits.numpy()}
        classes = [f"output_{i}" for i in range(logits.shape[1])]
        metadata = {"format": "tactnet", "version": "1", "input": "scale", "input_scale": str(SCALE)}
        weight_files.write(folder / f"{name}.safetensors", arrays, metadata | {"classes": json.dumps(classes)})


main(pathlib.Path(sys.argv[1]))
