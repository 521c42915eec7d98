#pragma once

#include <tactnet/sensors/frame.hpp>

#include <filesystem>

/// Draws a frame as a PNG file, eight pixels a tactel: counts up to 255 as they are, anything else so that
/// the largest cell is white. Throws tactnet::file_error.
void draw(const std::filesystem::path& path, const tactnet::frame_view& frame, tactnet::pressure_unit unit);
