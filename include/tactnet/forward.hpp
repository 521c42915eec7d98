#pragma once

#include <tactnet/detail/config.hpp>

// Names without definitions, for headers that only pass references on.

namespace tactnet { inline namespace TACTNET_ARCH {

struct shape;
struct extent2d;
struct padding;
class thread_pool;
class safetensors;
class safetensors_writer;
struct recognition;
template <class Network>
struct model;
template <class Network>
class trainer;
template <class Network, class Format>
class deployed;

}} // namespace tactnet
