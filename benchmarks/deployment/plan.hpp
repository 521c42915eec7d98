#pragma once

#include "../support/measure.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/training/initialise.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

// A deployed network layer by layer: what its plan is, how long each step takes among the others, and how
// long its convolution would take by another plan.

namespace benchmark {

/// A step that does something by itself, in a network.
struct layer_report {
    std::string what{};                      ///< "convolution 3 × 3, 32 filters, pool 2 × 2"
    std::string output{};                    ///< rows × columns × channels
    std::string plan{};                      ///< the method of a convolution and its tile
    std::string costs{};                     ///< of all applicable methods, in twentieths of a vector product
    std::size_t multiply_adds{};             ///< on real pixels
    std::size_t weight_bytes{}, map_bytes{}; ///< of the map that it writes
    double in_network{};                     ///< seconds, where it stands, all other steps around it
    double alone{};                          ///< seconds, again and again with the same input
    std::string other_plan{};                ///< another one that is possible
    double by_other{};                       ///< seconds alone by that one
};
struct network_report {
    std::string name{};
    std::vector<layer_report> layers{};
    double whole{};      ///< seconds of a call
    std::size_t bytes{}; ///< weights and maps that a frame passes
    bool right{};        ///< the steps one by one gave the bits of the call
};

struct plan_case {
    std::string name; ///< for example tactnet6/28x50
    std::function<network_report()> measure;
};
/// All networks of this program.
inline std::vector<plan_case>& plan_cases() {
    static std::vector<plan_case> cases;
    return cases;
}

/// Visits the steps of a network in the order in which it takes them, with what they read and write:
/// visit(step, packed, in, out, memory). A residual block is its skip, then the steps of its main branch.
template <class Step>
struct step_walk {
    template <class Visit>
    static void go(const float* packed, const float* in, float* out, float* memory, Visit&& visit) {
        visit(std::type_identity<Step>{}, packed, in, out, memory,
              [&] { Step::run(packed, in, out, memory); });
    }
};
template <class... Steps>
struct step_walk<tactnet::step_chain<Steps...>> {
    template <class Visit>
    static void go(const float* packed, const float* in, float* out, float* memory, Visit&& visit) {
        using chain = tactnet::step_chain<Steps...>;
        float* const inner = memory + chain::buffers * chain::buffer;
        std::size_t i = 0;
        const auto one = [&]<class Step>(std::type_identity<Step>) {
            float* const to = i + 1 == chain::size ? out : memory + i % 2 * chain::buffer;
            step_walk<Step>::go(packed, in, to, inner, visit);
            packed += Step::packed_elements, in = to, ++i;
        };
        (one(std::type_identity<Steps>{}), ...);
    }
};
template <class Main, class Skip, std::size_t Stride>
struct step_walk<tactnet::residual_step<Main, Skip, Stride>> {
    template <class Visit>
    static void go(const float* packed, const float* in, float* out, float* memory, Visit&& visit) {
        using block = tactnet::residual_step<Main, Skip, Stride>;
        if constexpr (!std::is_same_v<Skip, tactnet::no_step> && block::aside == 0)
            step_walk<Skip>::go(packed + Main::packed_elements, in, out, memory, visit);
        else
            visit(std::type_identity<Skip>{}, packed + Main::packed_elements, in, out, memory,
                  [&] { block::leave_skip(packed, in, out, memory); });
        step_walk<Main>::go(packed, in, out, memory, visit);
    }
};

[[nodiscard]] inline std::string extent_text(tactnet::extent2d e) {
    return std::to_string(e.rows) + " × " + std::to_string(e.columns);
}

/// The name of a method, and its tile.
template <class Method>
[[nodiscard]] std::string method_text() {
    return Method::name + (Method::tile == tactnet::extent2d(0) ? "" : " " + extent_text(Method::tile));
}

/// The description of a step.
template <class Step>
struct step_description {
    static constexpr bool convolves = false;
    static std::string what() {
        return std::is_same_v<Step, tactnet::no_step> ? "skip, copied" : "step without weights";
    }
    static std::string plan() { return ""; }
    static constexpr std::size_t multiply_adds = 0;
};
template <class Format, tactnet::kernels::frame_convolution C>
struct step_description<tactnet::convolution_step<Format, C>> {
    using step = tactnet::convolution_step<Format, C>;
    static constexpr bool convolves = true;
    static std::string what() {
        return "convolution " + extent_text(C.window.kernel) + ", " + std::to_string(C.filters) + " filters" +
               (C.pool == tactnet::extent2d(1) ? "" : ", pool " + extent_text(C.pool)) +
               (C.accumulates ? ", sum" : "");
    }
    static std::string plan() { return method_text<typename step::method>(); }
    static constexpr std::size_t multiply_adds =
        C.window.taps_on_pixels() * C.window.input.channels / C.groups * C.filters;
};
template <class Format, tactnet::kernels::frame_dense D>
struct step_description<tactnet::dense_step<Format, D>> {
    static constexpr bool convolves = false;
    static std::string what() { return "dense, " + std::to_string(D.outputs) + " outputs"; }
    static std::string plan() { return ""; }
    static constexpr std::size_t multiply_adds = D.outputs * D.input.size();
};

/// Seconds of body(), the fastest of some rounds of at least 50 µs each.
template <class Body>
[[nodiscard]] double seconds_of(Body&& body) {
    std::size_t repeats = 1;
    while (time_rounds(1, [&] {
               for (std::size_t r = 0; r < repeats; ++r)
                   body();
           }).fastest < 50e-6)
        repeats *= 2;
    return time_rounds(15,
                       [&] {
                           for (std::size_t r = 0; r < repeats; ++r)
                               body();
                       })
               .fastest /
           static_cast<double>(repeats);
}

/// Costs of the applicable methods, and the fastest that was not chosen: its name and seconds.
template <class Step>
void time_other_methods(layer_report& layer, const float* in, float* out) {
    namespace kernels = tactnet::kernels;
    static constexpr kernels::frame_convolution C = Step::kernel;
    const auto weight = [](std::size_t filter, std::size_t channel, std::size_t row, std::size_t column) {
        return 0.01f * static_cast<float>((filter * 7 + channel * 5 + row * 3 + column) % 11) - 0.05f;
    };
    const std::vector<float> biases(C.filters);
    const auto time = [&]<class Method>(std::type_identity<Method>) {
        if constexpr (!std::is_same_v<Method, typename Step::method>) {
            tactnet::aligned_vector<float> packed(Method::packed_elements),
                workspace(Method::workspace_elements);
            Method::pack(weight, biases.data(), packed.data());
            const double seconds =
                seconds_of([&] { Method::run(packed.data(), in, out + C.map_offset, workspace.data()); });
            if (layer.other_plan.empty() || seconds < layer.by_other)
                layer.other_plan = method_text<Method>(), layer.by_other = seconds;
        }
    };
    kernels::convolution_methods<C>::for_each_applicable(
        [&]<class Method>(std::type_identity<Method> method) {
            layer.costs += (layer.costs.empty() ? "" : ", ") + method_text<Method>() + " " +
                           std::to_string(Method::product_twentieths);
            if constexpr (!Step::layerwise)
                time(method);
        });
    if constexpr (!Step::layerwise && C.groups == 1) {
        for (const std::size_t bytes_per_cycle : {28, 14, 9}) {
            const tactnet::extent2d tile = kernels::best_tile(C, bytes_per_cycle);
            const bool tiles =
                tile != tactnet::extent2d(0) &&
                kernels::tile_costs::to_replace(kernels::direct_method<C>::product_twentieths) >
                    kernels::cost_by_tiles(C, tile, bytes_per_cycle);
            if (kernels::tile_possible(C, 2))
                layer.costs += "; " + std::to_string(bytes_per_cycle) +
                               " far bytes per cycle: " + (tiles ? extent_text(tile) : "direct");
        }
        const auto time_tile = [&]<std::size_t Rows, std::size_t Columns>(kernels::constant<Rows>,
                                                                          kernels::constant<Columns>) {
            constexpr tactnet::extent2d tile(Rows, Columns);
            if constexpr (tile != kernels::best_tile(C) && kernels::tile_possible(C, tile))
                time(std::type_identity<kernels::winograd_method<C, tile>>{});
        };
        time_tile(kernels::constant<2>{}, kernels::constant<2>{});
        time_tile(kernels::constant<2>{}, kernels::constant<3>{});
        time_tile(kernels::constant<2>{}, kernels::constant<4>{});
        time_tile(kernels::constant<3>{}, kernels::constant<3>{});
        time_tile(kernels::constant<3>{}, kernels::constant<4>{});
        time_tile(kernels::constant<4>{}, kernels::constant<2>{});
        time_tile(kernels::constant<4>{}, kernels::constant<3>{});
        time_tile(kernels::constant<4>{}, kernels::constant<4>{});
        time_tile(kernels::constant<5>{}, kernels::constant<3>{});
    }
}

/// A network as after training, measured.
template <class Network>
[[nodiscard]] network_report plan_of(const std::string& name) {
    using clock = std::chrono::steady_clock;
    Network network;
    tactnet::initialise(network, tactnet::he_normal{}, 1);
    const auto deployed = tactnet::deploy(network);
    using view = typename decltype(deployed)::view_type;
    using steps = typename view::steps;
    using input = tactnet::input_stage<tactnet::single_precision, Network::input_shape>;

    std::vector<float> frame(Network::input_shape.size()), expected(Network::outputs);
    tactnet::random_stream random(3, tactnet::random_purposes::order);
    for (float& count : frame)
        count = static_cast<float>(std::max(random.uniform(-100, 255), 0.0));
    const tactnet::tensor_view<const float, Network::input_shape> counts(frame.data());
    const std::span<float, Network::outputs> logits(expected.data(), Network::outputs);
    typename decltype(deployed)::workspace workspace;

    network_report report{.name = name};
    report.whole = seconds_of([&] { static_cast<void>(deployed.infer(counts, logits, workspace)); });

    tactnet::aligned_vector<float> packed(view::packed_elements), in(input::map),
        memory(steps::workspace_elements),
        out(tactnet::pad_to_cache_line<float>(steps::output.area() * steps::output_stride));
    view::pack(deployed.folded().data(), packed.data());
    const bool finite = input::read(packed.data(), frame.data(), in.data());
    const auto walk = [&](auto&& visit) {
        step_walk<steps>::go(packed.data() + input::packed_elements, in.data(), out.data(), memory.data(),
                             visit);
    };
    // Once to describe the steps, then again and again with the clock between them. What the clock itself
    // takes is subtracted.
    walk([&]<class Step>(std::type_identity<Step>, const float*, const float*, float*, float*, auto&& run) {
        run();
        layer_report layer{.what = step_description<Step>::what(), .plan = step_description<Step>::plan()};
        layer.multiply_adds = step_description<Step>::multiply_adds;
        layer.weight_bytes = Step::packed_elements * sizeof(float);
        layer.in_network = std::numeric_limits<double>::infinity();
        if constexpr (!std::is_same_v<Step, tactnet::no_step>) {
            const std::size_t elements = Step::output.area() * Step::output_stride;
            layer.output = std::to_string(Step::output.rows) + " × " + std::to_string(Step::output.columns) +
                           " × " + std::to_string(Step::output.channels);
            layer.map_bytes = elements * sizeof(float);
        }
        report.bytes += layer.weight_bytes + layer.map_bytes;
        report.layers.push_back(std::move(layer));
    });
    double of_clock = 1;
    for (int i = 0; i < 1000; ++i) {
        const auto start = clock::now();
        of_clock = std::min(of_clock, std::chrono::duration<double>(clock::now() - start).count());
    }
    const auto rounds = static_cast<std::size_t>(std::clamp(0.3 / report.whole, 50.0, 20'000.0));
    for (std::size_t round = 0; round < rounds; ++round) {
        std::size_t place = 0;
        walk([&](auto, const float*, const float*, float*, float*, auto&& run) {
            const auto start = clock::now();
            run();
            const double seconds = std::chrono::duration<double>(clock::now() - start).count() - of_clock;
            layer_report& layer = report.layers[place++];
            layer.in_network = std::min(layer.in_network, std::max(seconds, 0.0));
        });
    }
    report.right = finite && std::equal(expected.begin(), expected.end(), out.begin());
    std::size_t place = 0;
    walk([&]<class Step>(std::type_identity<Step>, const float*, const float* from, float* to, float*,
                         auto&& run) {
        run();
        layer_report& layer = report.layers[place++];
        if constexpr (step_description<Step>::convolves) {
            std::vector<float> kept(to, to + Step::output.area() * Step::output_stride);
            layer.alone = seconds_of(run);
            time_other_methods<Step>(layer, from, to);
            std::copy(kept.begin(), kept.end(), to); // what the next step reads
        }
    });
    return report;
}

} // namespace benchmark
