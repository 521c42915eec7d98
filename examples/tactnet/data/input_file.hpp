#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

/// Throws tactnet::file_error for a named pipe, a socket or a device: opening it may wait for ever. Accepts
/// what a shell passes as /dev/stdin or /dev/fd/63, unless that is a terminal. Also accepts a name of
/// nothing, which opening it reports.
void check_no_device(const std::filesystem::path& path);

/// FNV-1a over bytes, 64 bits: enough to notice that data changed, not meant against forgery.
class fingerprint {
public:
    void add(std::string_view bytes) {
        for (const char c : bytes)
            mix(static_cast<std::uint8_t>(c));
        mix(0xFF); // which ends no UTF-8 text: "ab", "c" and "a", "bc" differ
    }
    void add(std::uint64_t number) {
        for (int shift = 0; shift < 64; shift += 8)
            mix(static_cast<std::uint8_t>(number >> shift));
    }
    void mix(std::uint8_t byte) { hash_ = (hash_ ^ byte) * 0x100000001b3; }
    template <class Bytes>
    void mix_all(const Bytes& bytes) {
        for (const auto byte : bytes)
            mix(static_cast<std::uint8_t>(byte));
    }
    std::uint64_t value() const { return hash_; }
    std::string text() const;

private:
    std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// Differs when any byte of a file differs. Throws tactnet::file_error.
std::string file_fingerprint(const std::filesystem::path& path);
