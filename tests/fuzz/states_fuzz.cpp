// Any bytes as a saved state: they are restored, or refused and nothing changes. What was restored answers
// with finite numbers, is saved as it was, and goes on.

#include "fuzz_target.hpp"

#include <tactnet/decision/discriminant.hpp>
#include <tactnet/decision/sensor_health.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/quantisation.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

using fuzz::require;
using health = tactnet::sensor_health<tactnet::shape{3, 8}>;
using means = tactnet::class_means<2, 3>;
using map = tactnet::discriminant<3, 2>;

/// The state of a stream, with the calls of other states.
using net =
    tactnet::network<tactnet::shape{8, 1, 2}, tactnet::causal_conv1d<3, 3, 2>, tactnet::relu,
                     tactnet::residual<tactnet::sequence<tactnet::causal_conv1d<3, 2>>>, tactnet::lstm<4>>;
template <class Format>
struct stream {
    using network = tactnet::deployed_stream<net, Format>;
    static constexpr std::size_t state_bytes = tactnet::saved_state_bytes<typename network::state>;
    typename network::state memory{};

    void save(std::span<std::byte, state_bytes> to) const { tactnet::save_state(memory, to); }
    tactnet::restore_status restore(std::span<const std::byte> from) {
        return trained().restore_state(from, memory);
    }
    static const network& trained() {
        static const auto trained = [] {
            net drawn;
            float number = 0;
            for (float& value : drawn.learnable_values())
                value = ((number += 37) > 50 ? number -= 101 : number) / 64;
            if constexpr (std::is_same_v<Format, tactnet::eight_bit>)
                return tactnet::deploy_stream<Format>(drawn,
                                                      std::vector<float>(net::input_shape.size(), 0.5F));
            else
                return tactnet::deploy_stream(drawn);
        }();
        return trained;
    }
};
using float_stream = stream<tactnet::single_precision>;
using byte_stream = stream<tactnet::eight_bit>;

template <class State>
auto saved(const State& state) {
    std::array<std::byte, State::state_bytes> bytes;
    if constexpr (requires { state.save(std::span(bytes)); })
        state.save(std::span(bytes));
    else
        bytes = state.save();
    return bytes;
}
/// An input as a state of this kind: of its size, with its header, and with a right checksum.
template <class State>
std::array<std::byte, State::state_bytes> framed(std::span<const std::uint8_t> input) {
    auto bytes = saved(State());
    const std::size_t first = tactnet::detail::state_header_bytes,
                      last = bytes.size() - tactnet::detail::state_checksum_bytes;
    for (std::size_t i = 0; i < input.size() && first + i < last; ++i)
        bytes[first + i] = std::byte{input[i]};
    const std::uint64_t sum = tactnet::xxh64().update(std::span(bytes).first(last)).digest();
    for (std::size_t i = 0; i < tactnet::detail::state_checksum_bytes; ++i)
        bytes[last + i] = static_cast<std::byte>(sum >> 8 * i & 0xFF);
    return bytes;
}

void go_on(health& state) {
    std::array<std::uint8_t, 24> frame{};
    for (int i = 0; i < 40; ++i) {
        frame.fill(static_cast<std::uint8_t>(i % 8 == 7 ? 255 : 0));
        frame[static_cast<std::size_t>(i % 24)] = 200;
        if (i % 2 == 0)
            state.learn(frame);
        else
            state.follow(frame);
        (void)state.clean(frame);
        require(state.faults().size() <= health::max_faults && std::isfinite(state.mean_baseline()));
    }
}
void go_on(means& state) {
    constexpr float most = 3.4e38f;
    for (const means::point& touch :
         {means::point{1, 2}, means::point{most, -most}, means::point{0, 1e-45f}}) {
        if (const auto near = state.nearest(touch))
            require(std::isfinite(near->squared_distance) && std::isfinite(near->relative_distance));
        for (std::size_t c = 0; c < 4; ++c) {
            require(state.spread(c) > 0 && std::isfinite(state.spread(c)));
            (void)state.learn(c, touch);
        }
    }
}
void go_on(map& state) {
    for (const std::span<const float> numbers : {std::span<const float>(state.directions), {state.offset}})
        require(std::ranges::all_of(numbers, [](float number) { return std::isfinite(number); }));
}

template <class Format>
void go_on(stream<Format>& state) {
    std::array<float, 4> outputs;
    for (int frame = 0; frame < 20; ++frame) {
        require(state.trained().step(std::array{0.5F, -1.0F}, state.memory, outputs) ==
                tactnet::frame_status::ok);
        for (const float output : outputs)
            require(std::isfinite(output));
    }
}

template <class State>
void check(std::span<const std::byte> bytes) {
    State state;
    const auto before = saved(state);
    const bool taken = state.restore(bytes) == tactnet::restore_status::ok;
    if (!taken)
        return require(saved(state) == before);
    State again;
    require(again.restore(saved(state)) == tactnet::restore_status::ok && saved(again) == saved(state));
    go_on(state);
    require(again.restore(saved(state)) == tactnet::restore_status::ok);
}

template <class State>
void check_both(std::span<const std::uint8_t> input) {
    check<State>(std::as_bytes(input));
    check<State>(framed<State>(input));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::span input(data, size);
    constexpr std::array checks{check_both<health>, check_both<means>, check_both<map>,
                                check_both<float_stream>, check_both<byte_stream>};
    fuzz_forms(size, checks.size(), [&](std::size_t form) { checks[form](input); });
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    health worn;
    go_on(worn);
    means some;
    (void)some.learn(0, {1, 2}), (void)some.learn(0, {2, -3}), (void)some.learn(2, {0.5f, 0});
    std::vector<std::vector<std::uint8_t>> seeds;
    const auto add = [&](const auto& bytes) { // whole, and as what `framed` takes
        for (const std::size_t first : {std::size_t{0}, tactnet::detail::state_header_bytes}) {
            auto& seed = seeds.emplace_back();
            for (std::size_t i = first; i < bytes.size(); ++i)
                seed.push_back(std::to_integer<std::uint8_t>(bytes[i]));
        }
    };
    float_stream floats;
    byte_stream words;
    bool first = true; // ring of frames
    const auto turn = [&](auto& number, double) {
        if constexpr (std::is_same_v<decltype(number), std::uint32_t&>)
            number = std::exchange(first, false) ? 1 : 0;
    };
    tactnet::detail::visit_stream_state(words.memory, turn, [] { return 0.0; });
    add(saved(floats)), add(saved(words));
    add(saved(worn)), add(saved(some)), add(saved(map{{1, 2, 3, 4, 5, 6}, {-1, 0.5f}}));
    return seeds;
}
