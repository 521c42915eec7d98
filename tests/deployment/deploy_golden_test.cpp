#include "deployed_network.hpp"

#include <tactnet/io/model_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/model.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/networks/tactnet4.hpp>

#include <doctest/doctest.h>

#include <support/files/data_folder.hpp>

using namespace tactnet;

namespace {

using net_type = tactnet4<shape{14, 25}, 22>;
constexpr std::size_t size = net_type::input_shape.size(), outputs = net_type::outputs;

/// How far logits are from the published ones, relative to the largest logit of an image: one near zero is a
/// difference of large ones.
struct distances {
    double worst = 0;
    std::size_t otherwise = 0, recognised = 0;

    void add(std::size_t image, std::span<const float> found, std::span<const float> right) {
        double largest = 0, error = 0;
        for (std::size_t c = 0; c < outputs; ++c) {
            largest = std::max(largest, std::abs(static_cast<double>(right[c])));
            error = std::max(error, std::abs(static_cast<double>(found[c]) - static_cast<double>(right[c])));
        }
        worst = std::max(worst, error / largest);
        otherwise += first_largest(found) != first_largest(right);
        recognised += first_largest(found) == image / 5;
    }
    void check(const char* form) const {
        MESSAGE(form << ": largest relative distance of a logit " << worst << ", recognised " << recognised);
        CHECK(worst < 1e-4);
        CHECK(otherwise == 0);
    }
};

} // namespace

TEST_CASE("tactnet4: the published network gives the published logits, in a batch and deployed" *
          doctest::test_suite("data")) {
    const auto network_file = support::find_data("published_tactnet4_14x25.safetensors");
    const auto golden_file = support::find_data("published_tactnet4_14x25_golden.safetensors");
    if (!network_file || !golden_file)
        return;
    const safetensors weights = safetensors::read(*network_file), golden = safetensors::read(*golden_file);
    net_type net;
    load_parameters(net, weights);
    normalisation<net_type::input_shape> normalise;
    const std::vector<float> mean = weights.values<float>("input_mean");
    REQUIRE(mean.size() == size);
    std::copy(mean.begin(), mean.end(), normalise.mean.begin());
    const auto fast = deploy(net, std::span<const float, size>(mean.data(), size));

    const auto images = golden.values<std::uint8_t>("inputs");
    const auto expected = golden.values<float>("logits");
    const std::size_t count = images.size() / size;
    REQUIRE(count == 110);
    net_type::input_batch in(count);
    net_type::output_batch out(count);
    for (std::size_t i = 0; i < count; ++i)
        in.set(i, normalise.apply(std::span<const std::uint8_t, size>(images.data() + i * size, size)));
    thread_pool threads;
    net_type::workspace space;
    net.prepare(threads, space);
    net.infer(in, out, threads, space);

    const auto layers = support::describe<net_type>();
    support::error_shares errors;
    distances in_batch, of_deployed;
    for (std::size_t i = 0; i < count; ++i) {
        const std::span<const float> right(expected.data() + i * outputs, outputs);
        std::vector<float> logits(outputs);
        for (std::size_t c = 0; c < outputs; ++c)
            logits[c] = out(i, c);
        in_batch.add(i, logits, right);
        REQUIRE(fast.infer(tensor_view<const std::uint8_t, net_type::input_shape>(images.data() + i * size),
                           std::span<float, outputs>(logits)) == frame_status::ok);
        of_deployed.add(i, logits, right);
        const std::vector<float> counts(images.begin() + static_cast<std::ptrdiff_t>(i * size),
                                        images.begin() + static_cast<std::ptrdiff_t>((i + 1) * size));
        errors.add(
            support::shares_of(logits, support::bounded_outputs(layers, support::parameters_of(net),
                                                                support::bounded_input(counts, mean, 1))));
    }
    in_batch.check("in a batch");
    of_deployed.check("deployed");
    MESSAGE(errors);
    CHECK(errors);
}
