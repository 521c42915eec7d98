#include "activation_trial.hpp"

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <type_traits>
#include <vector>

// An activation function in the epilogue of a convolution gives the bits of the function in a step of its
// own, whatever the method and the epilogue.

using namespace tactnet;

using kernels::frame_convolution;
using namespace support;

namespace {

template <class Function, frame_convolution C>
void compare(std::string_view method) {
    CAPTURE(Function::name);
    CAPTURE(method);
    using fused_trial = trial<with<Function>(C)>;
    if (kernels::vector_registers >= 32 && kernels::lanes<float> == 16)
        CHECK(std::string_view(fused_trial::step::method::name) == method);
    trial<C> separate;
    separate.run();
    const aligned_vector<float> before = separate.out;
    separate.template then<Function>();
    CHECK_FALSE(same_bits(separate.out, before));
    CHECK(same_bits(fused_trial().run().out, separate.out));
}

/// One function by all methods, with all epilogues.
template <class Function>
void compare_methods() {
    compare<Function, step({9, 23, 1}, 5, 8, 1)>("packed pixels");
    compare<Function, pooled_before(step({9, 23, 1}, 3, 8, 1), 2)>("packed pixels");
    compare<Function, step({7, 9, 6}, 3, 24, 16, extent2d(2, 1))>("direct");
    compare<Function, adding(step({5, 6, 16}, 1, 40, 16))>("direct");
    compare<Function, pooled_before(step({9, 11, 3}, 5, 20, 16), 2)>("direct");
    compare<Function, step({14, 25, 32}, 3, 32, 32)>("Winograd");
    compare<Function, step({17, 23, 32}, 3, 32, 32)>("Winograd"); // bands end within a row of tiles
    compare<Function, adding(step({13, 9, 32}, 3, 48, 32))>("Winograd");
    compare<Function, pooled_before(step({13, 21, 16}, 3, 32, 16), 2)>("Winograd");
    compare<Function, in_groups(step({9, 11, 16}, 3, 16, 16), 16)>("depthwise");
    compare<Function, pooled_before(in_groups(step({9, 11, 32}, 3, 32, 32), 32), 2)>("depthwise");
    compare<Function, in_groups(step({6, 9, 32}, 5, 64, 32, 2), 2)>("group by group");
    compare<Function, step({28, 50, 16}, 3, 64, 16)>("panels");
    compare<Function, pooled_before(step({30, 41, 32}, 3, 64, 32), 2)>("panels");
    compare<Function, adding(step({30, 30, 64}, 1, 96, 64))>("panels");
    compare<Function, step({29, 30, 16}, 5, 64, 16)>("panels");
}

} // namespace

TEST_CASE(
    "convolution_step: an activation function is bit-identical with a step of its own, by all methods") {
    compare_methods<hard_swish_function>(); // in registers
    compare_methods<silu_function>();       // on stored outputs
}

TEST_CASE_TEMPLATE("convolution_step: each activation function", Function, relu_function,
                   leaky_relu_function<10>, leaky_relu_function<200>, relu6_function, hard_sigmoid_function,
                   sigmoid_function, hyperbolic_tangent_function, elu_function<1000>, elu_function<300>,
                   softplus_function, gelu_function) {
    compare<Function, step({5, 7, 3}, 3, 16, 16)>("direct");
    compare<Function, adding(step({13, 9, 32}, 3, 48, 32))>("Winograd");
    CHECK(fused<Function>->output_bound(3) >= 3);
    using own = activation_step<single_precision, Function, shape{1, 1, 1}, 1>;
    CHECK(fused<Function>->output_bound(0.5) == own::output_bound(nullptr, 0.5));
    CHECK(fused<Function>->largest_value == own::largest_output);
}

TEST_CASE(
    "convolution_step: activation functions of several frames by Winograd, and in the shares of threads") {
    constexpr frame_convolution tiles = with<gelu_function>(step({7, 6, 16}, 3, 16, 16));
    using method = trial<tiles>::step::method;
    if constexpr (method::frames_together > 1) {
        constexpr std::size_t frames = method::frames_together;
        trial<tiles> together(frames);
        aligned_vector<float> workspace(frames * method::workspace_elements + 1);
        method::run_frames(together.packed.data(), together.in.data(), trial<tiles>::in_size,
                           together.out.data(), trial<tiles>::out_size, workspace.data());
        for (std::size_t f = 0; f < frames; ++f) {
            trial<tiles> one;
            std::copy_n(together.in.data() + f * trial<tiles>::in_size, trial<tiles>::in_size, one.in.data());
            one.run();
            CHECK(
                std::equal(one.out.begin(), one.out.end(), together.out.data() + f * trial<tiles>::out_size));
        }
    }
    const auto in_shares = []<frame_convolution C>(trial<C> one) {
        using large = typename trial<C>::step;
        const aligned_vector<float> whole = trial<C>().run().out;
        if constexpr (large::layerwise) {
            for (std::size_t thread = 0; thread < 3; ++thread) {
                aligned_vector<float> workspace(large::workspace_elements + 1);
                large::run_share(one.packed.data(), one.in.data(), one.out.data(), workspace.data(),
                                 {.share = {thread, 3}});
            }
            CHECK(same_bits(one.out, whole));
        }
    };
    in_shares(trial<with<elu_function<1000>>(step({28, 50, 16}, 3, 64, 16))>());
    in_shares(trial<with<elu_function<1000>>(step({29, 30, 16}, 5, 64, 16))>());
    in_shares(trial<with<elu_function<1000>>(step({3, 3, 256}, 3, 192, 256))>());
}

TEST_CASE("convolution_step: which lists of layers fuse an activation function") {
    const auto count = []<class... Steps>(std::type_identity<step_chain<Steps...>>) {
        return sizeof...(Steps);
    };
    // Before a dense layer.
    const auto steps = [&]<class... Layers>() {
        using list = lowered_network<network<shape{8, 9, 2}, Layers..., dense<3>>>;
        return count(std::type_identity<typename list::step>{}) - 1;
    };
    CHECK(steps.operator()<conv2d<6, 3>, batch_norm, gelu>() == 1);
    CHECK(steps.operator()<conv2d<6, 3>, max_pool<2>, gelu>() == 1);
    // A maximum and a monotonic function may change places; GELU is not monotonic, and tanh not as rounded.
    CHECK(steps.operator()<conv2d<6, 3>, leaky_relu<>, max_pool<2>>() == 1);
    CHECK(steps.operator()<conv2d<6, 3>, gelu, max_pool<2>>() == 2);
    CHECK(steps.operator()<conv2d<6, 3>, hyperbolic_tangent, max_pool<2>>() == 2);
    // Lanes without a filter must stay zero.
    CHECK(steps.operator()<conv2d<6, 3>, sigmoid>() == 2);
    CHECK(steps.operator()<conv2d<16, 3>, sigmoid>() == 1);
    // One function; a norm comes before it.
    CHECK(steps.operator()<conv2d<6, 3>, relu6, gelu>() == 2);
    CHECK(steps.operator()<conv2d<6, 3>, relu, relu>() == 1);
    CHECK(steps.operator()<conv2d<6, 3>, silu, batch_norm>() == 2);
    CHECK(steps.operator()<transposed_conv2d<6, 3, 1>, batch_norm, silu>() == 1);
    CHECK(steps.operator()<residual<conv2d<2, 3>>, silu>() == 1);
}

TEST_CASE("residual_step::output_bound: the function follows the sum of both branches") {
    constexpr kernels::frame_convolution last{.window = {{2, 3, 4}, 1, 1},
                                              .filters = 4,
                                              .input_stride = 4,
                                              .activation = fused<elu_function<5000>>,
                                              .accumulates = true};
    using step = residual_step<convolution_step<single_precision, last>, no_step, 4>;
    std::vector<float> folded(step::folded_elements);
    for (std::size_t filter = 0; filter < 4; ++filter)
        folded[5 * filter] = 1; // the identity: the sum of -0.1 and -0.1, of which the function is -0.91
    CHECK(step::output_bound(folded.data(), 0.1) >= -elu_function<5000>::value(-0.2));
}
