#pragma once

// The one place that holds the version: CMake, Conan and vcpkg read it from here.
#define TACTNET_VERSION_MAJOR 0
#define TACTNET_VERSION_MINOR 3
#define TACTNET_VERSION_PATCH 0
// To compare with: #if TACTNET_VERSION >= 300, from 0.3.0 on.
#define TACTNET_VERSION (TACTNET_VERSION_MAJOR * 10000 + TACTNET_VERSION_MINOR * 100 + TACTNET_VERSION_PATCH)
