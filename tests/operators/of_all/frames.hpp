// A slice of the list: deployed in single precision and in 8 bits, as the only layer and between others.

#include <tactnet/runtime/thread_pool.hpp>

#include <doctest/doctest.h>

#include <deployment/deployed_network.hpp>
#include <deployment/eight_bit/networks.hpp>
#include <operators/list.hpp>
#include <support/allocations.hpp>

using namespace tactnet;

namespace {

/// How often a deployed network used the heap.
template <class Network>
std::size_t allocations_of() {
    Network net;
    support::fill(net, 3);
    const auto fast = deploy(net);
    const std::vector<std::uint8_t> counts = support::make_frame(Network::input_shape.size(), 4);
    std::vector<float> out(Network::outputs);
    const std::size_t before = support::allocations();
    CHECK(fast.infer(tensor_view<const std::uint8_t, Network::input_shape>(counts.data()),
                     std::span<float, Network::outputs>(out)) == frame_status::ok);
    return support::allocations() - before;
}

} // namespace

TEST_CASE_TEMPLATE_DEFINE("operators: deployed, within the derived bound, alone and between others", Example,
                          deployed_of_all) {
    // The deviation is that of many roundings: a few may all go the same way.
    if constexpr (!inference_no_op<typename Example::alone::specification>) // or there is nothing to deploy
        CHECK(support::errors_of<typename Example::alone>(1, 5).of_bound <= 1);
    CHECK(support::errors_of<typename Example::between>(2, 5));
    CHECK(allocations_of<typename Example::between>() == 0);
}
TEST_CASE_TEMPLATE_DEFINE("operators: in 8 bits, as the reference says", Example, eight_bit_of_all) {
    CHECK(support::frames_that_differ<typename Example::between>(3, 10) == 0);
}
TEST_CASE_TEMPLATE_APPLY(
    deployed_of_all, support::examples_of_slice<support::deployed_example, TACTNET_SLICE, TACTNET_SLICES>);
TEST_CASE_TEMPLATE_APPLY(
    eight_bit_of_all, support::examples_of_slice<support::deployed_example, TACTNET_SLICE, TACTNET_SLICES>);
