#!/usr/bin/env python3
"""Writes resize.safetensors: one image as OpenCV, PyTorch and Pillow resize it.

Made with OpenCV 4.6.0 (INTER_CUBIC: a = -3/4, no antialiasing, last pixel repeated at the border), PyTorch 1.13.0
(bicubic, antialias=True) and Pillow 9.4.0 (BICUBIC), both of which take a = -1/2 and leave out what lies beyond the
border. On Debian 12: apt install python3-opencv python3-torch python3-pil, then python3 resize.py.
"""

import pathlib

import cv2
import numpy
import PIL.Image
import torch
import weight_files

ROWS, COLUMNS = 20, 33
SIZES = [(10, 13), (41, 70), (31, 20), (7, 66), (20, 33)]

# A pressure image: no contact in most places, and two round ones with sharp edges.
y, x = numpy.mgrid[0:ROWS, 0:COLUMNS].astype(float)
random = numpy.random.default_rng(1)
image = numpy.zeros((ROWS, COLUMNS))
for row, column, radius in [(7, 9, 6), (12, 25, 8)]:
    distance = numpy.hypot(y - row, x - column)
    image += 120 * (1 - (distance / radius) ** 2).clip(0) ** 0.5
image = (image + random.integers(0, 11, image.shape)).clip(0, 255).astype(numpy.float32)

tensors = {"input": image}
for rows, columns in SIZES:
    size = f"{rows}x{columns}"
    tensors["opencv." + size] = cv2.resize(image, (columns, rows), interpolation=cv2.INTER_CUBIC)
    tensors["pytorch." + size] = torch.nn.functional.interpolate(
        torch.from_numpy(image)[None, None], (rows, columns), mode="bicubic", antialias=True
    )[0, 0].numpy()
    tensors["pillow." + size] = numpy.asarray(
        PIL.Image.fromarray(image).resize((columns, rows), PIL.Image.Resampling.BICUBIC)
    )

weight_files.write(pathlib.Path(__file__).with_suffix(".safetensors"), tensors)
