#pragma once

// A folder of its own for a test case, gone afterwards whatever happens.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>

namespace support {

class temporary_folder {
public:
    temporary_folder() {
        static std::atomic<std::uint64_t> count{0};
        const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
        do
            path_ = std::filesystem::temp_directory_path() /
                    ("tactnet_test_" + std::to_string(now) + "_" + std::to_string(count++));
        while (!std::filesystem::create_directories(path_));
    }
    temporary_folder(const temporary_folder&) = delete;
    temporary_folder& operator=(const temporary_folder&) = delete;
    ~temporary_folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

} // namespace support
