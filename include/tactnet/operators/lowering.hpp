#pragma once

// clang-format off
#define TACTNET_FILE_OF(folder) <tactnet/operators/folder/lowering.hpp>
// clang-format on
#include <tactnet/operators/folders.hpp>

// How every operator is lowered to the steps of a deployed network (lowering/lowering.hpp).
