#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactnet6_symmetric.hpp>

#include <networks/every_size.hpp>

using namespace tactnet;

namespace {

/// Only the windows of its pools differ from those of tactnet6_economical, which cost nothing.
template <shape Size>
struct costs_as_economical {
    using symmetric = tactnet6_symmetric<Size, 22>;
    using economical = tactnet6_economical<Size, 22>;
    static constexpr bool value = symmetric::outputs == 22 &&
                                  symmetric::parameters == economical::parameters &&
                                  symmetric::multiply_adds == economical::multiply_adds &&
                                  symmetric::activation_bytes == economical::activation_bytes;
};
static_assert(support::holds_at_every_size<costs_as_economical>);

} // namespace
