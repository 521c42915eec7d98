#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>

#include <doctest/doctest.h>

#include <string>
#include <type_traits>
#include <vector>

using namespace tactnet;

namespace {

template <class... Specs>
std::vector<std::string> names_of() {
    std::vector<std::string> names;
    for (const parameter& p : network<shape{4, 4, 2}, Specs...>::describe())
        names.push_back(p.name);
    return names;
}
using names = std::vector<std::string>;

} // namespace

TEST_CASE("named: a list gives names, with points between") {
    CHECK(names_of<named<"features.3", sequence<named<"squeeze", conv2d<2, 1>>, relu, conv2d<2, 1>>>,
                   named<"fc", dense<3>>>() == names{"features.3.squeeze.weight", "features.3.squeeze.bias",
                                                     "features.3.conv1.weight", "features.3.conv1.bias",
                                                     "fc.weight", "fc.bias"});
}
TEST_CASE("named: without a name a list stands among the layers around it") {
    CHECK(names_of<unnamed<named<"a", conv2d<2, 1>>>, unnamed<unnamed<named<"b", conv2d<2, 1>>>>>() ==
          names{"a.weight", "a.bias", "b.weight", "b.bias"});
    CHECK(names_of<named<"x", unnamed<named<"a", batch_norm>>>>() ==
          names{"x.a.weight", "x.a.bias", "x.a.running_mean", "x.a.running_var"});
}
TEST_CASE("named: layers by their place, those without parameters counted") {
    CHECK(names_of<named<"classifier", sequential<dropout<50>, dense<3>, relu, dense<2>>>>() ==
          names{"classifier.1.weight", "classifier.1.bias", "classifier.3.weight", "classifier.3.bias"});
    CHECK(names_of<sequential<relu, relu, relu, relu, relu, relu, relu, relu, relu, relu, dense<1>>>() ==
          names{"1.10.weight", "1.10.bias"});
}
TEST_CASE("named: the skip of a residual block") {
    CHECK(names_of<unnamed<residual<unnamed<named<"conv1", conv2d<2, 1>>>,
                                    named<"downsample", sequential<conv2d<2, 1>, relu>>>>>() ==
          names{"block1.conv1.weight", "block1.conv1.bias", "block1.downsample.0.weight",
                "block1.downsample.0.bias"});
}
TEST_CASE("named: a name that was given is never numbered") {
    CHECK(names_of<named<"same", conv2d<2, 1>>, named<"same", conv2d<2, 1>>>() ==
          names{"same.weight", "same.bias", "same.weight", "same.bias"});
}

// A name changes no layer, and layers are joined under whatever name.
using plain = sequence<conv2d<2, 3>, batch_norm, relu, max_pool<2>>;
using with_names = sequence<named<"c", conv2d<2, 3>>, named<"b", batch_norm>, named<"r", relu>, max_pool<2>>;
static_assert(std::is_same_v<with_fused_norms<plain>, with_fused_norms<with_names>>);
static_assert(std::is_same_v<named<"n", relu>::layer<float, shape{2, 2}>, relu::layer<float, shape{2, 2}>>);
static_assert(network<shape{3, 3}, named<"head", sequential<dense<3>, softmax>>>::ends_in_softmax);
