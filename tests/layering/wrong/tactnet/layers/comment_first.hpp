#pragma once

// What this is for: the reader looks for it
// in one place.

#include <tactnet/detail/config.hpp>
