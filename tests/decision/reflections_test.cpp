#include <tactnet/decision/reflections.hpp>
#include <tactnet/deployment/frame_ref.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

using namespace tactnet;

namespace {

/// Logits and features that depend on where each count is.
struct place_sensitive {
    static constexpr shape input_shape{2, 3};
    static constexpr std::size_t outputs = 2, features = 6;
    struct workspace {
        std::array<float, 6> counts{};
    };
    frame_status infer(const std::array<std::uint8_t, 6>& frame, std::span<float, outputs> to,
                       workspace& memory) const noexcept {
        to[0] = to[1] = 0;
        for (std::size_t i = 0; i < 6; ++i) {
            memory.counts[i] = frame[i];
            to[0] += static_cast<float>(i * frame[i]);
        }
        to[1] = frame[0];
        return frame[5] == 255 ? frame_status::not_finite : frame_status::ok;
    }
    void read_features(const workspace& memory, std::span<float, features> to) const noexcept {
        for (std::size_t i = 0; i < features; ++i)
            to[i] = memory.counts[i];
    }
};

} // namespace

TEST_CASE("infer_reflections: the mean of four views; one that is not finite is reported") {
    const place_sensitive network;
    place_sensitive::workspace memory;
    std::array<float, 2> logits{};
    std::array<float, 6> features{};
    const std::array<std::uint8_t, 6> frame{8, 0, 0, 0, 4, 0};
    CHECK(infer_reflections(network, frame, logits, features, memory) == frame_status::ok);
    CHECK(logits == std::array{(8 * 0 + 4 * 4 + 8 * 3 + 4 * 1 + 8 * 2 + 4 * 4 + 8 * 5 + 4 * 1) / 4.0F, 2.0F});
    CHECK(features == std::array{2.0F, 2.0F, 2.0F, 2.0F, 2.0F, 2.0F});
    const std::array<std::uint8_t, 6> turned{0, 4, 0, 0, 0, 8};
    const std::array<float, 2> before = logits;
    CHECK(infer_reflections(network, turned, logits, features, memory) == frame_status::ok);
    CHECK(logits == before);
    for (const std::size_t corner : {0U, 2U, 3U, 5U}) {
        std::array<std::uint8_t, 6> bad{};
        bad[corner] = 255;
        CHECK(infer_reflections(network, bad, logits, features, memory) == frame_status::not_finite);
    }
}
