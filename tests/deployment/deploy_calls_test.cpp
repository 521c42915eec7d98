#include "deployed_network.hpp"

#include <tactnet/networks/tactnet4.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <support/allocations.hpp>
#include <support/same_bits.hpp>
#include <thread>

#if defined(__linux__)
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

// What holds of every call: bad frames are told, counts in bytes and in floats are the same, nothing depends
// on where memory lies or on who calls too, and nothing is asked of the heap or of the system.

using namespace tactnet;
using support::same_bits;

namespace {

using net = tactnet4<shape{28, 50}, 22>; // taps and tiles, and a last pool that reaches beyond the image
constexpr std::size_t pixels = net::input_shape.size(), outputs = net::outputs;
using float_frame = tensor_view<const float, net::input_shape>;
using byte_frame = tensor_view<const std::uint8_t, net::input_shape>;
using fast_net = deployed<net>;
using logits = std::array<float, outputs>;

static_assert(noexcept(std::declval<const fast_net&>().infer(std::declval<float_frame>(),
                                                             std::declval<std::span<float, outputs>>())));
static_assert(noexcept(std::declval<const fast_net&>().infer(std::declval<byte_frame>(),
                                                             std::declval<std::span<float, outputs>>(),
                                                             std::declval<fast_net::workspace&>())));
static_assert(noexcept(std::declval<const fast_net::view_type&>().infer(
    std::declval<byte_frame>(), std::declval<std::span<float, outputs>>())));
static_assert(fast_net::workspace_bytes == sizeof(fast_net::workspace) && fast_net::weight_bytes > 0);

constexpr float scale = 0.02f;

std::vector<float> mean_image() {
    support::numbers draw(4);
    std::vector<float> mean(pixels);
    for (float& m : mean)
        m = draw.next(0, 80);
    return mean;
}
const net& trained() {
    static const net network = [] {
        net n;
        support::fill(n, 40);
        return n;
    }();
    return network;
}
const fast_net& fast() {
    static const std::vector<float> mean = mean_image();
    static const fast_net network = deploy(trained(), std::span<const float, pixels>(mean), scale);
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

} // namespace

TEST_CASE("deployed: NaN and infinity are told wherever they are in the frame") {
    const auto missed = [](const auto& network, std::vector<float> frame) {
        using fast_type = std::remove_cvref_t<decltype(network)>;
        const auto told = [&] {
            std::array<float, fast_type::outputs> out;
            return network.infer(tensor_view<const float, fast_type::input_shape>(frame.data()),
                                 std::span(out)) == frame_status::not_finite;
        };
        std::size_t count = 0;
        for (float& pixel : frame)
            for (const float bad :
                 {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                  -std::numeric_limits<float>::infinity()}) {
                const float before = pixel;
                pixel = bad;
                count += !told();
                pixel = before;
            }
        CHECK_FALSE(told());
        return count;
    };
    CHECK(missed(fast(), as_floats(support::make_frame(pixels, 1))) == 0);
    // Here pixels may vanish on the way: in pools, which also leave some out, and in ReLUs.
    using forgetful = network<shape{9, 11, 2}, conv2d<4, 1>, relu, max_pool<2, 2, padding::valid>, dense<3>>;
    forgetful small;
    support::fill(small, 6);
    CHECK(missed(deploy(small), as_floats(support::make_frame(forgetful::input_shape.size(), 1))) == 0);
}

TEST_CASE("deployed: of a batch with one bad frame too") {
    constexpr std::size_t count = 5;
    std::vector<float> frames(count * pixels, 3), out(count * outputs);
    thread_pool threads(2);
    CHECK(fast().infer(std::span<const float>(frames), out, threads) == frame_status::ok);
    for (std::size_t i = 0; i < count; ++i) {
        frames[i * pixels + 700] = std::numeric_limits<float>::quiet_NaN();
        CHECK(fast().infer(std::span<const float>(frames), out, threads) == frame_status::not_finite);
        frames[i * pixels + 700] = 3;
    }
    const std::span<const float> all(frames);
    CHECK_THROWS_AS(static_cast<void>(fast().infer(all.first(pixels + 1), out, threads)),
                    std::invalid_argument);
    CHECK_THROWS_AS(static_cast<void>(fast().infer(all, std::span(out).first(1), threads)),
                    std::invalid_argument);
}

TEST_CASE("deployed: numbers so large that sums overflow never pass as a result") {
    const fast_net plain = deploy(trained());
    const auto layers = support::describe<net>();
    std::size_t told = 0, wrong = 0;
    for (std::size_t i = 0; i < 200; ++i) {
        support::numbers draw(i + 600);
        const float most = std::pow(10.0f, 20 + 18.4f * static_cast<float>(i) / 200);
        std::vector<float> frame(pixels);
        for (float& pixel : frame)
            pixel = std::min(draw.next(-most, most) * 2, std::numeric_limits<float>::max());
        for (float& pixel : frame)
            pixel = std::isfinite(pixel) ? pixel : std::numeric_limits<float>::lowest();
        logits out;
        if (plain.infer(float_frame(frame.data()), std::span(out)) == frame_status::not_finite) {
            ++told;
            continue;
        }
        const auto expected = support::bounded_outputs(layers, support::parameters_of(trained()),
                                                       support::bounded_input(frame, {}, 1));
        wrong += !support::shares_of(out, expected).good();
    }
    CHECK(told > 0);
    CHECK(told < 200);
    CHECK(wrong == 0);
}

TEST_CASE("deployed: a sum that overflows on the way is told, though a ReLU would hide it") {
    using hides = network<shape{1, 3}, conv2d<1, extent2d(1, 3), 1, padding::valid>, relu, dense<1>>;
    hides n;
    const std::array<float, 6> values{-2, 1.1f, 1.1f, 0, 1, 0}; // of 3e38: first −inf, in truth 6e37
    std::copy(values.begin(), values.end(), n.learnable_values().begin());
    std::array<float, 1> out{};
    const auto run = [&](float value) {
        const std::array<float, 3> frame{value, value, value};
        return deploy(n).infer(frame, out);
    };
    CHECK(run(3e38f) == frame_status::not_finite);
    CHECK(run(1e30f) == frame_status::ok);
    CHECK(out[0] == doctest::Approx(0.2e30));
}

TEST_CASE("deployed: counts of 8 bits are taken wherever a mean makes them larger than the bound") {
    using one = network<shape{1, 3}, dense<1>>;
    one n;
    std::fill_n(n.learnable_values().begin(), 3, 1e28f); // the bound is 1e7
    for (std::size_t place = 0; place < 3; ++place) {
        std::array<float, 3> mean{};
        mean[place] = 1e9f;
        const deployed<one> network = deploy(n, std::span<const float, 3>(mean), 1);
        const std::array<float, 3> frame{};
        std::array<float, 1> out{};
        CHECK(network.infer(frame, out) == frame_status::ok);
        CHECK(out[0] == doctest::Approx(-1e37));
    }
}

TEST_CASE("deployed: parameters that no training gives are refused") {
    using small = network<shape{1, 3}, conv2d<1, extent2d(1, 3), 1, padding::valid>, relu, dense<1>>;
    small n;
    n.learnable_values()[0] = 1e36f;
    CHECK_THROWS_WITH_AS(static_cast<void>(deploy(n)), doctest::Contains("up to 1e30"),
                         std::invalid_argument);
}

TEST_CASE("deployed: counts in bytes give the bits of counts in floats") {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const std::vector<std::uint8_t> counts = support::make_frame(pixels, seed);
        const std::vector<float> frame = as_floats(counts);
        logits out;
        CHECK(fast().infer(float_frame(frame.data()), std::span(out)) == frame_status::ok);
        CHECK(same_bits(out, of(counts)));
    }
}

TEST_CASE("deployed: mean and scale give the bits of a frame prepared by hand") {
    const fast_net plain = deploy(trained());
    const std::vector<float> mean = mean_image();
    const std::vector<std::uint8_t> counts = support::make_frame(pixels, 3);
    std::vector<float> frame = as_floats(counts);
    for (std::size_t i = 0; i < pixels; ++i)
        frame[i] = (frame[i] - mean[i]) * scale;
    logits out;
    CHECK(plain.infer(float_frame(frame.data()), std::span(out)) == frame_status::ok);
    CHECK(same_bits(out, of(counts)));
}

TEST_CASE("deployed: parameters that are no numbers, and impossible variances, are refused") {
    using tiny = network<shape{4, 4}, batch_norm, conv2d<3, 3>, batch_norm, relu, dense<2>>;
    tiny good;
    support::fill(good, 5);
    CHECK_NOTHROW(static_cast<void>(deploy(good)));
    const auto refused = [&](auto&& spoil) {
        tiny bad = good;
        spoil(bad);
        CHECK_THROWS_AS(static_cast<void>(deploy(bad)), std::invalid_argument);
    };
    for (std::size_t i = 0; i < tiny::parameters; ++i)
        for (const float value :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
            refused([&](tiny& bad) { bad.learnable_values()[i] = value; });
    good.for_each_parameter([&](const parameter& p, std::span<float>) {
        for (std::size_t i = p.offset; i < p.offset + p.size && !learnable(p.what); ++i) {
            refused(
                [&](tiny& bad) { bad.running_statistics()[i] = std::numeric_limits<float>::quiet_NaN(); });
            if (p.what == parameter_role::running_mean)
                refused(
                    [&](tiny& bad) { bad.running_statistics()[i] = std::numeric_limits<float>::infinity(); });
            else
                refused([&](tiny& bad) { bad.running_statistics()[i] = -1; });
        }
    });
    std::vector<float> mean(tiny::input_shape.size(), 1);
    const std::span<const float, tiny::input_shape.size()> means(mean);
    CHECK_THROWS_AS(static_cast<void>(deploy(good, means, INFINITY)), std::invalid_argument);
    for (const std::size_t bad : {std::size_t{0}, std::size_t{7}, mean.size() - 1}) {
        std::fill(mean.begin(), mean.end(), 1.0f);
        mean[bad] = NAN;
        CHECK_THROWS_WITH_AS(static_cast<void>(deploy(good, means, 1)),
                             doctest::Contains("expected a mean and a scale"), std::invalid_argument);
    }
}

TEST_CASE("deployed: the same bits in batches of any size on any number of threads") {
    constexpr std::size_t most = 64;
    std::vector<std::uint8_t> frames;
    std::vector<float> expected;
    for (std::size_t i = 0; i < most; ++i) {
        const std::vector<std::uint8_t> counts = support::make_frame(pixels, i);
        const logits alone = of(counts);
        frames.insert(frames.end(), counts.begin(), counts.end());
        expected.insert(expected.end(), alone.begin(), alone.end());
    }
    const std::vector<float> float_frames = as_floats(frames);
    for (const std::size_t count : std::array<std::size_t, 4>{1, 2, 3, 8}) {
        thread_pool threads(count);
        for (const std::size_t batch : std::array<std::size_t, 5>{0, 1, 2, 7, 64}) {
            CAPTURE(count);
            CAPTURE(batch);
            std::vector<float> out(batch * outputs, NAN);
            const std::span<const float> right(expected.data(), out.size());
            CHECK(fast().infer(std::span<const std::uint8_t>(frames).first(batch * pixels), out, threads) ==
                  frame_status::ok);
            CHECK(same_bits(out, right));
            std::fill(out.begin(), out.end(), NAN);
            CHECK(fast().infer(std::span<const float>(float_frames).first(batch * pixels), out, threads) ==
                  frame_status::ok);
            CHECK(same_bits(out, right));
        }
    }
}

TEST_CASE("deployed: the same bits wherever the frame and the outputs lie, with garbage in the memory") {
    const std::vector<std::uint8_t> counts = support::make_frame(pixels, 9);
    const std::vector<float> frame = as_floats(counts);
    const logits expected = of(counts);
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
        CHECK(fast().infer(byte_frame(moved.data() + offset), to, *memory) == frame_status::ok);
        CHECK(same_bits(to, expected));
        std::memset(static_cast<void*>(memory.get()), 0x7f, sizeof(*memory)); // 3.4e38
        std::fill(to.begin(), to.end(), NAN);
        CHECK(fast().infer(float_frame(moved_floats.data() + offset), to, *memory) == frame_status::ok);
        CHECK(same_bits(to, expected));
        for (std::size_t i = 0; i < out.size(); ++i)
            if (i <= offset || i > offset + outputs)
                CHECK(out[i] == -7);
    }
}

TEST_CASE("deployed: copies and views give the same bits, also when the original is gone") {
    const std::vector<std::uint8_t> counts = support::make_frame(pixels, 9);
    auto original = std::make_unique<fast_net>(fast());
    const fast_net copy = *original;
    const fast_net moved = std::move(*original);
    original.reset();
    for (const fast_net::view_type view : {copy.view(), moved.view()}) {
        logits out;
        CHECK(view.infer(byte_frame(counts.data()), std::span(out)) == frame_status::ok);
        CHECK(same_bits(out, of(counts)));
    }
}

TEST_CASE("deployed: the same bits for four threads on one object") {
    constexpr std::size_t callers = 4, rounds = 200;
    std::vector<std::vector<std::uint8_t>> frames;
    std::vector<logits> expected;
    for (std::size_t i = 0; i < 8; ++i) {
        frames.push_back(support::make_frame(pixels, i));
        expected.push_back(of(frames.back()));
    }
    std::array<std::size_t, callers> wrong{};
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < callers; ++t)
        threads.emplace_back([&, t] {
            for (std::size_t i = 0; i < rounds; ++i) {
                const std::size_t which = (i + t) % frames.size();
                logits out;
                const auto status = fast().infer(byte_frame(frames[which].data()), std::span(out));
                wrong[t] += status != frame_status::ok || !same_bits(out, expected[which]);
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    for (const std::size_t each : wrong)
        CHECK(each == 0);
}

TEST_CASE("deployed: nothing is asked of the heap") {
    const std::vector<std::uint8_t> counts = support::make_frame(pixels, 2);
    const std::vector<float> frame = as_floats(counts);
    const auto memory = std::make_unique<fast_net::workspace>();
    logits out;
    const fast_net& network = fast();
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

#if defined(__linux__)
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
        const char* volatile seen = large.data(); // a compiler may leave memory out that nobody sees
        return seen[1234567] == 'x';
    });
    REQUIRE(WIFSIGNALED(allocates));

    const std::vector<std::uint8_t> counts = support::make_frame(pixels, 2);
    const std::vector<float> frame = as_floats(counts);
    const logits expected = of(counts);
    const fast_net& network = fast();
    const int calls = without_system_calls([&] {
        bool right = true;
        for (std::size_t i = 0; i < 100; ++i) {
            logits out;
            right = right && network.infer(byte_frame(counts.data()), std::span(out)) == frame_status::ok &&
                    std::memcmp(out.data(), expected.data(), sizeof(out)) == 0;
            right = right && network.infer(float_frame(frame.data()), std::span(out)) == frame_status::ok &&
                    std::memcmp(out.data(), expected.data(), sizeof(out)) == 0;
        }
        return right;
    });
    CHECK(WIFEXITED(calls));
    CHECK(WEXITSTATUS(calls) == 0);
}
#endif
