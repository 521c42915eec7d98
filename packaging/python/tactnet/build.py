"""Compiles what depends on a network's type, at first use, and keeps it: python3 -m tactnet.build lists and makes what is kept.

The compiler is CXX, or c++, g++ or clang++; CXXFLAGS come after the package's own flags, so that -march=x86-64-v3 there
replaces -march=native. What it makes lies in TACTNET_CACHE, or ~/.cache/tactnet.
"""

import contextlib
import functools
import hashlib
import importlib.machinery
import importlib.util
import os
import pathlib
import platform
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import threading
import time
from typing import Any

PACKAGE = pathlib.Path(__file__).resolve().parent
INCLUDE = next((folder for folder in (PACKAGE / "include", PACKAGE.parents[2] / "include") if (folder / "tactnet").is_dir()), PACKAGE / "include")
AHEAD = PACKAGE / "built"  # what the installation has compiled


class CompilerNotFound(RuntimeError):
    """There is no C++ compiler, and what would be compiled is not kept either."""


class CompilationFailed(RuntimeError):
    """The compiler refused a network for another reason than its shapes, for example because xsimd is missing."""


@functools.lru_cache(None)
def compiler():
    """The compiler's command and what it calls itself, or None."""
    named = os.environ.get("CXX")
    for command in [named] if named else ["c++", "g++", "clang++"]:
        words = shlex.split(command)
        if words and shutil.which(words[0]):
            found = subprocess.run([*words, "--version"], capture_output=True, text=True)
            if found.returncode == 0:
                return words, found.stdout.partition("\n")[0]
    return None


def flags():
    return ["-std=c++20", "-O3", "-march=native", *shlex.split(os.environ.get("CXXFLAGS", "")), "-fPIC", "-shared", "-pthread"]


@functools.lru_cache(None)
def library():
    """A digest of all headers, and of the processor that `native` means."""
    digest = hashlib.sha256()
    for folder, pattern in ((PACKAGE, "native/**/*pp"), (INCLUDE, "tactnet/**/*.hpp")):
        for path in sorted(folder.glob(pattern)):
            digest.update(path.read_bytes())
    with contextlib.suppress(OSError), open("/proc/cpuinfo") as file:
        digest.update(next((line for line in file if line.startswith(("flags", "Features"))), "").encode())
    return digest.hexdigest() + platform.machine()


def cache():
    named = os.environ.get("TACTNET_CACHE")
    return pathlib.Path(named) if named else pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "tactnet"


def digest(*parts):
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:20]


def built(source, what, kind, more=(), suffix=".so", to=None):
    """The path of a shared library of this source, compiled now if it is not kept. `what` names it in messages; those of a `kind` take about as long."""
    found, own_flags = compiler(), [*flags(), *more]
    name = digest(source, library(), *(flag for flag in own_flags if not flag.startswith("-I")))
    exact = f"{name}-{digest(found[1]) if found else '*'}{suffix}"
    for folder, pattern in ((to, exact),) if to else ((AHEAD, f"{name}-*{suffix}"), (cache(), exact)):
        if kept := sorted(folder.glob(pattern)):
            return kept[0]
    if found is None:
        raise CompilerNotFound(f"expected a C++20 compiler (GCC 12, Clang 14 or newer) to compile {what}, found none: install g++ and xsimd (Debian: "
                               "apt-get install g++ libxsimd-dev), or name a compiler in the environment variable CXX")
    folder = to or cache()
    folder.mkdir(parents=True, exist_ok=True)
    with locked(folder / f"{name}.lock"):
        if not (folder / exact).exists():
            compile_to(folder / exact, source, what, folder / f"{kind}.seconds", [*found[0], *own_flags])
    return folder / exact


@contextlib.contextmanager
def locked(path):
    """One process at a time compiles it; the others wait for the result."""
    import fcntl
    with open(path, "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        try:
            yield
        finally:
            with contextlib.suppress(OSError):
                path.unlink()


def compile_to(path, source, what, seconds, command):
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        unit, made = pathlib.Path(folder, "unit.cpp"), pathlib.Path(folder, "unit.so")
        unit.write_text(source)
        run = subprocess.Popen([*command, f"-I{PACKAGE / 'native'}", f"-I{INCLUDE}", str(unit), "-o", str(made)], stderr=subprocess.PIPE,
                               text=True, errors="replace", env={**os.environ, "LC_ALL": "C"})
        with Progress(f"tactnet: compiling {what}", expected_seconds(seconds)) as progress:
            try:
                errors = run.communicate()[1]
            except BaseException:
                run.kill()
                raise
        if run.returncode != 0:
            raise problem(errors, what)
        os.replace(made, path)
        with contextlib.suppress(OSError):
            seconds.write_text(f"{progress.seconds():.1f}")


def expected_seconds(path):
    """What the last one of its kind took."""
    try:
        return float(path.read_text())
    except (OSError, ValueError):
        return 15.0


class Progress:
    """Says on stderr what is going on, and on a terminal how much time is left."""

    def __init__(self, what, expected):
        self.what, self.expected, self.begin, self.done = what, expected, time.monotonic(), threading.Event()

    def seconds(self):
        return time.monotonic() - self.begin

    def __enter__(self):
        self.live = sys.stderr is not None and sys.stderr.isatty()
        self.thread = threading.Thread(target=self._show, daemon=True)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.done.set()
        self.thread.join()

    def _show(self):
        if self.done.wait(0.5) or sys.stderr is None:
            return
        while True:
            left = self.expected - self.seconds()
            text = f"{self.what}, {f'about {left:.0f} s left' if left > 1 else 'nearly done'}"
            print(f"\r{text}\033[K" if self.live else text, end="" if self.live else "\n", file=sys.stderr, flush=True)
            if self.done.wait(0.5 if self.live else None):
                break
        if self.live:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def problem(errors, what):
    """The exception for what the compiler said: the library's own sentence if shapes do not fit, with its numbers."""
    if found := re.search(r"static assertion failed: (.*)|static_assert failed.*? \"(.*)\"|static assertion failed due to requirement .*?: (.*)", errors):
        sentence = next(text for text in found.groups() if text).partition("; ")[0]
        numbers = re.search(r"\[with (.*?)\]", errors[found.end():])
        values = [value.strip() for value in numbers[1].split(";")] if numbers else []
        values = [re.sub(r"(?<=\d)(ul|UL)+\b", "", value) for value in values if re.match(r"\w+ = \d", value)]
        return ValueError(sentence + (f" ({', '.join(values)})" if values else ""))
    first = next((line for line in errors.splitlines() if "error" in line), errors.strip().partition("\n")[0] or "no message")
    hint = "; xsimd is a package of its own (Debian: libxsimd-dev), and CXXFLAGS may name its folder" if "xsimd" in first else ""
    return CompilationFailed(f"the compiler refused {what}: {first}{hint}")


def core_source():
    return '#include "core.cpp"\n'


def core_flags():
    folders = [sysconfig.get_path("include")]
    with contextlib.suppress(ImportError):
        import pybind11
        folders.append(pybind11.get_include())
    return [*(f"-I{folder}" for folder in folders), "-fvisibility=hidden"]


def core_path(to=None):
    return built(core_source(), "the module, once", "core", core_flags(), importlib.machinery.EXTENSION_SUFFIXES[0], to)


@functools.lru_cache(None)
def core() -> Any:
    """The module of C++."""
    path = core_path()
    loader = importlib.machinery.ExtensionFileLoader("tactnet._core", str(path))
    module = importlib.util.module_from_spec(importlib.machinery.ModuleSpec("tactnet._core", loader, origin=str(path)))
    loader.exec_module(module)
    return sys.modules.setdefault("tactnet._core", module)


PARTS = ("described", "deployed", "trainable", "eight_bit", "stream")


def part_source(network, part, given=""):
    return f"""#include "{part}.hpp"
{"#include <tactnet/networks.hpp>" if part in PARTS else ""}
#include <ratio>

namespace {{
using namespace tactnet;
using net = {network};
}}

extern "C" void tactnet_code(tactnet_python::network_code* to) {{
    *to = tactnet_python::code_of_{part}<net>({given});
}}
"""


def part_path(network, part, to=None, given=""):
    """`given` are arguments of the function that makes the part."""
    return built(part_source(network, part, given), f"{network if len(network) < 60 else network[:57] + '...'} ({part.replace('_', ' ')})", part, to=to)


def main():
    """Compiles the module, and networks as `tactnet6<shape{28, 50}, 22>`, deployed and for training, into a folder."""
    import argparse
    parser = argparse.ArgumentParser(prog="python3 -m tactnet.build", description="Compiles ahead what would be compiled at first use.")
    parser.add_argument("networks", nargs="*", metavar="NETWORK", help="types such as 'tactnet6<shape{28, 50}, 22>'")
    parser.add_argument("--to", type=pathlib.Path, metavar="FOLDER", help="default: the cache")
    parser.add_argument("--parts", default="deployed,trainable", help=f"of {', '.join(PARTS)}")
    options = parser.parse_args()
    print(core_path(options.to))
    for network in options.networks:
        for part in options.parts.split(","):
            print(part_path(network, part, options.to))


if __name__ == "__main__":
    main()
