#pragma once

// The one place that holds the version: CMake, Conan and vcpkg read it from here.
#define TACTNET_VERSION_MAJOR 0
#define TACTNET_VERSION_MINOR 1
#define TACTNET_VERSION_PATCH 0
