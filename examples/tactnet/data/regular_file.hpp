#pragma once

#include <filesystem>

/// Throws tactnet::file_error for a named pipe, a socket or a device: opening it may wait for ever. What a
/// shell passes as /dev/stdin or /dev/fd/63 is taken, unless that is a terminal; so is a name of nothing,
/// which whoever opens it finds out.
void check_no_device(const std::filesystem::path& path);
