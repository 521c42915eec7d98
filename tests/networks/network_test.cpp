#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactresnet.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/training/initialise.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <support/allocations.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;

namespace {

template <class Network>
std::map<std::string, parameter> arrays_of() {
    std::map<std::string, parameter> result;
    for (const parameter& p : Network::describe())
        CHECK(result.emplace(p.name, p).second); // no name twice
    return result;
}

template <class Network>
void check_cover() {
    std::vector<int> learned(Network::parameters), counted(Network::statistics);
    for (const parameter& p : Network::describe()) {
        CAPTURE(p.name);
        std::size_t size = 1;
        for (const std::size_t e : p.extents)
            size *= e;
        CHECK(p.size == size);
        std::vector<int>& cover = learnable(p.role) ? learned : counted;
        REQUIRE(p.offset + p.size <= cover.size());
        for (std::size_t i = p.offset; i < p.offset + p.size; ++i)
            ++cover[i];
    }
    const auto once = [](int n) { return n == 1; };
    CHECK(std::all_of(learned.begin(), learned.end(), once));
    CHECK(std::all_of(counted.begin(), counted.end(), once));
}

} // namespace

TEST_CASE("describe: every number of a network once, under PyTorch's names") {
    using net4 = tactnet4<shape{28, 50, 1}, 22>;
    check_cover<net4>();
    const auto arrays = arrays_of<net4>();
    CHECK(arrays.size() == 3 * 2 + 3 * 4 + 2);
    CHECK(arrays.at("conv1.weight").extents == std::vector<std::size_t>{8, 1, 5, 5});
    CHECK(arrays.at("conv1.weight").role == parameter_role::weight);
    CHECK(arrays.at("conv1.weight").fan_in == 25);
    CHECK(arrays.at("conv3.bias").extents == std::vector<std::size_t>{32});
    CHECK(arrays.at("bn1.weight").role == parameter_role::scale);
    CHECK(arrays.at("bn2.bias").role == parameter_role::shift);
    CHECK(arrays.at("bn1.running_mean").role == parameter_role::running_mean);
    CHECK(arrays.at("bn3.running_var").role == parameter_role::running_variance);
    CHECK(arrays.at("fc.weight").extents == std::vector<std::size_t>{22, 32 * 4 * 7});
    CHECK(arrays.at("fc.bias").role == parameter_role::bias);
}

TEST_CASE("describe: the arrays of residual blocks are named after the block") {
    using net = tactresnet<shape{28, 50, 1}, 22>;
    check_cover<net>();
    const auto arrays = arrays_of<net>();
    CHECK(arrays.at("conv1.weight").extents == std::vector<std::size_t>{64, 1, 5, 5});
    CHECK(arrays.at("block1.conv1.weight").extents == std::vector<std::size_t>{64, 64, 3, 3});
    CHECK(arrays.at("block2.bn2.running_var").extents == std::vector<std::size_t>{64});
    CHECK(arrays.at("block3.conv1.weight").extents == std::vector<std::size_t>{128, 64, 3, 3});
    CHECK(arrays.at("block3.projection.conv1.weight").extents == std::vector<std::size_t>{128, 64, 3, 3});
    CHECK(arrays.at("block3.projection.bn1.weight").extents == std::vector<std::size_t>{128});
    CHECK(!arrays.contains("block4.projection.conv1.weight"));
    CHECK(arrays.contains("fc.weight"));
}

TEST_CASE("describe: a second layer of a kind that is alone elsewhere is numbered") {
    const auto arrays = arrays_of<network<shape{4, 4, 1}, dense<5>, relu, dense<3>>>();
    CHECK(arrays.contains("fc1.weight"));
    CHECK(arrays.contains("fc2.bias"));
}

TEST_CASE("network: scales and running variances begin at one, all else at zero; const and not") {
    network<shape{7, 13, 1}, conv2d<3, 3>, batch_norm, relu, dense<4>> net;
    net.for_each_parameter([](const parameter& p, std::span<float> values) {
        CHECK(values.size() == p.size);
        const bool one = p.role == parameter_role::scale || p.role == parameter_role::running_variance;
        CHECK(std::all_of(values.begin(), values.end(), [&](float v) { return v == (one ? 1 : 0); }));
        if (p.name == "bn1.weight")
            values[2] = 7;
    });
    bool seen = false;
    std::as_const(net).for_each_parameter([&](const parameter& p, auto values) {
        static_assert(std::is_same_v<decltype(values), std::span<const float>>);
        seen = seen || (p.name == "bn1.weight" && values[2] == 7);
    });
    CHECK(seen);
    CHECK(net.learnable_values().size() == kernels::padded_size<float>(net.parameters));
    CHECK(net.running_statistics().size() == kernels::padded_size<float>(net.statistics));
}

TEST_CASE("network: what it costs in memory") {
    using net = network<shape{28, 50, 1}, conv2d<8, 5>, batch_norm, relu, max_pool<2>, dense<22>>;
    // Layer by layer: from 28 × 50 × 8 of the convolution to as many of the batch norm; input and output are
    // there too.
    static_assert(net::activation_bytes == 4 * (28 * 50 + 28 * 50 * 8 + 28 * 50 * 8 + 22));
    static_assert(net::with_value_type<double>::activation_bytes == 2 * net::activation_bytes);
    static_assert(net::parameter_bytes == 4 * (net::parameters + net::statistics));
    // In place: one map and what is pooled from it.
    static_assert(network<shape{4, 4, 1}, conv2d<2, 3>, relu, max_pool<2>, dense<3>>::activation_bytes ==
                  4 * (16 + 32 + 8 + 3));
    // A block: its input, its output, and one map inside.
    static_assert(network<shape{4, 4, 2}, relu, residual<sequence<conv2d<2, 3>, relu, conv2d<2, 3>>>,
                          dense<3>>::activation_bytes == 4 * (32 + 32 + 32 + 32 + 3));
    CHECK(net::activation_bytes == 95288);
}

TEST_CASE("network: the same sample gives the same bits in any batch, workspace and number of threads") {
    using net_type = tactnet4<shape{14, 25, 1}, 22>;
    net_type net;
    random_stream random(1, random_purposes::initial_weights);
    for (float& value : net.learnable_values())
        value = static_cast<float>(random.uniform(-0.3, 0.3));
    const std::size_t most = 2 * kernels::lanes<float> + 3;
    net_type::input_batch in(most);
    for (std::size_t s = 0; s < most; ++s)
        for (std::size_t e = 0; e < 350; ++e)
            in(s, e) = static_cast<float>(random.below(256));
    thread_pool one(1), three(3);
    net_type::workspace space;
    net.prepare(one, space);
    net_type::output_batch expected(most);
    net.infer(in, expected, one, space);
    CHECK(std::isfinite(expected(0, 0)));
    CHECK(expected(0, 0) != expected(1, 0));
    std::size_t different = 0;
    for (const std::size_t count : {std::size_t{1}, kernels::lanes<float>, most}) {
        net_type::input_batch some(count);
        net_type::output_batch out(count);
        for (std::size_t s = 0; s < count; ++s)
            for (std::size_t e = 0; e < 350; ++e)
                some(s, e) = in(most - 1 - s, e);
        net.infer(some, out, three, space); // the workspace is used again
        for (std::size_t s = 0; s < count; ++s)
            for (std::size_t c = 0; c < 22; ++c)
                different += out(s, c) != expected(most - 1 - s, c);
    }
    CHECK(different == 0);
}

TEST_CASE("network: a softmax at the end, also of a nested list, is not part of the logits") {
    constexpr shape size{4, 5, 1};
    using bare = network<size, conv2d<3, 3>, relu, dense<4>>;
    using ending = network<size, conv2d<3, 3>, relu, dense<4>, softmax>;
    using within = network<size, conv2d<3, 3>, sequence<relu, sequence<dense<4>, softmax>>>;
    static_assert(!bare::ends_in_softmax && ending::ends_in_softmax && within::ends_in_softmax);
    static_assert(!network<size, softmax, relu>::ends_in_softmax);
    static_assert(network<size, softmax>::ends_in_softmax);
    static_assert(network<size, named<"a", sequence<square_root<>>>, dense<2>>::needs_counts);
    static_assert(!network<size, dense<2>, square_root<>>::needs_counts);
    static_assert(ending::parameters == bare::parameters && ending::output_shape == bare::output_shape);
    static_assert(ending::activation_bytes == bare::activation_bytes);

    constexpr std::size_t count = 5;
    thread_pool threads;
    random_stream random(1, random_purposes::order);
    batch<float, size, kernels::lanes<float>> in(count);
    for (std::size_t s = 0; s < count; ++s)
        for (std::size_t e = 0; e < size.size(); ++e)
            in(s, e) = static_cast<float>(random.uniform(-1, 1));
    std::vector<float> values(bare::parameters);
    for (float& value : values)
        value = static_cast<float>(random.uniform(-1, 1));
    const auto outputs_of = [&](auto net, bool logits) {
        std::copy(values.begin(), values.end(), net.learnable_values().begin());
        typename decltype(net)::workspace space;
        typename decltype(net)::output_batch out(count);
        net.prepare(threads, space);
        if (logits)
            net.logits(in, out, threads, space);
        else
            net.infer(in, out, threads, space);
        std::vector<float> result;
        for (std::size_t s = 0; s < count; ++s)
            for (std::size_t c = 0; c < 4; ++c)
                result.push_back(out(s, c));
        return result;
    };
    const std::vector<float> logits = outputs_of(bare(), false);
    std::vector<float> probabilities = logits;
    for (std::size_t s = 0; s < count; ++s) {
        const std::span<float> row = std::span(probabilities).subspan(4 * s, 4);
        kernels::softmax_of<float>(row, row);
    }
    CHECK(logits != probabilities);
    CHECK(outputs_of(bare(), true) == logits);
    CHECK(outputs_of(ending(), true) == logits);
    CHECK(outputs_of(within(), true) == logits);
    CHECK(outputs_of(ending(), false) == probabilities);
    CHECK(outputs_of(within(), false) == probabilities);
}

TEST_CASE("network: without layers the output is the input") {
    using net = network<shape{1, 1, 3}>;
    using ending = network<shape{1, 1, 3}, softmax>;
    thread_pool threads;
    net::input_batch in(2);
    net::output_batch out(2);
    for (std::size_t c = 0; c < 3; ++c)
        in(1, c) = static_cast<float>(c);
    net::workspace space;
    net().infer(in, out, threads, space);
    CHECK(out(1, 2) == 2);
    CHECK(out(0, 2) == 0);
    ending::workspace other;
    ending().infer(in, out, threads, other);
    CHECK(out(0, 0) == doctest::Approx(1.0 / 3));
}

TEST_CASE("network: any number of images need the memory of one group in the workspace") {
    using net_type = network<shape{28, 50, 1}, conv2d<8, 5>, relu, dense<3>>;
    constexpr std::size_t many = 5 * 256 + 3, map = 28 * 50 * 8 * sizeof(float);
    net_type net;
    for (float& value : net.learnable_values())
        value = 0.01F;
    thread_pool threads;
    net_type::workspace space;
    net_type::input_batch in(many);
    net_type::output_batch out(many);
    for (std::size_t s = 0; s < many; ++s)
        in(s, 700) = static_cast<float>(s);
    net.prepare(threads, space);
    const std::size_t before = support::bytes_allocated();
    net.infer(in, out, threads, space);
    CHECK(support::bytes_allocated() - before <= 2 * kernels::lanes<float> * map);
    for (std::size_t s = 1; s < many; ++s)
        CHECK(out(s, 0) > out(s - 1, 0)); // every image went through
}
