// A header that the program has written, run as a target without files would: prints how many bits of the
// self-test's outputs are others than the program's.

#include "roots.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

int main() {
    std::array<float, rooted::recogniser_type::outputs> found{};
    if (rooted::recogniser.infer(rooted::selftest_frame, found) != tactnet::frame_status::ok ||
        !rooted::passes_selftest())
        return 2;
    float sum = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (std::bit_cast<std::uint32_t>(found[i]) !=
            std::bit_cast<std::uint32_t>(rooted::selftest_outputs[i]))
            return 1;
        sum += found[i];
    }
    return sum > 0.999f && sum < 1.001f ? 0 : 3;
}
