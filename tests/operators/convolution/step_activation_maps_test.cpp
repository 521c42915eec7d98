#include "activation_trial.hpp"

#include <tactnet/operators/activations/piecewise.hpp>
#include <tactnet/operators/activations/smooth.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

// A fused activation function where the map it follows has an edge of its own: channels of other steps next
// to it, and pools that the map cuts.

using namespace tactnet;

using kernels::frame_convolution;
using namespace support;

namespace {

constexpr frame_convolution in_slice(frame_convolution c, std::size_t map_stride, std::size_t map_offset) {
    c.map_stride = map_stride, c.map_offset = map_offset;
    return c;
}

/// Values of a function as a convolution computes them: in vectors, unless it is a ReLU.
using vector_of_floats = std::array<float, kernels::lanes<float>>;
template <class Function>
void apply(vector_of_floats& values) {
    if constexpr (fused<Function>->rectifies) {
        for (float& value : values)
            value = Function::value(value);
    } else {
        const auto x = kernels::vector<float>::load_unaligned(values.data());
        kernels::vector<float>(Function::value(x)).store_unaligned(values.data());
    }
}
template <class Function>
float value_of(float x) {
    vector_of_floats values{x};
    apply<Function>(values);
    return values[0];
}

template <frame_convolution C>
void check_method(std::string_view method) {
    if (kernels::vector_registers >= 32 && kernels::lanes<float> == 16)
        CHECK(std::string_view(trial<C>::step::method::name) == method);
}

/// The neighbours hold ordinary numbers: NaN would stay NaN if the function were applied to it.
template <class Function, frame_convolution C>
void compare_slice(std::string_view method) {
    CAPTURE(Function::name);
    CAPTURE(method);
    check_method<with<Function>(C)>(method);
    trial<C> separate;
    trial<with<Function>(C)> together;
    const auto held = support::drawn(separate.out.size(), 2, 7);
    std::copy(held.begin(), held.end(), separate.out.begin());
    std::copy(held.begin(), held.end(), together.out.begin());
    separate.run();
    for (std::size_t pixel = 0; pixel < C.output_rows() * C.output_columns(); ++pixel)
        for (std::size_t filter = 0; filter < C.filters; ++filter) {
            float& x = separate.out[pixel * C.map_stride + C.map_offset + filter];
            x = value_of<Function>(x);
        }
    CHECK(same_bits(together.run().out, separate.out));
}

template <class Function>
void compare_slices() {
    compare_slice<Function, in_slice(step({7, 9, 6}, 5, 16, 16), 48, 16)>("direct");
    compare_slice<Function, in_slice(step({5, 6, 8}, 1, 24, 16), 64, 24)>("direct"); // in narrower vectors
    compare_slice<Function, in_slice(step({5, 6, 8}, 1, 4, 16), 20, 4)>("direct");
    compare_slice<Function, in_slice(adding(step({5, 6, 16}, 1, 32, 16)), 64, 32)>("direct");
    compare_slice<Function, in_slice(pooled_before(step({9, 11, 3}, 5, 16, 16), 2), 32, 0)>("direct");
    compare_slice<Function, in_slice(step({14, 25, 32}, 3, 32, 32), 96, 32)>("Winograd");
    compare_slice<Function, in_slice(pooled_before(step({13, 21, 16}, 3, 32, 16), 2), 64, 16)>("Winograd");
    compare_slice<Function, in_slice(in_groups(step({9, 11, 16}, 3, 16, 16), 16), 48, 16)>("depthwise");
    compare_slice<Function, in_slice(in_groups(step({6, 9, 32}, 5, 64, 32, 2), 2), 128, 32)>(
        "group by group");
    compare_slice<Function, in_slice(step({28, 50, 16}, 3, 64, 16), 96, 16)>("panels");
    compare_slice<Function, in_slice(step({29, 30, 16}, 5, 64, 16), 128, 64)>("panels");
}

} // namespace

TEST_CASE("convolution_step: an activation function leaves the neighbours of a slice untouched") {
    static_assert(!fused<silu_function>->in_registers && fused<hard_swish_function>->in_registers);
    compare_slices<silu_function>();
    compare_slice<hard_swish_function, in_slice(step({7, 9, 6}, 5, 16, 16), 48, 16)>("direct");
}

namespace {

/// The pool before the function, as fused: then each in a step of its own.
template <class Function, frame_convolution C>
void compare_pooled(std::string_view method) {
    CAPTURE(Function::name);
    CAPTURE(method);
    check_method<with<Function>(C)>(method);
    trial<C> separate;
    CHECK(same_bits(trial<with<Function>(C)>().run().out, separate.run().template then<Function>().out));
}
/// By all methods: pools whose last windows the map cuts, and pools that leave out the last pixels.
template <class Function, bool Whole>
void compare_cut_pools() {
    compare_pooled<Function, pooled_before(step({9, 23, 1}, 3, 8, 1), 2, Whole)>("packed pixels");
    compare_pooled<Function, pooled_before(step({10, 11, 3}, 5, 20, 16), {3, 2}, Whole)>("direct");
    compare_pooled<Function, pooled_before(step({13, 21, 16}, 3, 32, 16), 2, Whole)>("Winograd");
    compare_pooled<Function, pooled_before(in_groups(step({9, 11, 32}, 3, 32, 32), 32), 2, Whole)>(
        "depthwise");
    compare_pooled<Function, pooled_before(step({31, 41, 32}, 3, 64, 32), 2, Whole)>("panels");
}

/// The function before the pool, as layers are listed, each in a step of its own.
template <class Function, frame_convolution C, extent2d Pool, bool Whole>
void compare_exchanged() {
    CAPTURE(Function::name);
    static_assert(fused<Function>->monotonic);
    using alone = typename trial<C>::step;
    constexpr sliding_window window =
        sliding_window::over(alone::output, Pool, Pool, Whole ? padding::valid : ceil_mode());
    using pool = pool_step<single_precision, window, alone::output_stride>;
    using at_once = trial<with<Function>(pooled_before(C, Pool, Whole))>;
    static_assert(at_once::step::output == pool::output);
    trial<C> separate;
    separate.run().template then<Function>();
    aligned_vector<float> expected(at_once::out_size);
    pool::run(nullptr, separate.out.data(), expected.data(), nullptr);
    CHECK(same_bits(at_once().run().out, expected));
}
template <class Function>
void compare_exchanged_at_edges() {
    // By tiles, sums may be rounded otherwise with a pool: by taps.
    constexpr frame_convolution taps = step({10, 11, 3}, 5, 16, 16);
    compare_exchanged<Function, taps, extent2d(3, 2), false>();
    compare_exchanged<Function, taps, extent2d(3, 2), true>();
    compare_exchanged<Function, taps, 2, false>();
}

/// The numbers of a float's order, from −∞ to ∞, with −0 before 0.
constexpr std::int64_t place_of(float x) {
    const auto bits = detail::bits_as<std::uint32_t>(x);
    const auto magnitude = static_cast<std::int64_t>(bits & 0x7fffffffU);
    return bits == static_cast<std::uint32_t>(magnitude) ? magnitude : -1 - magnitude;
}
constexpr float at_place(std::int64_t place) {
    return place < 0 ? -detail::bits_as<float>(static_cast<std::uint32_t>(-1 - place))
                     : detail::bits_as<float>(static_cast<std::uint32_t>(place));
}

/// How many of `count` floats from `x` on have a smaller value than the float before.
template <class Function>
std::size_t decreases(float x, std::size_t count) {
    vector_of_floats values;
    const std::int64_t last = place_of(std::numeric_limits<float>::infinity());
    float before = -std::numeric_limits<float>::infinity();
    std::size_t found = 0;
    std::int64_t place = place_of(x);
    for (std::size_t i = 0; i < count; i += values.size()) {
        for (float& value : values)
            value = at_place(std::min(place++, last));
        apply<Function>(values);
        for (const float value : values) {
            found += !(value >= before);
            before = value;
        }
    }
    return found;
}
/// How many floats have a smaller value than the float before, among 100 000 at each corner of a function of
/// the library, an eighth of those between 2⁻¹⁰ and 16 in magnitude, where the other functions bend, and a
/// thousandth of all.
template <class Function>
std::size_t decreases() {
    std::size_t found = 0;
    for (const float corner : {-3.0F, 0.0F, 3.0F, 6.0F})
        found += decreases<Function>(at_place(place_of(corner) - 50'000), 100'000);
    for (std::int64_t place = place_of(0x1p-10F); place < place_of(16); place += 8192)
        found += decreases<Function>(at_place(place), 1024) + decreases<Function>(at_place(-place), 1024);
    // From one run to the next values must not fall either.
    const float infinite = std::numeric_limits<float>::infinity();
    float below = -infinite;
    for (std::int64_t place = place_of(-infinite); place < place_of(infinite);
         place += std::int64_t{1} << 20) {
        found += decreases<Function>(at_place(place), 1024);
        const float value = value_of<Function>(at_place(place));
        found += !(value >= below);
        below = value;
    }
    return found;
}

} // namespace

TEST_CASE("convolution_step: an activation function after pools that the map cuts") {
    compare_cut_pools<silu_function, false>();
    compare_cut_pools<silu_function, true>();
    compare_cut_pools<hard_swish_function, false>();
}

TEST_CASE_TEMPLATE("convolution_step: a monotonic function gives the same bits before a pool and after it",
                   Function, relu_function, leaky_relu_function<10>, relu6_function, hard_sigmoid_function) {
    compare_exchanged_at_edges<Function>();
}

TEST_CASE_TEMPLATE("fused: a function that says it is monotonic never decreases, as computed", Function,
                   relu_function, leaky_relu_function<1>, leaky_relu_function<10>, leaky_relu_function<200>,
                   leaky_relu_function<999>, relu6_function, hard_sigmoid_function) {
    static_assert(fused<Function>->monotonic);
    CAPTURE(Function::name);
    CHECK(decreases<Function>() == 0);
}

TEST_CASE_TEMPLATE("fused: functions with a minimum do not say that they are monotonic", Function,
                   hard_swish_function, silu_function, gelu_function) {
    CHECK(decreases<Function>() > 0);
    CHECK_FALSE(fused<Function>->monotonic);
}
