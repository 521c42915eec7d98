#pragma once

#include <tactnet/simulation/paper/objects.hpp>
