#include "../deployment/eight_bit/networks.hpp"

#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/operators.hpp>

using namespace tactnet;

namespace {

using net = tactnet4<shape{14, 25}, 22>;
using bytes_net = deployed<net, eight_bit>;

// Little memory is what 8 bits are for. Vectors of four floats that multiply no bytes are the exception:
// their fastest method for the kernels of 2 × 2 transforms four weights into up to 36 words of 16 bits, and
// single precision has no tiles there. Smaller tiles would cost 13 to 19 % of the time on SSE4.1.
constexpr bool words_of_tiles = kernels::lanes<float> == 4 && kernels::byte_products<4>::group != 4;
static_assert(bytes_net::weight_bytes < deployed<net>::weight_bytes * (words_of_tiles ? 5 : 3) / 4);
static_assert(bytes_net::weight_bytes + bytes_net::workspace_bytes <
              (deployed<net>::weight_bytes + deployed<net>::workspace_bytes) * (words_of_tiles ? 4 : 3) / 3);

struct subject {
    using network = bytes_net;
    static const network& fast() {
        static const network made = [] {
            net n;
            support::fill(n, 40);
            return bytes_net(support::calibrated(n, 40, 4).folded());
        }();
        return made;
    }
    static std::vector<float> bad_values() { return {3e38f, -3e38f, 1e9f, 40'000.0f}; }
};

} // namespace

#include "../deployment/calls_suite.hpp"

namespace {

const bytes_net& fast() {
    return subject::fast();
}

} // namespace

TEST_CASE("eight_bit: fractional counts, and those beyond 8 bits, give the reference's bits") {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        support::numbers draw(seed);
        std::vector<float> frame(pixels);
        for (float& x : frame) {
            x = draw.next(-150, 250);
            if (seed % 2 == 0)
                x = std::round(x * 256) / 256; // ties of steps
        }
        logits out;
        CHECK(fast().infer(float_frame<fast_net>(frame.data()), std::span(out)) == frame_status::ok);
        CHECK(same_bits(out, support::reference_outputs<bytes_net::view_type>(
                                 fast().folded(), std::span<const float>(frame))));
    }
    CHECK_FALSE(reports(fast(), std::vector<float>(pixels, 200.5f)));
}

TEST_CASE("eight_bit: counts are rejected just where words end, and no earlier than counts of 8 bits") {
    const std::vector<float> mean(fast().folded().begin(), fast().folded().begin() + pixels);
    const float steps = fast().folded()[pixels], most = fast().folded()[pixels + 1];
    CHECK(steps == std::exp2(std::round(std::log2(steps)))); // so that counts of 8 bits lose nothing
    CHECK(steps >= 1);
    CHECK(most >= 255);
    CHECK(most * steps <= 32767);
    for (std::size_t p = 0; p < pixels; p += 13) {
        std::vector<float> frame(pixels, 3);
        const float rounded_mean = std::nearbyint(mean[p] * steps) / steps;
        for (const float sign : {-1.0f, 1.0f}) {
            frame[p] = rounded_mean + sign * (most - 1);
            CHECK_FALSE(reports(fast(), frame));
            frame[p] = rounded_mean + sign * (most + 1);
            CHECK(reports(fast(), frame));
        }
    }
}

TEST_CASE("eight_bit: the same bits where frames pass together") {
    using heavy = network<shape{8, 16}, conv2d<8, 3>, relu, conv2d<16, 3>, relu, max_pool<2, 2>, dense<1100>>;
    static_assert(deployed<heavy, eight_bit>::view_type::weight_bytes > kernels::l2_cache_bytes);
    const auto net = std::make_unique<heavy>();
    support::fill(*net, 41);
    check_batches(deployed<heavy, eight_bit>(support::calibrated(*net, 41, 4).folded()), 9);
}

TEST_CASE("eight_bit: folded numbers that are not finite are refused") {
    std::vector<float> folded(fast().folded().begin(), fast().folded().end());
    constexpr std::size_t count = bytes_net::view_type::folded_elements;
    CHECK_NOTHROW(bytes_net(std::span<const float, count>(folded.data(), count)));
    for (std::size_t at = 0; at < count; at += 97)
        for (const float bad :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
            const float before = folded[at];
            folded[at] = bad;
            CHECK_THROWS_WITH_AS(bytes_net(std::span<const float, count>(folded.data(), count)),
                                 doctest::Contains("expected finite numbers"), std::invalid_argument);
            folded[at] = before;
        }
}

TEST_CASE("eight_bit: a network of the same folded numbers gives the same bits") {
    const std::vector<std::uint8_t> counts = frame_for<fast_net>(9);
    CHECK(same_bits(output_of(bytes_net(fast().folded()), counts), output_of(fast(), counts)));
}
