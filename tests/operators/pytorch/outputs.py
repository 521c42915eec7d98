#!/usr/bin/env python3
"""Writes what the modules of PyTorch in list.hpp compute, for the test of that list: python3 outputs.py LIST FOLDER

FOLDER/MODULE_SIZES.safetensors holds a module's arrays, inputs, outputs, a gradient of the outputs, and the gradients of inputs
and arrays that follow from it, in order. PyTorch computes in double precision.
"""

import pathlib
import re
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


SAMPLES = 3
EXAMPLE = re.compile(r'^ *example<"[a-z_0-9]+", .*shape\{([0-9]+), ([0-9]+), ([0-9]+)\},\s*[a-z_<>0-9, ]+,\s*"(.*)">', re.M)
examples = EXAMPLE.findall(re.sub(r"//.*", "", pathlib.Path(sys.argv[1]).read_text()))
folder = pathlib.Path(sys.argv[2])
folder.mkdir(parents=True, exist_ok=True)
torch.manual_seed(1)
for rows, columns, channels, text in examples:
    module = eval(text).double()  # pylint: disable=eval-used
    for parameter in module.parameters():
        nn.init.uniform_(parameter, -1, 1)
        parameter.data = parameter.data.float().double()
    x = (4 * torch.rand(SAMPLES, int(channels), int(rows), int(columns)) - 2).double().requires_grad_()
    y = module(x)
    gradient = (2 * torch.rand(y.shape) - 1).double()
    y.backward(gradient)
    arrays = {"input": x, "output": y, "output_gradient": gradient, "input_gradient": x.grad}
    for number, parameter in enumerate(module.parameters()):
        arrays |= {f"parameter.{number}": parameter, f"gradient.{number}": parameter.grad}
    arrays = {key: value.detach().contiguous().float().numpy() for key, value in arrays.items()}
    name = re.sub("[^A-Za-z0-9]", "_", text) + f"_{rows}_{columns}_{channels}"
    weight_files.write(folder / f"{name}.safetensors", arrays)
print(f"{len(examples)} modules of PyTorch {torch.__version__}")
