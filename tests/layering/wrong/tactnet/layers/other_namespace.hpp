#pragma once

#include <tactnet/detail/config.hpp>
namespace tactnet {
int other();
}
