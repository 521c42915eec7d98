#pragma once

#include <tactnet/layers/activation.hpp>
#include <tactnet/layers/composition/concatenation.hpp>
#include <tactnet/layers/composition/named.hpp>
#include <tactnet/layers/composition/norm_relu_pool.hpp>
#include <tactnet/layers/composition/residual.hpp>
#include <tactnet/layers/composition/sequence.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <class Spec>
struct fused_spec {
    using type = Spec;
};

/// `Done` are the layers so far.
template <class Done, class... Specs>
struct fused_list;
template <class... Done>
struct fused_list<sequence<Done...>> {
    using type = sequence<Done...>;
};
template <class... Done, class Spec, class... Rest>
struct fused_list<sequence<Done...>, Spec, Rest...>
    : fused_list<sequence<Done..., typename fused_spec<Spec>::type>, Rest...> {};
template <class... Done, class... Rest>
struct fused_list<sequence<Done...>, batch_norm, relu, Rest...>
    : fused_list<sequence<Done..., norm_relu_pool<1>>, Rest...> {};
template <class... Done, extent2d Window, extent2d Stride, padding Padding, class... Rest>
struct fused_list<sequence<Done...>, batch_norm, relu, max_pool<Window, Stride, Padding>, Rest...>
    : fused_list<sequence<Done..., norm_relu_pool<Window, Stride, Padding>>, Rest...> {};

template <class... Specs>
struct fused_spec<sequence<Specs...>> : fused_list<sequence<>, tactnet::without_name<Specs>...> {};
template <class Main, class Skip>
struct fused_spec<residual<Main, Skip>> {
    using type = residual<typename fused_spec<tactnet::without_name<Main>>::type,
                          typename fused_spec<tactnet::without_name<Skip>>::type>;
};

template <class... Branches>
struct fused_spec<concatenation<Branches...>> {
    using type = concatenation<typename fused_spec<tactnet::without_name<Branches>>::type...>;
};

} // namespace detail

/// The list to train: the same results and the same arrays in the same order, but layers that are bound by
/// memory are fused. Names are left out.
template <class List>
using fused = typename detail::fused_spec<List>::type;

}} // namespace tactnet
