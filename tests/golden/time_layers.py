#!/usr/bin/env python3
"""Writes time_layers.safetensors: a network of PyTorch's Conv1d, GRU, LSTM and Linear with random weights, a recording,
the outputs after each frame, and the gradients of Σ direction · last output, computed in double precision.

Made with PyTorch 1.13.0. On Debian 12: apt install python3-torch, then /usr/bin/python3 time_layers.py. With --check it
writes nothing: it computes outputs and gradients again from the file's weights and compares them. Without PyTorch the
exit status is 77.
"""

import pathlib
import sys

try:
    import numpy
    import torch
    from torch import nn
except ImportError as missing:
    print(missing)
    sys.exit(77)
import weight_files

FILE = pathlib.Path(__file__).with_name("time_layers.safetensors")
FRAMES, FEATURES = 13, 3


class Network(nn.Module):
    def __init__(self):
        super().__init__()
        self.conv1 = nn.Conv1d(FEATURES, 7, 3, dilation=2)
        self.gru = nn.GRU(7, 11, batch_first=True)
        self.lstm = nn.LSTM(11, 6, batch_first=True)
        self.fc = nn.Linear(6, 5)

    def forward(self, x):
        """From [batch, features, frames] to [batch, frames, 5]."""
        x = self.conv1(nn.functional.pad(x, (4, 0)))
        x, _ = self.gru(torch.relu(x).transpose(1, 2))
        x, _ = self.lstm(x)
        return self.fc(x)


def results(state, recording, direction):
    """Outputs, and the gradients by name and of the recording."""
    model = Network().double()
    model.load_state_dict({name: torch.from_numpy(values.astype("f8")) for name, values in state.items()})
    x = torch.from_numpy(recording.astype("f8"))[None].requires_grad_()
    out = model(x)
    (out[0, -1] * torch.from_numpy(direction.astype("f8"))).sum().backward()
    tensors = {"selftest.logits": out[0].detach().numpy(), "selftest.gradient.input": x.grad[0].numpy()}
    for name, parameter in model.named_parameters():
        tensors["selftest.gradient." + name] = parameter.grad.numpy()
    return tensors


if "--check" in sys.argv:
    stored = weight_files.read(FILE)
    state = {name: values for name, values in stored.items() if not name.startswith("selftest.")}
    found = results(state, stored["selftest.input"], stored["selftest.direction"])
    for name, values in found.items():
        error = numpy.abs(values - stored[name]).max()
        assert error < 1e-12, (name, error)
    print(len(found), "tensors agree with PyTorch", torch.__version__)
    sys.exit()

torch.manual_seed(44)
weights = {name: values.numpy() for name, values in Network().state_dict().items()}
recording = torch.randn(FEATURES, FRAMES).numpy()
direction = torch.randn(5).numpy()
arrays = weights | {"selftest.input": recording, "selftest.direction": direction}
weight_files.write(FILE, arrays | results(weights, recording, direction))
