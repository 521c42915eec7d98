#pragma once

// What holds of every call of a deployed network, in each number format: bad frames are reported, counts in
// bytes and in floats are the same, nothing depends on where memory lies or on who calls too, and nothing is
// asked of the heap or of the system. Included by one file a format, behind a
//
//   struct subject {
//       using network = …;   // deployed
//       static const network& fast();
//       static std::vector<float> bad_values(); // besides NaN and infinity
//   };

#include "deployed_network.hpp"

#include <tactnet/runtime/thread_pool.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <support/allocations.hpp>
#include <support/same_bits.hpp>
#include <thread>
#include <utility>
#include <vector>

#if defined(__linux__) && !defined(__SANITIZE_THREAD__)
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

namespace {

using support::same_bits;
using tactnet::frame_status;

template <class Deployed>
using float_frame = tactnet::tensor_view<const float, Deployed::input_shape>;
template <class Deployed>
using byte_frame = tactnet::tensor_view<const std::uint8_t, Deployed::input_shape>;
template <class Deployed>
using logits_of = std::array<float, Deployed::outputs>;

std::vector<float> as_floats(const std::vector<std::uint8_t>& counts) {
    return std::vector<float>(counts.begin(), counts.end());
}
template <class Deployed>
std::vector<std::uint8_t> frame_for(std::uint64_t seed) {
    return support::make_frame(Deployed::input_shape.size(), seed);
}
template <class Deployed>
logits_of<Deployed> output_of(const Deployed& network, const std::vector<std::uint8_t>& counts) {
    logits_of<Deployed> out;
    out.fill(-1);
    CHECK(network.infer(byte_frame<Deployed>(counts.data()), std::span(out)) == frame_status::ok);
    return out;
}
template <class Deployed>
bool reports(const Deployed& network, const std::vector<float>& frame) {
    logits_of<Deployed> out;
    return network.infer(float_frame<Deployed>(frame.data()), std::span(out)) == frame_status::not_finite;
}

/// The pairs of a pixel and a bad value that a network takes for a good frame.
template <class Deployed>
std::size_t bad_pixels_missed(const Deployed& network, std::vector<float> bad_values = {}) {
    for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                              -std::numeric_limits<float>::infinity()})
        bad_values.push_back(value);
    std::vector<float> frame = as_floats(frame_for<Deployed>(1));
    std::size_t missed = 0;
    for (float& pixel : frame)
        for (const float bad : bad_values) {
            const float before = std::exchange(pixel, bad);
            missed += !reports(network, frame);
            pixel = before;
        }
    CHECK_FALSE(reports(network, frame));
    return missed;
}

/// Batches of all sizes, compared with each frame alone.
template <class Deployed>
void check_batches(const Deployed& network, std::size_t most) {
    constexpr std::size_t size = Deployed::input_shape.size(), outputs = Deployed::outputs;
    std::vector<std::uint8_t> frames;
    std::vector<float> expected;
    for (std::size_t i = 0; i < most; ++i) {
        const std::vector<std::uint8_t> counts = frame_for<Deployed>(i);
        const auto alone = output_of(network, counts);
        frames.insert(frames.end(), counts.begin(), counts.end());
        expected.insert(expected.end(), alone.begin(), alone.end());
    }
    const std::vector<float> float_frames = as_floats(frames);
    for (const std::size_t count : {1U, 2U, 3U, 8U}) {
        tactnet::thread_pool threads(count);
        for (const std::size_t batch : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{4},
                                        std::size_t{7}, std::size_t{9}, most}) {
            CAPTURE(count);
            CAPTURE(batch);
            std::vector<float> out(batch * outputs, NAN);
            const std::span<const float> right(expected.data(), out.size());
            CHECK(network.infer(std::span<const std::uint8_t>(frames).first(batch * size), out, threads) ==
                  frame_status::ok);
            CHECK(same_bits(out, right));
            std::fill(out.begin(), out.end(), NAN);
            CHECK(network.infer(std::span<const float>(float_frames).first(batch * size), out, threads) ==
                  frame_status::ok);
            CHECK(same_bits(out, right));
        }
        std::vector<float> broken = float_frames, out(most * outputs);
        for (std::size_t i = 0; i < 9; ++i) {
            const float before =
                std::exchange(broken[i * size + size / 2], std::numeric_limits<float>::quiet_NaN());
            CHECK(network.infer(std::span<const float>(broken), out, threads) == frame_status::not_finite);
            broken[i * size + size / 2] = before;
        }
        const std::span<const float> all(broken);
        CHECK_THROWS_AS(static_cast<void>(network.infer(all.first(size + 1), out, threads)),
                        std::invalid_argument);
        CHECK_THROWS_AS(static_cast<void>(network.infer(all, std::span(out).first(1), threads)),
                        std::invalid_argument);
    }
}

using fast_net = subject::network;
constexpr std::size_t pixels = fast_net::input_shape.size(), outputs = fast_net::outputs;
using logits = logits_of<fast_net>;

static_assert(noexcept(std::declval<const fast_net&>().infer(std::declval<float_frame<fast_net>>(),
                                                             std::declval<std::span<float, outputs>>())));
static_assert(noexcept(std::declval<const fast_net&>().infer(std::declval<byte_frame<fast_net>>(),
                                                             std::declval<std::span<float, outputs>>(),
                                                             std::declval<fast_net::workspace&>())));
static_assert(noexcept(std::declval<const fast_net::view_type&>().infer(
    std::declval<byte_frame<fast_net>>(), std::declval<std::span<float, outputs>>())));
static_assert(fast_net::workspace_bytes == sizeof(fast_net::workspace) && fast_net::weight_bytes > 0);

} // namespace

TEST_CASE("deployed: NaN and infinity are reported wherever they are in the frame") {
    CHECK(bad_pixels_missed(subject::fast(), subject::bad_values()) == 0);
}

TEST_CASE("deployed: counts in bytes give the bits of counts in floats") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const std::vector<std::uint8_t> counts = frame_for<fast_net>(seed);
        const std::vector<float> frame = as_floats(counts);
        logits out;
        CHECK(subject::fast().infer(float_frame<fast_net>(frame.data()), std::span(out)) == frame_status::ok);
        CHECK(same_bits(out, output_of(subject::fast(), counts)));
    }
}

TEST_CASE(
    "deployed: the same bits in batches of any size on any number of threads, and a bad frame among them") {
    check_batches(subject::fast(), 64);
}

TEST_CASE("deployed: the same bits wherever the frame and the outputs lie, with garbage in the memory") {
    const std::vector<std::uint8_t> counts = frame_for<fast_net>(9);
    const std::vector<float> frame = as_floats(counts);
    const logits expected = output_of(subject::fast(), counts);
    const auto memory = std::make_unique<fast_net::workspace>();
    for (std::size_t offset = 0; offset < 16; ++offset) {
        std::vector<std::uint8_t> moved(pixels + 16);
        std::vector<float> moved_floats(pixels + 16), out(outputs + 32, -7);
        std::copy(counts.begin(), counts.end(), moved.begin() + static_cast<std::ptrdiff_t>(offset));
        std::copy(frame.begin(), frame.end(), moved_floats.begin() + static_cast<std::ptrdiff_t>(offset));
        const std::span<float, outputs> to(out.data() + offset + 1, outputs);
        // NaN at first: what is read before it is written shows.
        std::memset(static_cast<void*>(memory.get()), offset == 0 ? 0xff : static_cast<int>(offset * 37),
                    sizeof(*memory));
        CHECK(subject::fast().infer(byte_frame<fast_net>(moved.data() + offset), to, *memory) ==
              frame_status::ok);
        CHECK(same_bits(to, expected));
        std::memset(static_cast<void*>(memory.get()), 0x7f, sizeof(*memory)); // 3.4e38
        std::fill(to.begin(), to.end(), NAN);
        CHECK(subject::fast().infer(float_frame<fast_net>(moved_floats.data() + offset), to, *memory) ==
              frame_status::ok);
        CHECK(same_bits(to, expected));
        for (std::size_t i = 0; i < out.size(); ++i)
            if (i <= offset || i > offset + outputs)
                CHECK(out[i] == -7);
    }
}

TEST_CASE("deployed: copies and views give the same bits, also when the original is gone") {
    const std::vector<std::uint8_t> counts = frame_for<fast_net>(9);
    auto original = std::make_unique<fast_net>(subject::fast());
    const fast_net copy = *original;
    const fast_net moved = std::move(*original);
    original.reset();
    for (const fast_net::view_type& view : {copy.view(), moved.view()}) {
        logits out;
        CHECK(view.infer(byte_frame<fast_net>(counts.data()), std::span(out)) == frame_status::ok);
        CHECK(same_bits(out, output_of(subject::fast(), counts)));
    }
}

TEST_CASE("deployed: the same bits for four threads on one object") {
    constexpr std::size_t callers = 4, rounds = 200;
    std::vector<std::vector<std::uint8_t>> frames;
    std::vector<logits> expected;
    for (std::size_t i = 0; i < 8; ++i) {
        frames.push_back(frame_for<fast_net>(i));
        expected.push_back(output_of(subject::fast(), frames.back()));
    }
    std::array<std::size_t, callers> wrong{};
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < callers; ++t)
        threads.emplace_back([&, t] {
            for (std::size_t i = 0; i < rounds; ++i) {
                const std::size_t which = (i + t) % frames.size();
                logits out;
                const auto status =
                    subject::fast().infer(byte_frame<fast_net>(frames[which].data()), std::span(out));
                wrong[t] += status != frame_status::ok || !same_bits(out, expected[which]);
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    for (const std::size_t each : wrong)
        CHECK(each == 0);
}

TEST_CASE("deployed: nothing is asked of the heap") {
    const std::vector<std::uint8_t> counts = frame_for<fast_net>(2);
    const std::vector<float> frame = as_floats(counts);
    const auto memory = std::make_unique<fast_net::workspace>();
    logits out;
    const fast_net& network = subject::fast();
    const std::size_t before = support::allocations();
    const auto a = network.infer(byte_frame<fast_net>(counts.data()), std::span(out));
    const auto b = network.infer(float_frame<fast_net>(frame.data()), std::span(out));
    const auto c = network.infer(byte_frame<fast_net>(counts.data()), std::span(out), *memory);
    const auto d = network.view().infer(float_frame<fast_net>(frame.data()), std::span(out), *memory);
    const std::size_t after = support::allocations();
    CHECK(after == before);
    for (const auto status : {a, b, c, d})
        CHECK(status == frame_status::ok);
    // The counter counts.
    ::operator delete(::operator new(1)); // in this form the compiler may not leave it out
    CHECK(support::allocations() > after);
}

// The thread sanitizer starts a thread in each child, which then cannot end by the one call that is allowed.
#if defined(__linux__) && !defined(__SANITIZE_THREAD__)
namespace {

/// How a child process ends that may do nothing but compute: the kernel kills it at any system call but its
/// end. Exits with 0 if `body` gives true.
template <class Body>
int without_system_calls(Body&& body) {
    const pid_t child = fork();
    if (child == 0) {
        if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0)
            syscall(SYS_exit, 77);
        const bool good = body();
        syscall(SYS_exit, good ? 0 : 1); // _exit would ask for exit_group, which strict mode forbids
    }
    int status = -1;
    waitpid(child, &status, 0);
    return status;
}

} // namespace

TEST_CASE("deployed: nothing is asked of the system, as real time demands") {
    const int nothing = without_system_calls([] { return true; });
    if (WIFEXITED(nothing) && WEXITSTATUS(nothing) == 77) {
        MESSAGE("skipped: this system has no strict mode of seccomp");
        return;
    }
    REQUIRE(WIFEXITED(nothing));
    // Otherwise nothing would be proved: asking for the process id, or for memory that the heap does not
    // have.
    const int asks = without_system_calls([] { return syscall(SYS_getppid) != 0; });
    REQUIRE(WIFSIGNALED(asks));
    const int allocates = without_system_calls([] {
        const std::vector<char> large(std::size_t{1} << 26, 'x');
        const char* volatile seen = large.data(); // a compiler may leave out memory that is never read
        return seen[1234567] == 'x';
    });
    REQUIRE(WIFSIGNALED(allocates));

    const std::vector<std::uint8_t> counts = frame_for<fast_net>(2);
    const std::vector<float> frame = as_floats(counts);
    const logits expected = output_of(subject::fast(), counts);
    const fast_net& network = subject::fast();
    const int calls = without_system_calls([&] {
        bool right = true;
        for (std::size_t i = 0; i < 100; ++i) {
            logits out;
            right = right &&
                    network.infer(byte_frame<fast_net>(counts.data()), std::span(out)) == frame_status::ok &&
                    std::memcmp(out.data(), expected.data(), sizeof(out)) == 0;
            right = right &&
                    network.infer(float_frame<fast_net>(frame.data()), std::span(out)) == frame_status::ok &&
                    std::memcmp(out.data(), expected.data(), sizeof(out)) == 0;
        }
        return right;
    });
    CHECK(WIFEXITED(calls));
    CHECK(WEXITSTATUS(calls) == 0);
}
#endif
