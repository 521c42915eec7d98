"""The recordings `training` and `live`: what tactnet and tactnet_stream write to a terminal."""
import pathlib
import re
import subprocess
import tempfile

from sheet import read_png
from terminal import animate, record


def this_processor():
    """The name of this machine's processor as /proc/cpuinfo has it, with its generation if the table knows it."""
    text = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8")
    name, family, model = (re.search(rf"^{key}\s*: (.*)", text, re.M)[1] for key in ("model name", "cpu family", "model"))
    known = {("25", "1"): "Zen 3", ("25", "17"): "Zen 4", ("26", "2"): "Zen 5"}
    return " ".join(name.split()[:2]) + (f" ({known[family, model]})" if (family, model) in known else "")


def shown(command, columns, rows, **more):
    """What a program writes to a terminal, if all went well."""
    pieces, status = record(command, columns, rows, **more)
    if status != 0:
        raise RuntimeError(f"{command[0]} ended with {status}:\n" + b"".join(p for _, p in pieces).decode("utf-8", "replace"))
    return pieces


def stream_of(folder):
    """Frames as tactnet_stream reads them: air, then touches that begin and end. After the first, a row and two tactels get
    stuck. The stream ends in a touch, since its last screen is what stands still."""
    frames = []
    for name in ("scissors", "pliers", "sticky_tape"):
        rows = read_png(next((folder / name).glob("*.png")))
        for share in (*[0] * 9, 0.3, 0.6, 0.8, *[1] * 12, 0.8, 0.6, 0.3):
            frames.append(bytes(round(share * count) for row in rows for count in row))
    stuck = [bytes(200 if place // 50 == 7 or place in (512, 1190) else count for place, count in enumerate(frame))
             for frame in frames[27:-3]]
    return b"".join([bytes(28 * 50)] * 50 + frames[:27] + stuck)


def record_programs(tactnet, stream):
    """A training on simulated touches, and a stream of others that its network recognises, as SVG by name."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for name, seed, count in (("touches", 1, 50), ("others", 2, 1)):
            subprocess.run([str(tactnet), "simulate", "--out", name, "--per-class", str(count), "--seed", str(seed)], cwd=folder,
                           check=True, capture_output=True)
        words = ["train", "--data", "touches", "--method", "tactnet6", "--output", "tactnet6.safetensors"]
        pieces = shown([tactnet, *words], 82, 7, cwd=folder)
        speed = max(1, round(pieces[-1][0] / 12))
        training = animate(pieces, 82, 7, f"tactnet train on {this_processor()}, shown {speed} times as fast",
                           prompt=" ".join(["tactnet", *words]), pause=0.25, speed=speed)
        pieces = shown([stream, "--air", "50", "--picture", "--rate", "10", folder / "tactnet6.safetensors"], 64, 15,
                       standard_input=stream_of(folder / "others"))
        return {"training": training, "live": animate(pieces, 64, 15, f"tactnet_stream --air 50 --picture on {this_processor()}")}
