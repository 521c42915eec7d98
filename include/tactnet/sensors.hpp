#pragma once

#include <tactnet/sensors/any_recording.hpp>
#include <tactnet/sensors/calibration.hpp>
#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/described/description.hpp>
#include <tactnet/sensors/described/description_file.hpp>
#include <tactnet/sensors/frame.hpp>
#include <tactnet/sensors/matrix_stream.hpp>
#include <tactnet/sensors/recording.hpp>
#include <tactnet/sensors/tekscan/ascii.hpp>
#include <tactnet/sensors/tekscan/binary.hpp>
#include <tactnet/sensors/tekscan/map.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/sensors/warning.hpp>
#include <tactnet/sensors/weiss.hpp>
