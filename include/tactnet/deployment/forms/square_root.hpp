#pragma once

#include <tactnet/deployment/forms/form.hpp>
#include <tactnet/deployment/steps/square_root.hpp>
#include <tactnet/layers/square_root.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <class Offset>
struct deployed_form<square_root<Offset>> {
    /// The offset in lowest terms, so that equal ones are one step, and one spelling.
    template <class Place>
    using at = form_without_parameters<square_root_step<typename Place::format, Place::layer::output,
                                                        Place::input_stride, typename Offset::type>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
