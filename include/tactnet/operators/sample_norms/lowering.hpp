#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/sample_norms/layer.hpp>
#include <tactnet/operators/sample_norms/step.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A group, instance or layer norm with the ReLU after it. `Groups` counts the groups of channels.
template <class Place, sample_norm_kind Kind, std::size_t Groups = 1, bool Rectified = false>
struct lowered_sample_norm {
    using layer = typename Place::layer;
    using step = sample_norm_step<typename Place::format, layer::output, Place::input_stride,
                                  static_cast<unsigned>(Kind), Groups, Rectified>;

    /// Without an epsilon above zero, a constant frame has no finite norm: NaN is rejected as a parameter.
    static void fold(const parameter_source& list, float* to) {
        const parameter_source from = Place::parameters(list);
        const auto epsilon = static_cast<float>(from.epsilon);
        float* const end = std::copy_n(from.values, layer::parameters, to);
        *end = epsilon > 0 ? epsilon : std::numeric_limits<float>::quiet_NaN();
    }
    template <class Spec, class>
    static constexpr auto fuse() {
        return fuse_relu<Spec, lowered_sample_norm<Place, Kind, Groups, true>>();
    }
};

template <std::size_t Groups>
struct lowering<group_norm<Groups>> {
    template <class Place>
    using at = lowered_sample_norm<Place, sample_norm_kind::groups, Groups>;
};
template <>
struct lowering<instance_norm> {
    template <class Place>
    using at = lowered_sample_norm<Place, sample_norm_kind::groups, Place::layer::output.channels>;
};
template <norm_over Over>
struct lowering<layer_norm<Over>> {
    template <class Place>
    using at = lowered_sample_norm<Place, Over == norm_over::frame ? sample_norm_kind::frame
                                                                   : sample_norm_kind::pixels>;
};

template <std::size_t Size, class Alpha, class Beta, class K>
struct lowering<local_response_norm<Size, Alpha, Beta, K>> {
    // Fractions in lowest terms, as above.
    using rule = kernels::response_rule<Size, typename Alpha::type, typename Beta::type, typename K::type>;
    template <class Place>
    using at = lowered_to<
        local_response_norm_step<typename Place::format, Place::layer::output, Place::input_stride, rule>>;
};

}} // namespace tactnet
