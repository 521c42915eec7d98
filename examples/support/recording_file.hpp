#pragma once

// Files of recordings that need zlib or libpng, as the bytes of formats that decoders read.

#include <cstddef>
#include <filesystem>
#include <vector>

/// The bytes of a file: of NPZ, as numpy.savez and savez_compressed write it, those of its arrays of two or
/// three dimensions as NPY, one after the other; of PNG and JPEG, a PGM image; of anything else, its own.
/// Throws tactnet::file_error, also for a damaged archive or image, or one of more than `largest` bytes.
std::vector<std::byte> read_recording_file(const std::filesystem::path& path,
                                           std::size_t largest = std::size_t{1} << 30);
