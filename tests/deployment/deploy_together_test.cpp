#include <tactnet/deployment.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <support/guarded_map.hpp>
#include <support/same_bits.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;

namespace {

/// Filters of a vector, and enough of them for large steps where vectors are short.
constexpr std::size_t vector = std::max<std::size_t>(kernels::lanes<float>, 8), wide = 2 * vector;
/// Every kind of large step, and small ones between.
using large_network =
    network<shape{40, 44, 3}, conv2d<wide, 5, 2>, batch_norm, relu, max_pool<3, 2, padding::valid>,
            residual<sequence<conv2d<2 * wide, 1>, batch_norm, relu, conv2d<wide, 3>, batch_norm>>, relu,
            conv2d<144 * vector, 1>, relu, max_pool<3, 3, padding::valid>, conv2d<4 * vector, 3>, dense<10>>;
/// What large networks are made of besides: branches side by side, groups, norms with moments of each frame,
/// a gate, a projection as skip; and a kernel of 2 × 2, whose tiles have nine elements.
using branched_network =
    network<shape{40, 44, 3}, conv2d<wide, 5, 2>, relu,
            concatenation<sequence<conv2d<wide, 1>, relu>, sequence<conv2d<wide, 3>, relu>>,
            conv2d<144 * vector, 1>, relu, max_pool<3, 3, padding::valid>,
            conv2d<wide, 3, 1, padding::same, in_groups(2)>, relu,
            conv2d<wide, 3, 1, padding::same, in_groups(wide)>, relu, group_norm<2>, relu,
            squeeze_excitation<wide, 4>, layer_norm<norm_over::channels>,
            residual<sequence<conv2d<16, 3>, relu, conv2d<16, 1>>, sequence<conv2d<16, 1>>>, relu,
            conv2d<8, 2, 1, padding::valid>, relu, dense<10>>;

/// Small steps with more weights than the second level of cache holds: a few frames pass together on each
/// thread, and a dense layer reads its weights once for them.
using heavy_network =
    network<shape{10, 18}, conv2d<8, 3>, relu, conv2d<32, 3>, relu, max_pool<2, 1, padding::same>,
            residual<sequence<conv2d<32, 3>, batch_norm>>, relu, dense<70>>;

/// The same where all is near: the tiles of four frames make one list, those left over pass alone.
using light_network =
    network<shape{9, 11}, conv2d<16, 3>, relu, max_pool<2>, conv2d<16, 3, 1, padding::same, in_groups(16)>,
            relu, conv2d<32, 3>, batch_norm, relu, max_pool<2>, dense<22>>;

/// Whether four frames on one thread make one list of tiles in some step.
template <class Step>
inline constexpr bool joins_tiles = false;
template <class... Steps>
inline constexpr bool joins_tiles<step_chain<Steps...>> = (joins_tiles<Steps> || ...);
template <kernels::frame_convolution C>
inline constexpr bool joins_tiles<convolution_step<single_precision, C>> = [] {
    using step = convolution_step<single_precision, C>;
    using executor = batch_executor<inline_executor<4>>;
    return step::method::frames_together == 4 && requires(float* numbers, const executor& four) {
        step::run_batch(numbers, numbers, std::size_t{}, numbers, numbers, four);
    };
}();

template <class Network>
std::unique_ptr<Network> random_network() {
    auto net = std::make_unique<Network>();
    std::uint64_t state = 3;
    net->for_each_parameter([&](const parameter& p, std::span<float> values) {
        for (float& value : values)
            value = p.role == parameter_role::running_variance
                        ? 1 + 0.5f * support::draw(state)
                        : support::draw(state) / std::sqrt(static_cast<float>(p.fan_in));
    });
    return net;
}

} // namespace

TEST_CASE_TEMPLATE("deployed: frames together, on any number of threads, leave the bits of each alone",
                   Network, large_network, branched_network, heavy_network, light_network) {
    const auto net = random_network<Network>();
    const auto fast = deploy(*net);
    using form = deployed<Network>;
    constexpr bool light = std::is_same_v<Network, light_network>;
    static_assert(form::view_type::layerwise == !(light || std::is_same_v<Network, heavy_network>));
    static_assert((form::weight_bytes > kernels::l2_cache_bytes) == !light);
    if constexpr (light) {
        static_assert(detail::batch_inference<typename form::view_type>::on_one_thread == 4);
        static_assert(joins_tiles<typename form::view_type::steps>);
    }
    constexpr std::size_t frames = 19, size = form::input_shape.size(), outputs = form::outputs;
    std::uint64_t state = 5;
    std::vector<float> counts(frames * size), alone(frames * outputs);
    for (float& value : counts)
        value = support::draw(state);
    const auto memory = std::make_unique<typename form::workspace>();
    for (std::size_t f = 0; f < frames; ++f)
        CHECK(fast.infer(tensor_view<const float, form::input_shape>(counts.data() + f * size),
                         std::span<float, outputs>(alone.data() + f * outputs, outputs),
                         *memory) == frame_status::ok);
    [[maybe_unused]] batch_workspace kept;
    for (const std::size_t threads : {1U, 2U, 3U}) {
        thread_pool pool(threads);
        for (const std::size_t some : {std::size_t{1}, std::size_t{2}, std::size_t{8}, frames}) {
            CAPTURE(threads);
            CAPTURE(some);
            std::vector<float> together(some * outputs, NAN);
            CHECK(fast.infer(std::span<const float>(counts.data(), some * size), std::span<float>(together),
                             pool) == frame_status::ok);
            const std::vector<float> first(alone.begin(),
                                           alone.begin() + static_cast<std::ptrdiff_t>(some * outputs));
            CHECK(support::numbers_that_differ(together, first) == 0);
            if constexpr (form::view_type::layerwise) {
                std::fill(together.begin(), together.end(), NAN);
                CHECK(fast.infer(std::span<const float>(counts.data(), some * size),
                                 std::span<float>(together), pool, kept) == frame_status::ok);
                CHECK(support::numbers_that_differ(together, first) == 0);
            }
        }
        // A broken frame among others is reported.
        std::vector<float> broken = counts;
        broken[3 * size + 7] = std::numeric_limits<float>::infinity();
        std::vector<float> to(frames * outputs);
        CHECK(fast.infer(std::span<const float>(broken), std::span<float>(to), pool) ==
              frame_status::not_finite);
        CHECK_THROWS_AS(
            (void)fast.infer(std::span<const float>(counts.data(), size + 1), std::span<float>(to), pool),
            const std::invalid_argument&);
    }
}
