"""Recordings and streams of sensors, what a sensor's frames tell of its health and of contacts, and simulated sensors (docs/train/python.md).
Frames are arrays (rows, columns) or (n, rows, columns); those that lie in memory as the library reads them are not copied."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Iterable, Mapping, Optional, Sequence, Union

from . import build
from .network import _shape

if TYPE_CHECKING:
    from . import _core

Description = Union[str, "os.PathLike[str]", Mapping[str, Any]]


def _description(sensor: Optional[Description]) -> Optional[str]:
    """JSON of a sensor: a dict, or a file."""
    if sensor is None or isinstance(sensor, Mapping):
        return None if sensor is None else json.dumps(dict(sensor))
    with open(sensor, encoding="utf-8") as file:
        return file.read()


def _code(part: str, text: str, given: str = "") -> _core.Code:
    code = build.core().Code()
    code.add(str(build.part_path(text, part, given=given)))
    return code


def decode(source: Union[str, "os.PathLike[str]", bytes, bytearray, memoryview], sensor: Optional[Description] = None, mask: Iterable[bool] = (),
           keep_damaged: bool = False) -> _core.Recording:
    """The Recording in a file or in bytes: of Tekscan, novel, XSENSOR, NumPy or PGM, recognised by what is in it.

    `sensor`, a dict or a file of JSON, describes other devices and tables (docs/recognise/sensors.md). `mask` has for each cell whether there is a
    tactel. A damaged recording is a FileError that says where; with `keep_damaged` its whole frames are returned, and `damage` is the sentence.

    >>> table = decode(b"1,2,3,4\\n5,6,7,8\\n", {"rows": 2, "columns": 2, "cell": "digits"})
    >>> table.frames.shape, table.frames[1].tolist()
    ((2, 2, 2), [[5.0, 6.0], [7.0, 8.0]])
    """
    name = "bytes"
    if isinstance(source, (str, os.PathLike)):
        name = os.fspath(source)
        with open(source, "rb") as file:
            source = file.read()
    return build.core().decode(source, _description(sensor), [bool(each) for each in mask], keep_damaged, name)


def Decoder(sensor: Optional[Description] = None) -> _core.Decoder:
    """Decodes bytes as they come: `push(data)` returns the frames that are complete. `sensor` as for `decode`."""
    return build.core().Decoder(_description(sensor))


def Sensor(size: Sequence[int], **settings: float) -> _core.Sensor:
    """Health and contacts of a sensor of (rows, columns) tactels (docs/recognise/decision.md), for one thread at a time.

    Counts are of uint8, uint16 or float32. `untouched` and `full` are the counts without a touch and at full scale, 0 and 255 by default, and
    `broken` marks a broken tactel, as NaN does. Of 0 to 255 are `pressed`, the least count of a touch, by default 8; in tactels `begin_area` and
    `end_area`, which begin and end a contact; `frames_to_fault` are frames that make a tactel faulty, by default 16.
    """
    code = _code("sensor", f"sensor_array<{_shape(size)}>")
    return build.core().Sensor(code, *size, **settings)


def Scene(size: Sequence[int], effects: Iterable[str] = ("contact<winkler>", "elastic_pad", "noise", "saturation", "quantisation<8>"),
          pitch: float = 1.903e-3, unit: int = 1) -> _core.Scene:
    """A simulated sensor of (rows, columns) tactels, `pitch` metres apart, for one thread at a time; `unit` is its number, for what varies between
    sensors.

    `effects` are those of docs/train/simulation.md in the order of physics, with parameters in braces, as "noise{.additive = 200}".
    """
    effects, (rows, columns) = list(effects), size
    _shape(size)
    listed = ", ".join(effect.partition("{")[0].strip() for effect in effects)
    code = _code("scene", f"scene<array<{rows}, {columns}>, {listed}>", ", ".join(effect for effect in effects if "{" in effect))
    return build.core().Scene(code, pitch, unit)
