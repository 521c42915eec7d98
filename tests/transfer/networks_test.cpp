#include <tactnet/transfer/networks.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

namespace {

using namespace tactnet;

constexpr shape touch{28, 50};

/// The arrays of a network of photographs, behind the two of as_photograph.
template <class Network, class Original>
void check() {
    static_assert(Network::input_shape == touch && Network::outputs == 22);
    static_assert(Network::parameters == Original::parameters);
    static_assert(Network::statistics == Original::statistics + 6);
    static_assert(Network::multiply_adds == Original::multiply_adds);
    const std::vector<parameter> found = Network::describe(), expected = Original::describe();
    REQUIRE(found.size() == expected.size() + 2);
    CHECK(found[0].name == "photograph.running_mean");
    CHECK(found[1].name == "photograph.running_var");
    for (std::size_t i = 0; i < expected.size(); ++i) {
        CHECK(found[i + 2].name == expected[i].name);
        CHECK(found[i + 2].extents == expected[i].extents);
    }
}

TEST_CASE("networks: the networks of photographs, for images of one channel") {
    check<squeezenet_nn<touch, 22>, squeezenet1_1<shape{227, 227, 3}, 22>>();
    check<alexnet_nn<touch, 22>, alexnet<shape{224, 224, 3}, 22>>();
    check<resnet50_nn<touch, 22>, resnet50<shape{224, 224, 3}, 22>>();
    check<vgg16_nn<touch, 22>, vgg16<shape{224, 224, 3}, 22>>();
}

TEST_CASE("networks: trained as in the authors' programs") {
    const auto is = [](const published_training& found, double others, std::size_t batch,
                       std::size_t epochs) {
        REQUIRE(found.transfer.has_value());
        CHECK(found.rate / found.transfer->new_layer_factor == doctest::Approx(others));
        CHECK(found.transfer->batch == batch);
        CHECK(found.transfer->epochs == epochs);
    };
    is(squeezenet_nn_training(touch), 1e-3, 64, 15);
    is(alexnet_nn_training(touch), 1e-4, 5, 10);
    is(resnet50_nn_training(touch), 1e-3, 16, 10);
    is(vgg16_nn_training(touch), 1e-4, 32, 10);
    CHECK(alexnet_nn_training(touch).transfer->new_layer_factor == 20);
    CHECK(resnet50_nn_training(touch).patience == 4);
}

} // namespace
