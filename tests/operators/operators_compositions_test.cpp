#include <tactnet/networks/network.hpp>
#include <tactnet/operators/sequence/layer.hpp>
#include <tactnet/operators/training.hpp>

#include <doctest/doctest.h>

#include <string>
#include <support/layers/conformance.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;
using texts = std::vector<std::string>;

TEST_CASE("concatenation: names of its branches") {
    CHECK(
        support::arrays_of<concatenation<conv2d<2, 1>, named<"expand3x3", conv2d<1, 3>>, unnamed<batch_norm>>,
                           shape{2, 2, 1}>() ==
        texts{"layer.branch1.conv1.weight 2x1x1x1", "layer.branch1.conv1.bias 2",
              "layer.expand3x3.conv1.weight 1x1x3x3", "layer.expand3x3.conv1.bias 1", "layer.bn1.weight 1",
              "layer.bn1.bias 1", "layer.bn1.running_mean 1", "layer.bn1.running_var 1"});
}
TEST_CASE("concatenation: branches drop out other elements") {
    constexpr shape size{8, 8, 4};
    using bound = trained_layer<concatenation<dropout<50>, dropout<50>>, float, size>;
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

namespace {

template <class... Specs>
std::vector<std::string> names_of() {
    std::vector<std::string> names;
    for (const parameter& p : network<shape{4, 4, 2}, Specs...>::describe())
        names.push_back(p.name);
    return names;
}

} // namespace

TEST_CASE("named: a list gives names, with points between") {
    CHECK(names_of<named<"features.3", sequence<named<"squeeze", conv2d<2, 1>>, relu, conv2d<2, 1>>>,
                   named<"fc", dense<3>>>() == texts{"features.3.squeeze.weight", "features.3.squeeze.bias",
                                                     "features.3.conv1.weight", "features.3.conv1.bias",
                                                     "fc.weight", "fc.bias"});
}
TEST_CASE("named: without a name a list stands among the layers around it") {
    CHECK(names_of<unnamed<named<"a", conv2d<2, 1>>>, unnamed<unnamed<named<"b", conv2d<2, 1>>>>>() ==
          texts{"a.weight", "a.bias", "b.weight", "b.bias"});
    CHECK(names_of<named<"x", unnamed<named<"a", batch_norm>>>>() ==
          texts{"x.a.weight", "x.a.bias", "x.a.running_mean", "x.a.running_var"});
}
TEST_CASE("named: layers by their place, those without parameters counted") {
    CHECK(names_of<named<"classifier", sequential<dropout<50>, dense<3>, relu, dense<2>>>>() ==
          texts{"classifier.1.weight", "classifier.1.bias", "classifier.3.weight", "classifier.3.bias"});
    CHECK(names_of<sequential<relu, relu, relu, relu, relu, relu, relu, relu, relu, relu, dense<1>>>() ==
          texts{"1.10.weight", "1.10.bias"});
}
TEST_CASE("named: the skip of a residual block") {
    CHECK(names_of<unnamed<residual<unnamed<named<"conv1", conv2d<2, 1>>>,
                                    named<"downsample", sequential<conv2d<2, 1>, relu>>>>>() ==
          texts{"block1.conv1.weight", "block1.conv1.bias", "block1.downsample.0.weight",
                "block1.downsample.0.bias"});
}
TEST_CASE("named: a name that was given is never numbered") {
    CHECK(names_of<named<"same", conv2d<2, 1>>, named<"same", conv2d<2, 1>>>() ==
          texts{"same.weight", "same.bias", "same.weight", "same.bias"});
}

// A name changes no layer, and layers are joined under whatever name.
using plain = sequence<conv2d<2, 3>, batch_norm, relu, max_pool<2>>;
using with_names = sequence<named<"c", conv2d<2, 3>>, named<"b", batch_norm>, named<"r", relu>, max_pool<2>>;
static_assert(std::is_same_v<with_fused_norms<plain>, with_fused_norms<with_names>>);
static_assert(std::is_same_v<named<"n", relu>::layer<float, shape{2, 2}>, relu::layer<float, shape{2, 2}>>);
static_assert(network<shape{3, 3}, named<"head", sequential<dense<3>, softmax>>>::ends_in_softmax);
