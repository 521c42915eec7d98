#pragma once

// The reference of a layer specification that runs through time.

#include <tactnet/layers/time/causal_conv1d.hpp>
#include <tactnet/layers/time/gru.hpp>
#include <tactnet/layers/time/last_frame.hpp>
#include <tactnet/layers/time/lstm.hpp>

#include <cstddef>
#include <support/layers/reference_of.hpp>
#include <support/layers/reference_time.hpp>

namespace support {

template <std::size_t Hidden>
struct reference_of<tactnet::gru<Hidden>> {
    static reference_pointer on(extents3 in) { return reference_gru(in, Hidden); }
};
template <std::size_t Hidden>
struct reference_of<tactnet::lstm<Hidden>> {
    static reference_pointer on(extents3 in) { return reference_lstm(in, Hidden); }
};
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation>
struct reference_of<tactnet::causal_conv1d<Filters, Taps, Dilation>> {
    static reference_pointer on(extents3 in) { return reference_causal_conv1d(in, Filters, Taps, Dilation); }
};
template <>
struct reference_of<tactnet::last_frame> {
    static reference_pointer on(extents3 in) { return reference_last_frame(in); }
};

} // namespace support
