#pragma once

#include <tactnet/training.hpp>
