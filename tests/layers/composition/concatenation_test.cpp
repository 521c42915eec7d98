#include <tactnet/layers/composition/concatenation.hpp>

#include <string>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::check_layer;

TEST_CASE("concatenation: branches of different depth, with batch norms") {
    check_layer<concatenation<sequence<conv2d<3, 1>, batch_norm, relu>,
                              sequence<conv2d<2, 1>, relu, conv2d<4, 3>, batch_norm>>,
                shape{4, 3, 2}>();
}
TEST_CASE("concatenation: the input itself, a pool, a single layer") {
    check_layer<concatenation<identity_layer, max_pool<3, 1, pad(1)>, conv2d<2, 1>>, shape{3, 4, 2}>();
}
TEST_CASE("concatenation: within a list, and within itself") {
    check_layer<sequence<conv2d<3, 1>, concatenation<concatenation<conv2d<2, 1>, relu>, conv2d<1, 3>>, relu,
                         dense<2>>,
                shape{3, 3, 2}>();
}
TEST_CASE("concatenation: names of its branches") {
    const auto list = support::make_layer<
                          concatenation<conv2d<2, 1>, named<"expand3x3", conv2d<1, 3>>, unnamed<batch_norm>>,
                          float, shape{2, 2, 1}>()
                          ->describe();
    std::vector<std::string> names;
    for (const parameter& p : list)
        names.push_back(p.name);
    CHECK(names == std::vector<std::string>{"layer.branch1.conv1.weight", "layer.branch1.conv1.bias",
                                            "layer.expand3x3.conv1.weight", "layer.expand3x3.conv1.bias",
                                            "layer.bn1.weight", "layer.bn1.bias", "layer.bn1.running_mean",
                                            "layer.bn1.running_var"});
}

TEST_CASE("concatenation: branches drop out other elements") {
    constexpr shape size{8, 8, 4};
    using bound = concatenation<dropout<50>, dropout<50>>::layer<float, size>;
    thread_pool threads;
    batch<float, size, kernels::lanes<float>> in(1);
    batch<float, bound::output, kernels::lanes<float>> out(1);
    for (std::size_t e = 0; e < size.size(); ++e)
        in(0, e) = 1;
    bound::memory memory;
    memory.resize(1);
    bound::forward({.threads = threads}, nullptr, nullptr, memory, in.view(), out.view());
    std::size_t different = 0;
    for (std::size_t e = 0; e < size.size(); ++e)
        different += out(0, e) != out(0, size.size() + e);
    CHECK(different > size.size() / 4); // half of them but for five deviations
    CHECK(different < size.size() * 3 / 4);
}
