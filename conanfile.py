"""Conan 2 recipe: headers only, packaged from this checkout with `conan create .`"""

import os
import re

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.files import copy, load
from conan.tools.layout import basic_layout

required_conan_version = ">=2.0"


class TactnetConan(ConanFile):
    name = "tactnet"
    description = "Recognises touched objects from the pressure images of tactile arrays"
    license = "MIT"
    topics = ("tactile-sensing", "neural-networks", "header-only")
    package_type = "header-library"
    settings = "os", "arch", "compiler", "build_type"
    # Without networks only the component sensors is left, which needs no other library; without Eigen the components
    # simulation and eigen are left out.
    options = {"networks": [True, False], "simd": [True, False], "eigen": [True, False]}
    default_options = {"networks": True, "simd": True, "eigen": True}
    exports_sources = "include/*", "LICENSE"
    no_copy_source = True
    test_package_folder = "packaging/conan/test_package"

    def set_version(self):
        header = load(self, os.path.join(self.recipe_folder, "include", "tactnet", "version.hpp"))
        parts = [re.search(rf"#define TACTNET_VERSION_{part} (\d+)", header) for part in ("MAJOR", "MINOR", "PATCH")]
        self.version = ".".join(part.group(1) for part in parts)

    def configure(self):
        if not self.options.networks:
            del self.options.simd
            del self.options.eigen

    def requirements(self):
        # From the oldest that the library is tested with to before the first that nobody has seen.
        if self.options.networks:
            if self.options.eigen:
                self.requires("eigen/[>=3.4.0 <6]", transitive_headers=True)
            if self.options.simd:
                self.requires("xsimd/[>=8.1.0 <15]", transitive_headers=True)

    def validate(self):
        check_min_cppstd(self, 20)

    def layout(self):
        basic_layout(self)

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        copy(self, "*.hpp", os.path.join(self.source_folder, "include"), os.path.join(self.package_folder, "include"))

    def package_id(self):
        # The headers are the same whatever the settings and options.
        self.info.clear()

    def package_info(self):
        # The same package, components and targets as CMake's.
        self.cpp_info.set_property("cmake_file_name", "tactnet")
        self._component("sensors", "tactnet::sensors")
        if not self.options.networks:
            self.cpp_info.set_property("cmake_target_name", "tactnet::sensors")
            return
        self.cpp_info.set_property("cmake_target_name", "tactnet::tactnet")
        core = self._component("core", "tactnet::tactnet")
        if self.options.simd:
            core.requires = ["xsimd::xsimd"]
        else:
            # Sensors too: what one part of a program throws must be known in the other.
            core.defines = ["TACTNET_NO_SIMD"]
            self.cpp_info.components["sensors"].defines = ["TACTNET_NO_SIMD"]
        if self.settings.os in ("Linux", "FreeBSD"):
            core.system_libs = ["pthread"]
        if self.options.eigen:
            for name in ("simulation", "eigen"):
                self._component(name, f"tactnet::{name}").requires = ["core", "eigen::eigen"]

    def _component(self, name, target):
        component = self.cpp_info.components[name]
        component.set_property("cmake_target_name", target)
        component.set_property("cmake_components", [name])
        component.bindirs = []
        component.libdirs = []
        return component
