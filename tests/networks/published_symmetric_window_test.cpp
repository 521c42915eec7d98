#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <networks/every_size.hpp>
#include <random>
#include <span>
#include <vector>

using namespace tactnet;
using support::halved;

namespace {

/// Whether the window for an image, halved that often, lies symmetrically on it.
constexpr bool lies_symmetrically(std::size_t rows, std::size_t columns, std::size_t even,
                                  std::size_t halvings) {
    const auto side = [&](std::size_t size) {
        for (std::size_t i = 0; i < halvings; ++i)
            size = halved(size);
        return size;
    };
    const shape map{side(rows), side(columns)};
    const auto window =
        sliding_window::over(map, symmetric_window(rows, columns, even, halvings), 2, padding::same);
    return window.top == window.bottom && window.left == window.right &&
           window.output_rows() == halved(map.rows) && window.output_columns() == halved(map.columns);
}
static_assert([] {
    for (std::size_t rows = 5; rows <= 28; ++rows)
        for (std::size_t columns = 5; columns <= 50; ++columns)
            for (std::size_t halvings = 0; halvings < 5; ++halvings)
                if (!lies_symmetrically(rows, columns, halvings == 0 ? 4 : 2, halvings))
                    return false;
    return true;
}());

/// Random parameters, the same in every network of a type.
template <class Network>
Network random_network() {
    Network network;
    std::mt19937 random(4);
    network.for_each_parameter([&](const parameter& p, std::span<float> values) {
        const bool positive = p.role == parameter_role::scale || p.role == parameter_role::running_variance;
        for (float& value : values)
            value = (static_cast<float>(random() % 2001) / 1000 - 1) * 0.2F + (positive ? 1.0F : 0.0F);
    });
    return network;
}

template <class T>
std::vector<T> reflected(shape maps, reflection how, std::span<const T> from) {
    std::vector<T> to(from.size());
    reflect_image(maps, how, from.data(), to.data());
    return to;
}

template <class Network>
std::vector<float> logits_of(const Network& network, const std::vector<float>& pixels) {
    thread_pool threads(1);
    typename Network::workspace space;
    typename Network::input_batch in(1);
    typename Network::output_batch out(1);
    in.set(0, tensor_view<const float, Network::input_shape>(pixels.data()));
    network.prepare(threads, space);
    network.logits(in, out, threads, space);
    std::vector<float> result(Network::outputs);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = out(0, i);
    return result;
}

/// The largest difference between the logits of an image and those of the reflected image in the network with
/// reflected weights, relative to the largest logit. The network halves the image three times or more.
template <class Network>
double difference_when_reflected(std::size_t halvings, reflection how) {
    constexpr shape image = Network::input_shape;
    std::size_t rows = image.rows, columns = image.columns;
    for (std::size_t i = 0; i < halvings; ++i)
        rows = halved(rows), columns = halved(columns);
    const Network network = random_network<Network>();
    Network mirrored = random_network<Network>();
    mirrored.for_each_parameter([&](const parameter& p, std::span<float> values) {
        shape maps{1, 1, p.size};
        if (p.extents.size() == 4) // of a convolution: filters, channels, rows, columns
            maps = {p.extents[2], p.extents[3], p.extents[0] * p.extents[1]};
        else if (p.extents.size() == 2) // of the dense layer: a map for each output and channel
            maps = {rows, columns, p.size / (rows * columns)};
        std::ranges::copy(reflected<float>(maps, how, values), values.begin());
    });
    std::vector<float> pixels(image.size());
    std::mt19937 random(5);
    for (float& value : pixels)
        value = static_cast<float>(random() % 1000) / 500 - 1;
    const std::vector<float> expected = logits_of(network, pixels),
                             found = logits_of(mirrored, reflected<float>(image, how, pixels));
    double largest = 0, difference = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        largest = std::max(largest, std::abs(static_cast<double>(expected[i])));
        difference = std::max(difference, std::abs(static_cast<double>(expected[i]) - found[i]));
    }
    return difference / largest;
}

/// The largest over all reflections.
template <class Network>
double difference_when_reflected(std::size_t halvings) {
    double largest = 0;
    for (const reflection how : all_reflections)
        largest = std::max(largest, difference_when_reflected<Network>(halvings, how));
    return largest;
}

} // namespace

// With the reflected weights, the networks compute the same of the reflected image, but for the order of the
// sums.
TEST_CASE_TEMPLATE("tactnet4_strided: windows lie alike on an image and on its reflections", network,
                   tactnet4_strided<shape{7, 13}, 5>, tactnet4_strided<shape{10, 18}, 5>,
                   tactnet4_strided<shape{14, 25}, 5>) {
    CHECK(difference_when_reflected<network>(3) < 1e-5);
}
TEST_CASE_TEMPLATE("tactnet6_symmetric: windows lie alike on an image and on its reflections", network,
                   tactnet6_symmetric<shape{7, 13}, 5>, tactnet6_symmetric<shape{10, 18}, 5>,
                   tactnet6_symmetric<shape{14, 25}, 5>) {
    CHECK(difference_when_reflected<network>(5) < 1e-5);
}
TEST_CASE_TEMPLATE("tactnet4_3x3: windows lie alike where both sides are multiples of 8", network,
                   tactnet4_3x3<shape{8, 16}, 5>, tactnet4_3x3<shape{16, 24}, 5>) {
    CHECK(difference_when_reflected<network>(3) < 1e-5);
}
TEST_CASE("tactnet4: windows do not lie alike on an image of odd sides and on its reflections") {
    CHECK(difference_when_reflected<tactnet4<shape{7, 13}, 5>>(3) > 0.01);
}
TEST_CASE("tactnet6_economical: windows do not lie alike on an image of odd sides and on its reflections") {
    CHECK(difference_when_reflected<tactnet6_economical<shape{7, 13}, 5>>(5) > 0.01);
}
