"""pip install --no-build-isolation ./packaging/python: the package with the library's headers, its module compiled for this machine, and the
networks that TACTNET_NETWORKS lists, as in TACTNET_NETWORKS="tactnet6<shape{28, 50}, 22>; tactnet4<shape{14, 25}, 22>"."""

import os
import pathlib
import re
import shutil
import subprocess
import sys

import setuptools
from setuptools.command.build_py import build_py

HERE = pathlib.Path(__file__).resolve().parent
INCLUDE = HERE.parents[1] / "include"


class build_with_module(build_py):
    def run(self):
        super().run()
        package = pathlib.Path(self.build_lib, "tactnet").resolve()
        shutil.rmtree(package / "include", ignore_errors=True)
        shutil.copytree(INCLUDE, package / "include")
        networks = [network.strip() for network in os.environ.get("TACTNET_NETWORKS", "").split(";") if network.strip()]
        subprocess.run([sys.executable, "-m", "tactnet.build", "--to", str(package / "built"), *networks], check=True,
                       env={**os.environ, "PYTHONPATH": str(package.parent)})


class compiled(setuptools.Distribution):
    def has_ext_modules(self):
        return True


text = (INCLUDE / "tactnet/version.hpp").read_text()
setuptools.setup(version=".".join(re.search(f"VERSION_{part} ([0-9]+)", text)[1] for part in ("MAJOR", "MINOR", "PATCH")),
                 packages=["tactnet", "tactnet.onnx", "tactnet.onnx.operators"], package_data={"tactnet": ["native/*", "native/module/*", "py.typed", "*.pyi"]},
                 cmdclass={"build_py": build_with_module}, distclass=compiled)
