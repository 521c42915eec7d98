#pragma once

#include <tactnet/deployment/step_chain.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

// How the parameters of layers become those of steps. Each class here names the step of some layers (`step`)
// and has `fold`, which works in double precision and rounds once. `Layers` is the list that the layers stand
// in, a number is a place in that list.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Where the parameters of a list of layers are.
struct parameter_source {
    const float* values;
    const float* statistics;
    double epsilon;

    /// Those of a list or a layer inside.
    [[nodiscard]] parameter_source behind(std::size_t parameters, std::size_t statistics_before) const {
        return {values + parameters, statistics + statistics_before, epsilon};
    }
};

/// No layer of that kind.
inline constexpr std::size_t no_layer = static_cast<std::size_t>(-1);

/// A batch norm with its running statistics: x · factor + offset.
template <class Layers, std::size_t Norm>
class norm_constants {
public:
    explicit norm_constants(const parameter_source& list)
        : from_(list.behind(Layers::template parameter_offset<Norm>,
                            Layers::template statistic_offset<Norm>)) {}
    [[nodiscard]] double factor(std::size_t channel) const {
        return static_cast<double>(from_.values[channel]) /
               std::sqrt(static_cast<double>(from_.statistics[channels + channel]) + from_.epsilon);
    }
    /// What becomes of a bias in front of the norm.
    [[nodiscard]] double shifted(std::size_t channel, double bias) const {
        return (bias - static_cast<double>(from_.statistics[channel])) * factor(channel) +
               static_cast<double>(from_.values[channels + channel]);
    }

private:
    static constexpr std::size_t channels = Layers::template at<Norm>::output.channels;
    parameter_source from_;
};
template <class Layers>
class norm_constants<Layers, no_layer> {
public:
    explicit norm_constants(const parameter_source&) {}
    [[nodiscard]] double factor(std::size_t) const { return 1; }
    [[nodiscard]] double shifted(std::size_t, double bias) const { return bias; }
};

template <class Layers, std::size_t Convolution, std::size_t Norm, std::size_t Pool, std::size_t InputStride,
          bool Rectified, bool Adds>
struct folded_convolution {
    using layer = typename Layers::template at<Convolution>;
    static constexpr kernels::frame_convolution kernel = [] {
        kernels::frame_convolution c{.window = layer::window,
                                     .filters = layer::output.channels,
                                     .input_stride = InputStride,
                                     .rectified = Rectified,
                                     .adds = Adds};
        if constexpr (Pool != no_layer) {
            using pool = typename Layers::template at<Pool>;
            c.pool = pool::window.kernel;
            c.pooled_rows = pool::output.rows, c.pooled_columns = pool::output.columns;
        }
        return c;
    }();
    using step = convolution_step<kernel>;

    static void fold(const parameter_source& list, float* to) {
        const float* values = list.values + Layers::template parameter_offset<Convolution>;
        const norm_constants<Layers, Norm> norm(list);
        for (std::size_t w = 0; w < step::weights; ++w)
            to[w] = static_cast<float>(static_cast<double>(values[w]) * norm.factor(w / layer::fan_in));
        for (std::size_t f = 0; f < kernel.filters; ++f)
            to[step::weights + f] =
                static_cast<float>(norm.shifted(f, static_cast<double>(values[step::weights + f])));
    }
};

template <class Layers, std::size_t Norm, std::size_t InputStride, bool Rectified>
struct folded_norm {
    using step = norm_step<Layers::template at<Norm>::output, InputStride, Rectified>;

    static void fold(const parameter_source& list, float* to) {
        const norm_constants<Layers, Norm> norm(list);
        for (std::size_t c = 0; c < step::output.channels; ++c) {
            to[c] = static_cast<float>(norm.factor(c));
            to[step::output.channels + c] = static_cast<float>(norm.shifted(c, 0));
        }
    }
};

template <class Layers, std::size_t Dense, std::size_t InputStride>
struct folded_dense {
    using layer = typename Layers::template at<Dense>;
    using step = dense_step<kernels::frame_dense{layer::input, InputStride, layer::output.channels}>;

    static void fold(const parameter_source& list, float* to) {
        std::copy_n(list.values + Layers::template parameter_offset<Dense>, step::folded, to);
    }
};

template <class Step>
struct folded_without_parameters {
    using step = Step;
    static void fold(const parameter_source&, float*) {}
};

/// The steps of a list.
template <class... Folded>
struct folded_chain {
    using step = step_chain<typename Folded::step...>;

    static void fold(const parameter_source& list, float* to) {
        ((Folded::fold(list, to), to += Folded::step::folded), ...);
    }
};

/// A list inside a list.
template <class Layers, std::size_t I, class List>
struct folded_list {
    using step = typename List::step;

    static void fold(const parameter_source& list, float* to) {
        List::fold(list.behind(Layers::template parameter_offset<I>, Layers::template statistic_offset<I>),
                   to);
    }
};

template <class Layers, std::size_t I, class Main, class Skip, std::size_t InputStride>
struct folded_residual {
    using layer = typename Layers::template at<I>;
    using step = residual_step<typename Main::step, typename Skip::step, InputStride>;

    static void fold(const parameter_source& list, float* to) {
        const parameter_source here =
            list.behind(Layers::template parameter_offset<I>, Layers::template statistic_offset<I>);
        Main::fold(here, to);
        Skip::fold(here.behind(layer::main::parameters, layer::main::statistics), to + Main::step::folded);
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
