#include "networks.hpp"

#include <tactnet/kernels/caches.hpp>
#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/tactnet4.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <support/allocations.hpp>
#include <thread>

// What holds of every call in 8 bits, as of those in single precision.

using namespace tactnet;
using support::same_bits;

namespace {

using net = tactnet4<shape{14, 25}, 22>;
constexpr std::size_t pixels = net::input_shape.size(), outputs = net::outputs;
using bytes_net = deployed<net, eight_bit>;
using float_frame = tensor_view<const float, net::input_shape>;
using byte_frame = tensor_view<const std::uint8_t, net::input_shape>;
using logits = std::array<float, outputs>;

static_assert(noexcept(std::declval<const bytes_net&>().infer(std::declval<float_frame>(),
                                                              std::declval<std::span<float, outputs>>())));
static_assert(noexcept(std::declval<const bytes_net&>().infer(std::declval<byte_frame>(),
                                                              std::declval<std::span<float, outputs>>(),
                                                              std::declval<bytes_net::workspace&>())));
static_assert(noexcept(std::declval<const bytes_net::view_type&>().infer(
    std::declval<byte_frame>(), std::declval<std::span<float, outputs>>())));
// Little memory is what 8 bits are for. Where no instruction multiplies bytes, weights lie in words of 16;
// and tiles, which may pay in 8 bits where they do not in floats, take memory on the way.
static_assert(bytes_net::weight_bytes < deployed<net>::weight_bytes * 3 / 4);
static_assert(bytes_net::weight_bytes + bytes_net::workspace_bytes <
              deployed<net>::weight_bytes + deployed<net>::workspace_bytes);

const bytes_net& fast() {
    static const bytes_net network = [] {
        net n;
        support::fill(n, 40);
        return bytes_net(support::calibrated(n, 40, 4).folded());
    }();
    return network;
}
std::vector<float> as_floats(const std::vector<std::uint8_t>& counts) {
    return std::vector<float>(counts.begin(), counts.end());
}
logits of(const std::vector<std::uint8_t>& counts) {
    logits out;
    out.fill(-1);
    CHECK(fast().infer(byte_frame(counts.data()), std::span(out)) == frame_status::ok);
    return out;
}
bool told(const std::vector<float>& frame) {
    logits out;
    return fast().infer(float_frame(frame.data()), std::span(out)) == frame_status::not_finite;
}

/// Batches of all sizes, beside each frame alone.
template <class Deployed>
void check_batches(const Deployed& fast_net) {
    constexpr std::size_t most = 9, size = Deployed::input_shape.size(), numbers = Deployed::outputs;
    std::vector<std::uint8_t> frames;
    std::vector<float> expected(most * numbers, -1);
    for (std::size_t i = 0; i < most; ++i) {
        const std::vector<std::uint8_t> counts = support::make_frame(size, i);
        CHECK(fast_net.infer(tensor_view<const std::uint8_t, Deployed::input_shape>(counts.data()),
                             std::span<float, numbers>(expected.data() + i * numbers, numbers)) ==
              frame_status::ok);
        frames.insert(frames.end(), counts.begin(), counts.end());
    }
    const std::vector<float> float_frames = as_floats(frames);
    for (const std::size_t count : std::array<std::size_t, 3>{1, 2, 3}) {
        thread_pool threads(count);
        for (const std::size_t batch : std::array<std::size_t, 4>{0, 1, 4, most}) {
            CAPTURE(count);
            CAPTURE(batch);
            std::vector<float> out(batch * numbers, NAN);
            const std::span<const float> right(expected.data(), out.size());
            CHECK(fast_net.infer(std::span<const std::uint8_t>(frames).first(batch * size), out, threads) ==
                  frame_status::ok);
            CHECK(same_bits(out, right));
            std::fill(out.begin(), out.end(), NAN);
            CHECK(fast_net.infer(std::span<const float>(float_frames).first(batch * size), out, threads) ==
                  frame_status::ok);
            CHECK(same_bits(out, right));
        }
        std::vector<float> broken = float_frames, out(most * numbers);
        broken[5 * size + 3] = std::numeric_limits<float>::quiet_NaN();
        CHECK(fast_net.infer(std::span<const float>(broken), out, threads) == frame_status::not_finite);
    }
}

} // namespace

TEST_CASE("eight_bit: counts in bytes give the bits of counts in floats") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const std::vector<std::uint8_t> counts = support::make_frame(pixels, seed);
        const std::vector<float> frame = as_floats(counts);
        logits out;
        CHECK(fast().infer(float_frame(frame.data()), std::span(out)) == frame_status::ok);
        CHECK(same_bits(out, of(counts)));
    }
}

TEST_CASE("eight_bit: counts between whole ones, and beside those of 8 bits, give the reference's bits") {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        support::numbers draw(seed);
        std::vector<float> frame(pixels);
        for (float& x : frame) {
            x = draw.next(-150, 250);
            if (seed % 2 == 0)
                x = std::round(x * 256) / 256; // ties of steps
        }
        logits out;
        CHECK(fast().infer(float_frame(frame.data()), std::span(out)) == frame_status::ok);
        CHECK(same_bits(out, support::reference_outputs<bytes_net::view_type>(
                                 fast().folded(), std::span<const float>(frame))));
    }
    CHECK_FALSE(told(std::vector<float>(pixels, 200.5f)));
}

TEST_CASE("eight_bit: NaN and infinity are told wherever they are in the frame") {
    std::vector<float> frame = as_floats(support::make_frame(pixels, 1));
    std::size_t missed = 0;
    for (float& pixel : frame)
        for (const float bad :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
              -std::numeric_limits<float>::infinity(), 3e38f, -3e38f, 1e9f, 40'000.0f}) {
            const float before = pixel;
            pixel = bad;
            missed += !told(frame);
            pixel = before;
        }
    CHECK(missed == 0);
    CHECK_FALSE(told(frame));
}

TEST_CASE("eight_bit: counts are told just where words end, and no earlier than counts of 8 bits") {
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
            CHECK_FALSE(told(frame));
            frame[p] = rounded_mean + sign * (most + 1);
            CHECK(told(frame));
        }
    }
}

TEST_CASE("eight_bit: the same bits in batches of any size on any number of threads") {
    check_batches(fast());
}

TEST_CASE("eight_bit: the same bits where frames pass together") {
    using heavy = network<shape{8, 16}, conv2d<8, 3>, relu, conv2d<16, 3>, relu, max_pool<2, 2>, dense<1100>>;
    static_assert(deployed<heavy, eight_bit>::view_type::weight_bytes > kernels::l2_cache_bytes);
    const auto net = std::make_unique<heavy>();
    support::fill(*net, 41);
    check_batches(deployed<heavy, eight_bit>(support::calibrated(*net, 41, 4).folded()));
}

TEST_CASE("eight_bit: the same bits wherever the frame and the outputs lie, with garbage in the memory") {
    const std::vector<std::uint8_t> counts = support::make_frame(pixels, 9);
    const std::vector<float> frame = as_floats(counts);
    const logits expected = of(counts);
    const auto memory = std::make_unique<bytes_net::workspace>();
    for (std::size_t offset = 0; offset < 16; ++offset) {
        std::vector<std::uint8_t> moved(pixels + 16);
        std::vector<float> moved_floats(pixels + 16), out(outputs + 32, -7);
        std::copy(counts.begin(), counts.end(), moved.begin() + static_cast<std::ptrdiff_t>(offset));
        std::copy(frame.begin(), frame.end(), moved_floats.begin() + static_cast<std::ptrdiff_t>(offset));
        const std::span<float, outputs> to(out.data() + offset + 1, outputs);
        std::memset(static_cast<void*>(memory.get()), offset == 0 ? 0xff : static_cast<int>(offset * 37),
                    sizeof(*memory));
        CHECK(fast().infer(byte_frame(moved.data() + offset), to, *memory) == frame_status::ok);
        CHECK(same_bits(to, expected));
        std::memset(static_cast<void*>(memory.get()), 0x7f, sizeof(*memory));
        std::fill(to.begin(), to.end(), NAN);
        CHECK(fast().infer(float_frame(moved_floats.data() + offset), to, *memory) == frame_status::ok);
        CHECK(same_bits(to, expected));
        for (std::size_t i = 0; i < out.size(); ++i)
            if (i <= offset || i > offset + outputs)
                CHECK(out[i] == -7);
    }
}

TEST_CASE("eight_bit: copies give the same bits, and so do four threads on one object") {
    const auto original = std::make_unique<bytes_net>(fast());
    const bytes_net copy = *original, again(copy.folded());
    std::vector<std::vector<std::uint8_t>> frames;
    std::vector<logits> expected;
    for (std::size_t i = 0; i < 8; ++i) {
        frames.push_back(support::make_frame(pixels, i));
        expected.push_back(of(frames.back()));
    }
    std::array<std::size_t, 4> wrong{};
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < wrong.size(); ++t)
        threads.emplace_back([&, t] {
            for (std::size_t i = 0; i < 100; ++i) {
                const std::size_t which = (i + t) % frames.size();
                const bytes_net& network = t % 2 == 0 ? copy : again;
                logits out;
                const auto status = network.infer(byte_frame(frames[which].data()), std::span(out));
                wrong[t] += status != frame_status::ok || !same_bits(out, expected[which]);
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    for (const std::size_t each : wrong)
        CHECK(each == 0);
}

TEST_CASE("eight_bit: nothing is asked of the heap") {
    const std::vector<std::uint8_t> counts = support::make_frame(pixels, 2);
    const std::vector<float> frame = as_floats(counts);
    const auto memory = std::make_unique<bytes_net::workspace>();
    logits out;
    const bytes_net& network = fast();
    const std::size_t before = support::allocations();
    const auto a = network.infer(byte_frame(counts.data()), std::span(out));
    const auto b = network.infer(float_frame(frame.data()), std::span(out));
    const auto c = network.infer(byte_frame(counts.data()), std::span(out), *memory);
    const auto d = network.view().infer(float_frame(frame.data()), std::span(out), *memory);
    const std::size_t after = support::allocations();
    CHECK(after == before);
    for (const auto status : {a, b, c, d})
        CHECK(status == frame_status::ok);
    // The counter counts.
    ::operator delete(::operator new(1)); // in this form the compiler may not leave it out
    CHECK(support::allocations() > after);
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
