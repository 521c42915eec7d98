#pragma once

// What the tests of deployed networks share: networks full of numbers, frames, and the description of a
// network that the bound of its errors is derived from (support/layers/deployment_bound.hpp).

#include <tactnet/deployment.hpp>
#include <tactnet/networks/network.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <support/layers/deployment_bound.hpp>
#include <support/layers/window_of.hpp>
#include <type_traits>
#include <vector>

namespace support {

/// Numbers spread evenly over [low, high), the same everywhere (Knuth's 64-bit generator).
class numbers {
public:
    explicit numbers(std::uint64_t seed) : state_(seed * 2 + 1) { next(0, 1), next(0, 1); }
    float next(float low, float high) {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return low + (high - low) * static_cast<float>(state_ >> 40) * 0x1p-24f;
    }

private:
    std::uint64_t state_;
};

/// No parameter is left at a value that would hide a mistake: no zero, no one, norms of both signs.
template <class Network>
void fill(Network& net, std::uint64_t seed) {
    numbers draw(seed);
    net.for_each_parameter([&](const tactnet::parameter& p, auto values) {
        using tactnet::parameter_role;
        const float spread =
            p.what == parameter_role::weight ? std::sqrt(6.0f / static_cast<float>(p.fan_in)) : 0.5f;
        for (float& value : values) {
            value = draw.next(-spread, spread);
            if (p.what == parameter_role::running_variance)
                value = 0.3f + 2 * std::abs(value);
            if (p.what == parameter_role::scale)
                value += value < 0 ? -0.7f : 0.7f;
        }
    });
}

/// Counts of a frame as a sensor may give them: most of it untouched.
inline std::vector<std::uint8_t> make_frame(std::size_t size, std::uint64_t seed) {
    numbers draw(seed + 1000);
    std::vector<std::uint8_t> counts(size);
    for (std::uint8_t& c : counts)
        c = static_cast<std::uint8_t>(std::max(0.0f, draw.next(-100, 256)));
    return counts;
}

/// Layers of a list, as the bound wants them.
template <class Spec>
struct description;

template <std::size_t Filters, tactnet::extent2d Kernel, tactnet::extent2d Stride, tactnet::padding Padding,
          tactnet::conv2d_options Options>
struct description<tactnet::conv2d<Filters, Kernel, Stride, Padding, Options>> {
    static described_layer on(tactnet::shape in) {
        return {.what = described_layer::kind::convolution,
                .window = window_of(tactnet::sliding_window::over(in, Kernel, Stride, Padding)),
                .filters = Filters,
                .groups = Options.groups,
                .bias = Options.bias};
    }
};
template <tactnet::extent2d Window, tactnet::extent2d Stride, tactnet::padding Padding>
struct description<tactnet::max_pool<Window, Stride, Padding>> {
    static described_layer on(tactnet::shape in) {
        return {.what = described_layer::kind::pool,
                .window = window_of(tactnet::sliding_window::over(in, Window, Stride, Padding))};
    }
};
inline described_layer described_average(tactnet::shape in, const tactnet::average_windows& windows) {
    described_layer layer{.what = described_layer::kind::average,
                          .average_output = {in.channels, windows.rows.outputs, windows.columns.outputs}};
    windows.for_each(
        [&](std::size_t, tactnet::pixel_range rows, tactnet::pixel_range columns, std::size_t divisor) {
            std::vector<std::size_t>& pixels = layer.average_pixels.emplace_back();
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x)
                    pixels.push_back(y * in.columns + x);
            layer.average_divisors.push_back(static_cast<double>(divisor));
        });
    return layer;
}
template <tactnet::extent2d Window, tactnet::extent2d Stride, tactnet::padding Padding,
          tactnet::average_over Over>
struct description<tactnet::average_pool<Window, Stride, Padding, Over>> {
    static described_layer on(tactnet::shape in) {
        const auto window = tactnet::sliding_window::over(in, Window, Stride, Padding);
        return described_average(in, tactnet::detail::average_windows_of(window, Padding, Over));
    }
};
template <tactnet::extent2d Output>
struct description<tactnet::adaptive_average_pool<Output>> {
    static described_layer on(tactnet::shape in) {
        return described_average(in, tactnet::detail::adaptive_windows<Output.rows, Output.columns>(in));
    }
};
template <class Offset>
struct description<tactnet::square_root<Offset>> {
    static described_layer on(tactnet::shape in) {
        return {.what = described_layer::kind::own,
                .own =
                    [](rounded_map map, std::span<const float>) {
                        constexpr double offset = tactnet::square_root<Offset>::offset;
                        for (rounded& x : map) {
                            const double value = std::max(x.value, 0.0);
                            const double steepest = 0.5 / std::sqrt(std::max(value - x.error, 0.0) + offset);
                            const double likely = 0.5 / std::sqrt(value + offset);
                            const double root = std::sqrt(value + offset) - std::sqrt(offset);
                            x = {root, x.error * steepest, x.deviation * likely};
                            // Six roundings: offset, its sum with the input, two roots, their sum, a
                            // quotient.
                            constexpr double roundings = 6;
                            x.error += accumulated(unit_roundoff<float> * (1 + 0x1p-20), roundings) *
                                       (root + x.error);
                            x.deviation =
                                std::hypot(x.deviation, std::sqrt(roundings) * unit_roundoff<float> * root);
                        }
                        return map;
                    },
                .own_output = {in.channels, in.rows, in.columns}};
    }
};
template <std::size_t Size, class Alpha, class Beta, class K>
struct description<tactnet::local_response_norm<Size, Alpha, Beta, K>> {
    static described_layer on(tactnet::shape in) {
        const auto value = [](auto over, auto under) {
            return static_cast<double>(over) / static_cast<double>(under);
        };
        return {.what = described_layer::kind::responses,
                .response_channels = in.channels,
                .response_size = Size,
                .response_share = value(Alpha::num, Alpha::den) / static_cast<double>(Size),
                .response_beta = value(Beta::num, Beta::den),
                .response_k = value(K::num, K::den)};
    }
};
template <tactnet::name_text Name, class Spec>
struct description<tactnet::named<Name, Spec>> : description<Spec> {};
template <class... Branches>
struct description<tactnet::concatenation<Branches...>> {
    static described_layer on(tactnet::shape in) {
        return {.what = described_layer::kind::concatenation,
                .branches = {description<tactnet::as_sequence<Branches>>::on(in)...}};
    }
};
template <std::size_t Outputs>
struct description<tactnet::dense<Outputs>> {
    static described_layer on(tactnet::shape in) {
        return {.what = described_layer::kind::dense,
                .window = window_of({in, {in.rows, in.columns}, 1}),
                .filters = Outputs};
    }
};
template <>
struct description<tactnet::batch_norm> {
    static described_layer on(tactnet::shape in) {
        return {.what = described_layer::kind::norm, .filters = in.channels};
    }
};
template <>
struct description<tactnet::softmax> {
    static described_layer on(tactnet::shape in) {
        return {.what = described_layer::kind::softmax, .filters = in.channels};
    }
};
template <>
struct description<tactnet::relu> {
    static described_layer on(tactnet::shape) { return {.what = described_layer::kind::relu}; }
};
template <unsigned Percent>
struct description<tactnet::dropout<Percent>> {
    static described_layer on(tactnet::shape) { return {.what = described_layer::kind::dropout}; }
};
template <class... Specs>
struct description<tactnet::sequence<Specs...>> {
    static std::vector<described_layer> list([[maybe_unused]] tactnet::shape in) {
        std::vector<described_layer> layers;
        ((layers.push_back(description<Specs>::on(in)), in = behind(layers.back(), in)), ...);
        return layers;
    }
    static described_layer on(tactnet::shape in) {
        return {.what = described_layer::kind::list, .inner = list(in)};
    }
    /// By the rules of the reference, not those of the library.
    static tactnet::shape behind(const described_layer& layer, tactnet::shape in) {
        using kind = described_layer::kind;
        if (layer.what == kind::convolution || layer.what == kind::dense || layer.what == kind::pool)
            return {layer.window.output_rows(), layer.window.output_columns(),
                    layer.what == kind::pool ? in.channels : layer.filters};
        if (layer.what == kind::average)
            return {layer.average_output.rows, layer.average_output.columns, layer.average_output.channels};
        if (layer.what == kind::own && layer.own_output.size() > 0)
            return {layer.own_output.rows, layer.own_output.columns, layer.own_output.channels};
        if (layer.what == kind::concatenation) {
            tactnet::shape all{0, 0, 0};
            for (const described_layer& branch : layer.branches) {
                const tactnet::shape own = behind(branch, in);
                all = {own.rows, own.columns, all.channels + own.channels};
            }
            return all;
        }
        for (const described_layer& each : layer.inner)
            in = behind(each, in);
        return in;
    }
};
template <class Main, class Skip>
struct description<tactnet::residual<Main, Skip>> {
    static described_layer on(tactnet::shape in) {
        return {.what = described_layer::kind::residual,
                .inner = description<tactnet::as_sequence<Main>>::list(in),
                .skip = description<tactnet::as_sequence<Skip>>::list(in)};
    }
};

/// The tiles of all convolutions of a step, in the order of their parameters.
template <class Step>
void append_tiled(std::vector<tile_size>& list) {
    const auto append = [&]<class Argument>(const Argument&) {
        if constexpr (tactnet::detail::is_inner_step<Argument>)
            append_tiled<typename Argument::step>(list);
        else if constexpr (std::is_same_v<Argument, tactnet::kernels::frame_convolution>)
            list.push_back({Step::method::tile.rows, Step::method::tile.columns});
    };
    tactnet::step_description<Step>::visit(
        [&](const char*, const char*, const auto&... arguments) { (append(arguments), ...); });
}
inline void mark_tiled(std::vector<described_layer>& layers, const std::vector<tile_size>& tiled,
                       std::size_t& at) {
    for (described_layer& layer : layers) {
        if (layer.what == described_layer::kind::convolution)
            layer.tiled = tiled.at(at++);
        mark_tiled(layer.inner, tiled, at);
        mark_tiled(layer.skip, tiled, at);
        mark_tiled(layer.branches, tiled, at);
    }
}
template <class Network>
std::vector<described_layer> describe() {
    auto layers = description<typename Network::specification>::list(Network::input_shape);
    std::vector<tile_size> tiled;
    append_tiled<typename tactnet::lowered_network<Network>::step>(tiled);
    std::size_t at = 0;
    mark_tiled(layers, tiled, at);
    return layers;
}

template <class Network>
described_parameters parameters_of(const Network& net) {
    return {net.learnable_values(), net.running_statistics(), net.epsilon};
}

/// The largest error of an output ÷ its bound, at most 1 if all is well, and ÷ its deviation. Infinite for
/// what is not a number, and for a wrong count of outputs.
struct error_shares {
    double of_bound = 0, of_deviation = 0;

    void add(const error_shares& other) {
        of_bound = std::max(of_bound, other.of_bound);
        of_deviation = std::max(of_deviation, other.of_deviation);
    }
    /// Errors stay well below their deviation, which takes every partial sum for as large as all its terms
    /// together.
    [[nodiscard]] bool good() const { return of_bound <= 1 && of_deviation <= 1; }
};
inline std::ostream& operator<<(std::ostream& to, const error_shares& s) {
    return to << "largest error " << s.of_bound << " of its bound, " << s.of_deviation << " of its deviation";
}

inline error_shares shares_of(std::span<const float> found, const rounded_map& expected) {
    if (found.size() != expected.size())
        return {INFINITY, INFINITY};
    error_shares worst;
    for (std::size_t o = 0; o < found.size(); ++o) {
        const double error = std::abs(static_cast<double>(found[o]) - expected[o].value);
        if (!std::isfinite(error))
            return {INFINITY, INFINITY};
        if (error > 0)
            worst.add({error / expected[o].error, error / expected[o].deviation});
    }
    return worst;
}

/// Deploys a network of that kind, full of numbers, and gives the largest errors over some frames.
template <class Network>
error_shares errors_of(std::uint64_t seed, std::size_t frames, float scale = 1.0f / 64) {
    Network net;
    fill(net, seed);
    constexpr std::size_t size = Network::input_shape.size();
    std::vector<float> mean(size);
    numbers draw(seed + 7);
    for (float& m : mean)
        m = draw.next(0, 60);
    const auto fast = tactnet::deploy(net, std::span<const float, size>(mean), scale);
    const std::vector<described_layer> layers = describe<Network>();
    error_shares worst;
    for (std::size_t i = 0; i < frames; ++i) {
        const std::vector<std::uint8_t> counts = make_frame(size, seed * 100 + i);
        const std::vector<float> exact(counts.begin(), counts.end());
        std::vector<float> out(Network::outputs, NAN);
        const auto status =
            fast.infer(tactnet::tensor_view<const std::uint8_t, Network::input_shape>(counts.data()),
                       std::span<float, Network::outputs>(out));
        if (status != tactnet::frame_status::ok)
            return {INFINITY, INFINITY};
        const rounded_map expected =
            bounded_outputs(layers, parameters_of(net), bounded_input(exact, mean, scale));
        worst.add(shares_of(out, expected));
    }
    return worst;
}

} // namespace support
