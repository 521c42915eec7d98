#include <tactnet/deployment/deploy.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/training/trainer.hpp>
#include <tactnet/transfer/networks.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
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

constexpr std::size_t numbers = 12, classes = 3;
using head = feature_head<numbers, classes, 16>;

static_assert(feature_head<512, 22>::input_shape == shape{1, 1, 512});
static_assert(feature_head<512, 22>::outputs == 22);
// Scale and shift of the first norm, dense 512 to 256, its norm, dense 256 to 22.
static_assert(feature_head<512, 22>::parameters == 2 * 512 + 513 * 256 + 2 * 256 + 257 * 22);

/// Noise, with another level of four numbers for each class. One is a thousand times as large as the others,
/// one a thousandth.
struct clouds {
    std::vector<float> values;
    std::vector<std::size_t> labels;

    clouds() {
        random_stream random(3, random_purposes::order);
        for (std::size_t i = 0; i < 90; ++i) {
            labels.push_back(i % classes);
            for (std::size_t e = 0; e < numbers; ++e) {
                const double level = (e % classes == i % classes ? 1.0 : 0.0) + random.uniform();
                values.push_back(static_cast<float>(level * (e == 0 ? 1000 : e == 1 ? 0.001 : 1)));
            }
        }
    }
    labelled_features view() const { return {values, labels, classes}; }
    data_split split() const { return split_data(labels, classes, split_rule::random, 1); }
};

TEST_CASE("feature_head: learns classes from features of any scale, and recognises them when deployed") {
    const clouds data;
    thread_pool alone;
    recipe how = recipe::on_features();
    how.batch = 16;
    trainer<head> training(how, data.view(), data.split(), 0, alone);
    while (!training.finished())
        training.run_epoch();
    const head& best = training.best();
    const evaluation tested =
        evaluate(best, training.input_normalisation(), data.view(), data.split().test, alone);
    CHECK(tested.confusion.total() > 10);
    CHECK(tested.confusion.accuracy() == 1.0);

    const auto fast = deploy(best);
    for (std::size_t i = 0; i < tested.recognised.size(); ++i) {
        std::array<float, classes> logits{};
        const std::span<const float, numbers> row(data.values.data() + data.split().test[i] * numbers,
                                                  numbers);
        REQUIRE(fast.infer(tensor_view<const float, head::input_shape>(row), logits) == frame_status::ok);
        CHECK(classify_logits(logits, classes).value().index == tested.recognised[i]);
    }
}

TEST_CASE("feature_head: a feature that is no number is reported before the training begins") {
    clouds data;
    data.values[7 * numbers + 2] = std::numeric_limits<float>::quiet_NaN();
    thread_pool alone;
    CHECK_THROWS_WITH_AS(trainer<head>(recipe::on_features(), data.view(), data.split(), 0, alone),
                         "features: expected a finite number in sample 7, feature 2, found nan",
                         std::invalid_argument);
}

TEST_CASE("feature_head: batches of one sample, of which norms learn nothing, are refused") {
    const clouds data;
    thread_pool alone;
    recipe how = recipe::on_features();
    how.batch = 1;
    CHECK_THROWS_AS(trainer<head>(how, data.view(), data.split(), 0, alone), std::invalid_argument);
    how.batch = 2;
    data_split split = data.split();
    split.training.resize(9); // two of which would leave one alone
    CHECK_THROWS_AS(trainer<head>(how, data.view(), split, 0, alone), std::invalid_argument);
    split.training.resize(8);
    CHECK_NOTHROW(trainer<head>(how, data.view(), split, 0, alone));
}

} // namespace
