#pragma once

// clang-format off
#define TACTNET_FILE_OF(folder) <tactnet/operators/folder/eight_bit.hpp>
#define TACTNET_FILE_WITHOUT_STEP(folder) <tactnet/detail/config.hpp>
// clang-format on
#include <tactnet/operators/folders.hpp>

// The 8-bit steps of every operator that has one.
