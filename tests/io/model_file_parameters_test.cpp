#include <tactnet/io/file_error.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/io/stored_arrays.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <support/error_of.hpp>
#include <utility>
#include <vector>

namespace {

using namespace tactnet;

using small_network = network<shape{4, 6, 1}, conv2d<2, 3>, batch_norm, relu, max_pool<2>, conv2d<3, 2>,
                              batch_norm, relu, dense<5>>;
constexpr std::size_t dense_inputs = 2 * 3 * 3;

/// A network in which every number is another one.
small_network numbered_network() {
    small_network n;
    float next = 0.5F;
    n.for_each_parameter([&](const parameter&, std::span<float> values) {
        for (float& value : values)
            value = next += 0.25F;
    });
    return n;
}

struct array {
    std::vector<std::size_t> extents;
    std::vector<float> values;
};
using arrays = std::map<std::string, array>;

arrays arrays_of(const small_network& n) {
    arrays result;
    n.for_each_parameter([&](const parameter& p, std::span<const float> values) {
        result[p.name] = {p.extents, {values.begin(), values.end()}};
    });
    return result;
}

safetensors file_of(const arrays& content) {
    safetensors_writer writer;
    for (const auto& [name, a] : content)
        writer.add(name, a.extents, std::span<const float>(a.values));
    return safetensors::parse(writer.to_bytes(), "weights.safetensors");
}

bool same_numbers(const small_network& a, const small_network& b) {
    return std::equal(a.learnable_values().begin(), a.learnable_values().end(),
                      b.learnable_values().begin()) &&
           std::equal(a.running_statistics().begin(), a.running_statistics().end(),
                      b.running_statistics().begin());
}

/// The error when the changed arrays of a network are loaded; the network must then be as it was.
std::string error_after(const std::function<void(arrays&)>& change, std::size_t classes = 5) {
    arrays content = arrays_of(numbered_network());
    change(content);
    small_network target;
    const small_network before = target;
    const std::string error =
        support::error_of<file_error>([&] { load_parameters(target, file_of(content), classes); });
    CHECK((error == "no error" || same_numbers(target, before)));
    return error;
}

TEST_CASE("parameters: what is stored comes back") {
    const small_network original = numbered_network();
    safetensors_writer writer;
    add_parameters(writer, original);
    const safetensors file = safetensors::parse(writer.to_bytes(), "weights.safetensors");
    CHECK(file.tensors().size() == small_network::describe().size());
    file.require_extents("conv2.weight", std::vector<std::size_t>{3, 2, 2, 2});
    file.require_extents("bn2.running_var", std::vector<std::size_t>{3});
    file.require_extents("fc.weight", std::vector<std::size_t>{5, dense_inputs});
    CHECK(stored_classes(file, stored_arrays_of<small_network>()) == 5);

    small_network copy;
    CHECK_FALSE(same_numbers(copy, original));
    load_parameters(copy, file);
    CHECK(same_numbers(copy, original));
}

TEST_CASE("parameters: fewer classes than outputs: only their rows are stored, the others become zero") {
    const small_network original = numbered_network();
    safetensors_writer writer;
    add_parameters(writer, original, 3);
    const safetensors file = safetensors::parse(writer.to_bytes(), "weights.safetensors");
    file.require_extents("fc.weight", std::vector<std::size_t>{3, dense_inputs});
    file.require_extents("fc.bias", std::vector<std::size_t>{3});
    file.require_extents("conv2.weight",
                         std::vector<std::size_t>{3, 2, 2, 2}); // three filters, not three classes
    CHECK(stored_classes(file, stored_arrays_of<small_network>()) == 3);

    small_network copy = numbered_network();
    load_parameters(copy, file, 3);
    const arrays expected = arrays_of(original), found = arrays_of(copy);
    for (const auto& [name, a] : expected) {
        const bool output_layer = name.starts_with("fc");
        const std::size_t kept = output_layer ? a.values.size() / 5 * 3 : a.values.size();
        for (std::size_t i = 0; i < a.values.size(); ++i)
            REQUIRE(found.at(name).values[i] == (i < kept ? a.values[i] : 0));
    }
    CHECK_THROWS_AS(load_parameters(copy, file), file_error); // five were asked for
    CHECK_THROWS_AS(add_parameters(writer, original, 6), std::invalid_argument);
}

TEST_CASE("parameters: dense weights may keep channels, rows and columns apart; companions are passed over") {
    arrays content = arrays_of(numbered_network());
    content["fc.weight"].extents = {5, 3, 2, 3};
    content["bn1.num_batches_tracked"] = {{}, {7}};
    content["input_mean"] = {{4, 6}, std::vector<float>(24)};
    content["selftest.logits"] = {{1, 5}, std::vector<float>(5)};
    small_network copy;
    load_parameters(copy, file_of(content));
    CHECK(same_numbers(copy, numbered_network()));

    // Of fewer classes, too.
    content["fc.weight"] = {{2, 3, 2, 3}, std::vector<float>(36, 1)};
    content["fc.bias"] = {{2}, {3, 4}};
    load_parameters(copy, file_of(content), 2);
    CHECK(arrays_of(copy).at("fc.weight").values[35] == 1);
}

TEST_CASE("parameters: several dense layers: each has its own input") {
    using two_layers = network<shape{4, 6, 2}, max_pool<2>, dense<7>, relu, dense<5>>;
    const auto load = [](std::vector<std::size_t> first, std::vector<std::size_t> second) {
        safetensors_writer writer;
        const std::vector<float> numbers(84);
        writer.add("fc1.weight", std::move(first), std::span(numbers).first(84));
        writer.add("fc1.bias", {7}, std::span(numbers).first(7));
        writer.add("fc2.weight", std::move(second), std::span(numbers).first(35));
        writer.add("fc2.bias", {5}, std::span(numbers).first(5));
        two_layers n;
        load_parameters(n, safetensors::parse(writer.to_bytes(), "weights.safetensors"));
    };
    load({7, 12}, {5, 7});
    load({7, 2, 2, 3}, {5, 7, 1, 1});
    CHECK_THROWS_AS(load({7, 3, 2, 2}, {5, 7}), file_error);
    CHECK_THROWS_AS(load({7, 12}, {5, 1, 1, 7}), file_error);
}

TEST_CASE("parameters: a file of another network") {
    CHECK(error_after([](arrays& a) {
              a["conv3.weight"] = {{1}, {1}};
          }) == "weights.safetensors: expected only the 14 arrays of this network, found tensor "
                "'conv3.weight' of "
                "another network");
    CHECK(error_after([](arrays& a) { a.erase("bn2.bias"); }) ==
          "weights.safetensors: expected a tensor 'bn2.bias' of 3, found none of that name");
    CHECK(error_after([](arrays& a) {
              a["conv1.weight"].extents = {2, 1, 1, 9};
          }) == "weights.safetensors: tensor 'conv1.weight': expected 2x1x3x3, found 2x1x1x9");
    CHECK(error_after([](arrays& a) {
              a["fc.weight"].extents = {3, 5, 2, 3};
          }) == "weights.safetensors: tensor 'fc.weight': expected 5x18 or 5x3x2x3, found 3x5x2x3");
    // As many numbers, in another order: the channels must not be taken for rows.
    for (const std::vector<std::size_t>& extents :
         {std::vector<std::size_t>{5, 3, 3, 2}, {5, 2, 3, 3}, {5, 18, 1, 1}, {5, 3, 6}, {90}})
        CHECK(error_after([&](arrays& a) { a["fc.weight"].extents = extents; }) ==
              "weights.safetensors: tensor 'fc.weight': expected 5x18 or 5x3x2x3, found " +
                  shape_text(extents));
    CHECK(error_after([](arrays& a) {
              a["fc.bias"] = {{6}, std::vector<float>(6)};
          }) == "weights.safetensors: tensor 'fc.bias': expected 5, found 6");
}

TEST_CASE("parameters: any number of surplus arrays and extents: a short message, in linear time") {
    const auto message = [](std::size_t surplus) {
        return error_after([&](arrays& a) {
            for (std::size_t i = 0; i < surplus; ++i)
                a[std::string(80, '\x01') + std::to_string(i)] = {{0}, {}};
            for (auto& [name, array] : a)
                if (name.starts_with("bn"))
                    array = {std::vector<std::size_t>(10'000, std::size_t(-1)), {}}, array.extents[0] = 0;
        });
    };
    const std::string text = message(3);
    CHECK(text.size() < 1000);
    CHECK(text.find("8 of another shape: 'bn1.weight' of 0x18446744073709551615x") != std::string::npos);
    CHECK(text.find("x… (10000 extents) instead of 2, …; 3 of another network: '\\x01") != std::string::npos);
    // 140 s while the list was copied for each of 100 000: not even a second now.
    const std::clock_t start = std::clock(); // of the process: the machine may be busy
    CHECK(message(100'000).size() < 1000);
    CHECK(std::clock() - start < 30 * CLOCKS_PER_SEC);
}

TEST_CASE("parameters: numbers in the other byte order are named") {
    const auto reversed = [](arrays& a) {
        for (auto& [name, array] : a)
            for (float& value : array.values)
                value =
                    std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value * 1.2345678f)));
    };
    CHECK(error_after(reversed).find(
              "expected little-endian numbers, as safetensors stores them, found numbers "
              "whose bytes lie in the other order") != std::string::npos);
    // Small numbers may look like large ones in the other order: they are none.
    CHECK(error_after([](arrays& a) {
              for (auto& [name, array] : a)
                  for (float& value : array.values)
                      value = std::abs(value) * 1.2345678e-12f;
          }) == "no error");
    // Nor are numbers that are usual both ways with five huge ones among ninety, or huge ones that stay so.
    CHECK(error_after([](arrays& a) {
              std::ranges::fill(a["fc.weight"].values, std::bit_cast<float>(0x3F80003FU));
              std::fill_n(a["fc.weight"].values.begin(), 5, std::bit_cast<float>(0x6000003FU));
          }) == "no error");
    CHECK(error_after([](arrays& a) { std::ranges::fill(a["fc.weight"].values, 1e20f); }) == "no error");
}

TEST_CASE("parameters: more classes than outputs") {
    arrays content = arrays_of(numbered_network());
    content["fc.bias"] = {{6}, std::vector<float>(6)};
    CHECK_THROWS_WITH_AS(
        static_cast<void>(stored_classes(file_of(content), stored_arrays_of<small_network>())),
        "weights.safetensors: tensor 'fc.bias': expected one number for each of 1 to 5 classes, "
        "found 6",
        file_error);
}

TEST_CASE("parameters: values that cannot be") {
    const std::string nan = error_after([](arrays& a) { a["conv2.bias"].values[1] = std::nanf(""); });
    CHECK(nan == "weights.safetensors: tensor 'conv2.bias', element 1: expected a finite number, found nan");
    CHECK(error_after([](arrays& a) {
              a["fc.weight"].values[89] = std::numeric_limits<float>::infinity();
          }) == "weights.safetensors: tensor 'fc.weight', element 89: expected a finite number, found inf");
    CHECK(error_after([](arrays& a) { a["bn1.running_var"].values[0] = -1; }) ==
          "weights.safetensors: tensor 'bn1.running_var', element 0: expected a variance (finite, at "
          "least 0), "
          "found -1.000000");
    CHECK(error_after([](arrays& a) { a["bn1.running_mean"].values[0] = -1; }) == "no error");
}

const stored_arrays described{{{"conv1.weight", {2, 1, 3, 3}},
                               {"conv1.bias", {2}},
                               {"fc.weight", {5, 12}, {2, 2, 3}},
                               {"fc.bias", {5}}},
                              5};

using array_list = std::vector<std::pair<std::string, std::vector<std::size_t>>>;
const array_list right{
    {"conv1.weight", {2, 1, 3, 3}}, {"conv1.bias", {2}}, {"fc.weight", {5, 2, 2, 3}}, {"fc.bias", {5}}};

std::string arrays_error(const array_list& list, std::size_t classes = 5,
                         std::span<const std::string> unread = {}) {
    safetensors_writer writer;
    for (const auto& [name, extents] : list) {
        std::size_t size = 1;
        for (const std::size_t extent : extents)
            size *= extent;
        writer.add(name, extents, std::span<const float>(std::vector<float>(size)));
    }
    const safetensors file = safetensors::parse(writer.to_bytes(), "weights");
    return support::error_of<file_error>([&] { require_arrays(file, described, classes, unread); });
}

TEST_CASE("stored_arrays: the layer that gives the logits") {
    CHECK(described.output_layer() == "fc.");
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
    CHECK(arrays_error(right) == "no error");
    array_list with_companions = right;
    with_companions.push_back({"conv1.num_batches_tracked", {}});
    CHECK(arrays_error(with_companions) == "no error");
    array_list fewer = right;
    fewer[2].second = {3, 12};
    fewer[3].second = {3};
    CHECK(arrays_error(fewer, 3) == "no error");
}

TEST_CASE("stored_arrays: all differences are named in one error") {
    CHECK(arrays_error(
              {{"conv1.bias", {3}}, {"fc.weight", {5, 12}}, {"fc.bias", {1, 5}}, {"b", {1}}, {"a", {1}}}) ==
          "weights: expected the 4 arrays of this network, found 1 missing: 'conv1.weight' of 2x1x3x3; 2 of "
          "another shape: 'conv1.bias' of 3 instead of 2, 'fc.bias' of 1x5 instead of 5; 2 of another "
          "network: 'a', 'b'");
}

TEST_CASE("stored_arrays: what is not to be read") {
    array_list list = right;
    list.push_back({"classifier.1.weight", {1000, 512, 1, 1}});
    list.push_back({"classifier.1.bias", {1000}});
    const std::array<std::string, 1> unread{"classifier."};
    CHECK(arrays_error(list, 5, unread) == "no error");
    CHECK(arrays_error(list) != "no error");
}

} // namespace
