#pragma once

#include <tactnet/sensors/recording.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
