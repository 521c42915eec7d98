#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/stored_arrays.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

using namespace tactnet;

namespace {

const stored_arrays network{{{"conv1.weight", {2, 1, 3, 3}},
                             {"conv1.bias", {2}},
                             {"fc.weight", {5, 12}, {2, 2, 3}},
                             {"fc.bias", {5}}},
                            5};

using content = std::vector<std::pair<std::string, std::vector<std::size_t>>>;
const content right{
    {"conv1.weight", {2, 1, 3, 3}}, {"conv1.bias", {2}}, {"fc.weight", {5, 2, 2, 3}}, {"fc.bias", {5}}};

std::string error_of(const content& list, std::size_t classes = 5, std::span<const std::string> unread = {}) {
    safetensors_writer writer;
    for (const auto& [name, extents] : list) {
        std::size_t size = 1;
        for (const std::size_t extent : extents)
            size *= extent;
        writer.add(name, extents, std::span<const float>(std::vector<float>(size)));
    }
    const safetensors file = safetensors::parse(writer.to_bytes(), "weights");
    try {
        require_arrays(file, network, classes, unread);
    } catch (const file_error& error) {
        return error.what();
    }
    return "";
}

} // namespace

TEST_CASE("stored_arrays: the layer that gives the logits") {
    CHECK(network.output_layer() == "fc.");
    const stored_arrays convolution{{{"classifier.1.weight", {5, 8, 1, 1}}, {"classifier.1.bias", {5}}}, 5};
    CHECK(convolution.output_layer() == "classifier.1.");
    CHECK(convolution.extents(convolution.list[0], 3) == std::vector<std::size_t>{3, 8, 1, 1});
    // A norm at the end, filters that are no classes, a layer without bias, nothing.
    CHECK(stored_arrays{{{"bn.running_mean", {5}}, {"bn.running_var", {5}}}, 5}.output_layer() == "");
    CHECK(stored_arrays{{{"bn.weight", {5}}, {"bn.bias", {5}}}, 5}.output_layer() == "");
    CHECK(stored_arrays{{{"conv.weight", {2, 1, 3, 3}}, {"conv.bias", {2}}}, 40}.output_layer() == "");
    CHECK(stored_arrays{{{"conv.bias", {5}}, {"last.weight", {5, 2}}}, 5}.output_layer() == "");
    CHECK(stored_arrays{}.output_layer() == "");
}

TEST_CASE("stored_arrays: a file of the network") {
    CHECK(error_of(right) == "");
    content with_companions = right;
    with_companions.push_back({"conv1.num_batches_tracked", {}});
    CHECK(error_of(with_companions) == "");
    content fewer = right;
    fewer[2].second = {3, 12};
    fewer[3].second = {3};
    CHECK(error_of(fewer, 3) == "");
}

TEST_CASE("stored_arrays: one difference is reported with its place") {
    content list = right;
    list.erase(list.begin() + 1);
    CHECK(error_of(list) == "weights: expected a tensor 'conv1.bias' of 2, found none of that name");
    list = right;
    list[2].second = {12, 5};
    CHECK(error_of(list) == "weights: tensor 'fc.weight': expected 5x12 or 5x2x2x3, found 12x5");
    list = right;
    list.push_back({"conv2.bias", {1}});
    CHECK(
        error_of(list) ==
        "weights: expected only the 4 arrays of this network, found tensor 'conv2.bias' of another network");
}

TEST_CASE("stored_arrays: all differences are named in one error") {
    CHECK(
        error_of(
            {{"conv1.bias", {3}}, {"fc.weight", {5, 12}}, {"fc.bias", {1, 5}}, {"b", {1}}, {"a", {1}}}) ==
        "weights: expected the 4 arrays of this network, found 1 missing: 'conv1.weight' of 2x1x3x3; 2 of "
        "another shape: 'conv1.bias' of 3 instead of 2, 'fc.bias' of 1x5 instead of 5; 2 of another network: "
        "'a', 'b'");
}

TEST_CASE("stored_arrays: what is not to be read") {
    content list = right;
    list.push_back({"classifier.1.weight", {1000, 512, 1, 1}});
    list.push_back({"classifier.1.bias", {1000}});
    const std::array<std::string, 1> unread{"classifier."};
    CHECK(error_of(list, 5, unread) == "");
    CHECK(error_of(list) != "");
}
