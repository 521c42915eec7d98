"""Takes the package as a user would: finds it by CMake, compiles, deploys a tiny network and runs it."""

import os

from conan import ConanFile
from conan.tools.build import can_run
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout


class TactnetTestConan(ConanFile):
    settings = "os", "arch", "compiler", "build_type"

    def layout(self):
        cmake_layout(self)

    def requirements(self):
        self.requires(self.tested_reference_str)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.user_presets_path = False  # nothing is left in the sources
        toolchain.cache_variables["COMPONENTS"] = ";".join(self._programs())
        toolchain.generate()
        CMakeDeps(self).generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def test(self):
        if can_run(self):
            for program in self._programs().values():
                self.run(os.path.join(self.cpp.build.bindirs[0], f"test_{program}"), env="conanrun")

    def _programs(self):
        options = self.dependencies[self.tested_reference_str].options
        programs = {"sensors": "sensors"}
        if options.networks:
            programs["core"] = "deploy"
            if options.eigen:
                programs["eigen"] = "eigen"
        return programs
