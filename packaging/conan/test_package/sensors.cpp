// A recording of text, decoded in a program that has no other library.

#include <tactnet/sensors.hpp>

#include <cstdio>
#include <span>
#include <string_view>

#if defined(EIGEN_WORLD_VERSION) || defined(XSIMD_VERSION_MAJOR)
#error "sensors must not include Eigen or xsimd"
#endif

#if !defined(TACTNET_VERSION)
#error "every header defines the version"
#endif

int main() {
    constexpr std::string_view text = "ROWS 1\nCOLS 2\nASCII_DATA @@\n4,5\n@@\n";
    const auto recording = tactnet::decode_all(tactnet::any_recording(), std::as_bytes(std::span(text)));
    if (recording.size() != 1 || recording[0](0, 1) != 5)
        return 1;
    std::puts("tactnet decodes recordings");
}
