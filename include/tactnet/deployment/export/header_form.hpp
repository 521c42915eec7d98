#pragma once

#include <tactnet/detail/config.hpp>

#include <string_view>

// The template of an exported header: deployed_header replaces each @name@.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

inline constexpr std::string_view header_form =
    R"(// @network@ for frames of @size@ (rows × columns × channels), @outputs@ outputs,
// @parameters@ parameters, of which @folded@ numbers remain once batch norms are folded in. Generated: do not edit.
//
// recogniser.classify(counts@memory@) returns the class of a frame, recogniser.infer(counts, outputs@memory@) writes
// its outputs. They need no files, no heap, no exceptions and no run-time type information.
#pragma once

#include <tactnet/deployment/deployed_view.hpp>
@includes@
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace @namespace@ {
inline namespace TACTNET_ARCH {

@steps@
using recogniser_type = tactnet::deployed_view<tactnet::shape{.rows = @rows@, .columns = @columns@, .channels = @channels@}, @chain@>;

/// Names of the first outputs, in order. Outputs behind them stand for nothing.
inline constexpr std::array<std::string_view, @class count@> classes{
@classes@};

/// The mean frame, the scale, the largest input, then weights and biases step by step.
inline constexpr std::array<float, recogniser_type::folded_elements> folded{
@numbers@};
static_assert(folded.size() == @count@, "this header does not fit this version of tactnet");

@packed@
inline constexpr recogniser_type recogniser(packed@known@);

/// A frame and what it gives.
inline constexpr std::array<std::uint8_t, recogniser_type::input_shape.size()> selftest_frame{
@frame@};
inline constexpr std::array<float, recogniser_type::outputs> selftest_outputs{
@frame outputs@};

/// Whether compiler and processor still make of the frame what they should.
inline bool passes_selftest(@memory parameter@) noexcept {
    std::array<float, recogniser_type::outputs> outputs;
    if (recogniser.infer(selftest_frame, outputs@memory@) != tactnet::frame_status::ok)
        return false;
    float largest = 0, difference = 0;
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const float expected = selftest_outputs[i], found = outputs[i] - expected;
        largest = largest > expected ? largest : expected;
        largest = largest > -expected ? largest : -expected;
        difference = difference > found ? difference : found;
        difference = difference > -found ? difference : -found;
    }
    return difference <= largest * 1e-4f;
}

} // namespace TACTNET_ARCH
} // namespace @namespace@
)";

inline constexpr std::string_view packed_when_compiling =
    R"(/// In the order of use, for the instruction set that this is compiled for.
inline constexpr recogniser_type::packed_weights packed = recogniser_type::pack(folded);)";

inline constexpr std::string_view packed_at_start =
    R"(/// In the order of use, for the instruction set that this is compiled for. At the latest packed before main: not for
/// use by what else happens then.
inline const recogniser_type::packed_weights packed = recogniser_type::pack(folded);)";

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
