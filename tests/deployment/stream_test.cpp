#include "recordings.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/stream.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <support/allocations.hpp>
#include <support/drawn_network.hpp>
#include <support/layers/reference_of.hpp>
#include <support/same_bits.hpp>
#include <support/summed.hpp>
#include <thread>
#include <type_traits>
#include <vector>

using namespace tactnet;
using kernels::lanes;
using support::drawn_network;
using support::in_batch;
using support::in_stream;
using support::recordings;
using support::same_bits;

namespace {

template <std::size_t Frames>
using classifier = network<shape{Frames, 1, 3}, gru<5>, last_frame, dense<4>, softmax>;
using tagger = network<shape{9, 1, 3}, named<"first", causal_conv1d<6, 3, 2>>, relu,
                       residual<sequence<causal_conv1d<6, 2>, hyperbolic_tangent>>, lstm<19>, dropout<20>,
                       residual<causal_conv1d<7, 1>, causal_conv1d<7, 2>>, silu, causal_conv1d<2, 1>>;
using wide = network<shape{4, 1, 37}, gru<70>, lstm<33>, causal_conv1d<41, 2>>;

} // namespace

TEST_CASE_TEMPLATE("deployed_stream: bit-identical with the network in a batch, on any number of threads",
                   Network, tagger, wide, network<shape{1, 1, 1}, gru<1>>,
                   network<shape{11, 1, 2}, lstm<16>, gru<8>>) {
    const auto network = drawn_network<Network>();
    const auto stream = deploy_stream(network);
    for (const std::size_t count : {std::size_t{1}, 2 * lanes<float> + 1}) {
        const auto sequences = recordings(count, Network::input_shape.rows, Network::input_shape.channels);
        for (const std::size_t threads : {std::size_t{1}, std::size_t{3}}) {
            const auto expected = in_batch(network, sequences, threads);
            for (std::size_t s = 0; s < count; ++s)
                CHECK(same_bits(in_stream(stream, sequences[s]), expected[s]));
        }
    }
}

TEST_CASE_TEMPLATE("deployed_stream: after each frame the logits of the sequence so far", Network,
                   classifier<1>, classifier<2>, classifier<9>) {
    const auto network = drawn_network<Network>();
    const auto sequence = recordings(1, Network::input_shape.rows, 3);
    const std::vector<float> outputs = in_stream(deploy_stream(network), sequence[0]);
    const std::vector<float> last(outputs.end() - 4, outputs.end());
    CHECK(same_bits(last, in_batch(network, sequence, 1)[0]));
}

TEST_CASE("deployed_stream: outputs lie within the derived bound of the reference in double") {
    const auto network = drawn_network<tagger>(7);
    const auto stream = deploy_stream(network);
    const auto reference = support::reference_of<tagger::specification>::on({3, 9, 1});
    const std::vector<double> values(network.learnable_values().begin(), network.learnable_values().end());
    for (const std::vector<float>& recording : recordings(5, 9, 3)) {
        support::sample exact(recording.size());
        for (std::size_t i = 0; i < recording.size(); ++i)
            exact[i % 3 * 9 + i / 3].value = static_cast<double>(recording[i]);
        const support::samples expected = reference->forward(
            {.values = values, .running = {}, .roundoff = support::unit_roundoff<float>}, {exact});
        const std::vector<float> found = in_stream(stream, recording);
        for (std::size_t i = 0; i < found.size(); ++i)
            CHECK(support::within(static_cast<double>(found[i]), expected[0][i % 2 * 9 + i / 2]));
    }
}

TEST_CASE("deployed_stream: broken frames are reported and change nothing") {
    const auto stream = deploy_stream(drawn_network<tagger>());
    const auto recording = recordings(1, 9, 3)[0];
    const std::vector<float> expected = in_stream(stream, recording);
    std::vector<float> found(expected.size());
    decltype(stream)::state memory;
    for (std::size_t frame = 0; frame < 9; ++frame) {
        for (const float broken :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
              -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::max()})
            for (std::size_t f = 0; f < 3; ++f) {
                std::array<float, 3> features{1, 2, 3};
                features[f] = broken;
                std::array<float, 2> to{-17, -18};
                CHECK(stream.step(features, memory, to) == frame_status::not_finite);
                CHECK(to == std::array<float, 2>{-17, -18});
                CHECK(!stream.classify(features, memory));
            }
        CHECK(stream.step(std::span(recording).subspan(frame * 3).first<3>(), memory,
                          std::span(found).subspan(frame * 2).first<2>()) == frame_status::ok);
    }
    CHECK(same_bits(found, expected));
}

TEST_CASE("deployed_stream: run stops at a broken frame and goes on from the same state") {
    const auto stream = deploy_stream(drawn_network<tagger>());
    auto recording = recordings(1, 9, 3)[0];
    const std::vector<float> expected = in_stream(stream, recording);
    std::vector<float> found(expected.size());
    const float kept = recording[4 * 3 + 1];
    recording[4 * 3 + 1] = std::numeric_limits<float>::quiet_NaN();
    decltype(stream)::state memory;
    CHECK(stream.run(recording, memory, found) == 4);
    recording[4 * 3 + 1] = kept;
    CHECK(stream.run(std::span(recording).subspan(4 * 3), memory, std::span(found).subspan(4 * 2)) == 5);
    CHECK(same_bits(found, expected));
    // Whole frames alone, and no more than there is room for.
    decltype(stream)::state other;
    CHECK(stream.run(std::span(recording).first(8), other, found) == 2);
    CHECK(stream.run(recording, other, std::span(found).first(7)) == 3);
}

TEST_CASE(
    "deployed_stream: the largest inputs that it takes leave the outputs finite, however many there are") {
    const auto stream = deploy_stream(drawn_network<tagger>());
    float largest = std::numeric_limits<float>::max();
    std::array<float, 2> to{};
    decltype(stream)::state memory;
    while (stream.step(std::array{largest, largest, largest}, memory, to) != frame_status::ok)
        largest /= 2;
    CHECK(largest > 1e30F);
    for (std::size_t frame = 0; frame < 1000; ++frame) {
        const float sign = frame % 7 < 3 ? 1.0F : -1.0F;
        REQUIRE(stream.step(std::array{sign * largest, -largest, largest}, memory, to) == frame_status::ok);
        REQUIRE(std::isfinite(to[0]));
        REQUIRE(std::isfinite(to[1]));
    }
}

TEST_CASE("deployed_stream: calls use no heap and do not throw") {
    using stream_type = deployed_stream<wide>;
    const stream_type stream(drawn_network<wide>());
    const auto recording = recordings(1, 50, 37)[0];
    std::vector<float> outputs(50 * 41);
    stream_type::state memory;
    const std::size_t before = support::allocations();
    CHECK(stream.run(recording, memory, outputs) == 50);
    const std::size_t after = support::allocations();
    CHECK(after == before);
    CHECK(std::vector<float>(outputs) == outputs);
    CHECK(support::allocations() > after); // they are counted
    const std::span<const float, 37> frame(recording.data(), 37);
    static_assert(noexcept(stream.step(frame, memory, std::span<float, 41>(outputs.data(), 41))));
    static_assert(noexcept(stream.run(recording, memory, outputs)));
    static_assert(noexcept(stream.classify(frame, memory)));
    static_assert(std::is_trivially_copyable_v<stream_type::state>);
    static_assert(stream_type::state_bytes == sizeof(stream_type::state));
}

TEST_CASE("deployed_stream: a copy of the state is a point to return to, a new one the beginning") {
    const auto stream = deploy_stream(drawn_network<tagger>());
    const auto recording = recordings(1, 9, 3)[0];
    const std::vector<float> expected = in_stream(stream, recording);
    std::vector<float> found(expected.size());
    decltype(stream)::state memory;
    CHECK(stream.run(std::span(recording).first(15), memory, found) == 5);
    const auto point = memory;
    for (std::size_t repeat = 0; repeat < 3; ++repeat) {
        memory = point;
        std::fill(found.begin(), found.end(), 0.0F);
        CHECK(stream.run(std::span(recording).subspan(15), memory, found) == 4);
        CHECK(std::equal(found.begin(), found.begin() + 8, expected.begin() + 10));
    }
    memory = {};
    CHECK(stream.run(recording, memory, found) == 9);
    CHECK(same_bits(found, expected));
}

TEST_CASE(
    "stream_view::restore_state: what was saved continues bit-identically; damaged bytes change nothing") {
    const deployed_stream<tagger> stream(drawn_network<tagger>());
    using state = deployed_stream<tagger>::state;
    const std::vector<float> recording = recordings(1, 40, 3)[0];
    const std::span<const float> all(recording);
    std::vector<float> outputs(40 * stream.outputs), rest(17 * stream.outputs);
    state memory, again;
    REQUIRE(stream.run(all.first(23 * 3), memory, outputs) == 23);
    std::array<std::byte, saved_state_bytes<state>> saved, kept;
    static_assert(
        noexcept(save_state(memory, std::span(saved)))&& noexcept(stream.restore_state(saved, memory)));
    save_state(memory, std::span(saved));
    REQUIRE(stream.run(all.subspan(23 * 3), memory, outputs) == 17);
    REQUIRE(stream.restore_state(saved, again) == restore_status::ok);
    REQUIRE(stream.run(all.subspan(23 * 3), again, rest) == 17);
    CHECK(std::equal(rest.begin(), rest.end(), outputs.begin()));

    save_state(again, std::span(kept));
    const auto unchanged = [&] {
        std::array<std::byte, saved_state_bytes<state>> now;
        save_state(again, std::span(now));
        return now == kept;
    };
    for (std::size_t byte = 0; byte < saved.size(); ++byte) {
        auto damaged = saved;
        damaged[byte] ^= std::byte{16};
        CHECK(stream.restore_state(damaged, again) ==
              (byte < 16 ? restore_status::other_state : restore_status::damaged));
    }
    CHECK(stream.restore_state(std::span(saved).first(saved.size() - 1), again) ==
          restore_status::other_size);
    // Numbers that no state has, with a right checksum: wherever they are, NaN.
    for (std::size_t place = 16; place + 12 <= saved.size(); place += 4) {
        auto wrong = saved;
        std::fill_n(wrong.begin() + static_cast<std::ptrdiff_t>(place), 4, std::byte{0xFF});
        CHECK(stream.restore_state(support::summed(wrong), again) == restore_status::damaged);
    }
    CHECK(unchanged());
}

TEST_CASE(
    "stream_view::restore_state: states that inputs can give are restored, those with infinite outputs not") {
    // Rings in lists and in both branches; the first layer enlarges what the others hold.
    using branch = sequence<causal_conv1d<2, 2>>;
    using net =
        network<shape{8, 1, 1}, causal_conv1d<2, 2>, residual<branch, branch>, lstm<2>, causal_conv1d<1, 3>>;
    net large;
    for (float& value : large.learnable_values())
        value = 300;
    const auto stream = deploy_stream(large);
    using state = decltype(stream)::state;
    constexpr std::size_t bytes = saved_state_bytes<state>;
    const float most = stream.folded()[0];
    CHECK(stream.folded().size() == 1 + 5 + net::parameters);
    state memory, again;
    std::array<float, 1> outputs;
    for (std::size_t frame = 0; frame < 4; ++frame)
        REQUIRE(stream.step(std::array{frame % 3 == 1 ? -most : most}, memory, outputs) == frame_status::ok);
    std::array<std::byte, bytes> saved;
    save_state(memory, std::span(saved));
    CHECK(stream.restore_state(saved, again) == restore_status::ok);

    std::size_t refused = 0;
    for (std::size_t place = 16; place + 12 <= bytes; place += 4)
        for (const float number : {-3e38F, most, 4 * most, 1e10F, 0x1p-149F}) { // the last is 1 as an integer
            auto forged = saved;
            std::memcpy(forged.data() + place, &number, sizeof(number));
            state other;
            if (stream.restore_state(support::summed(forged), other) != restore_status::ok) {
                ++refused;
                continue;
            }
            for (std::size_t frame = 0; frame < 4; ++frame) {
                REQUIRE(stream.step(std::array{most}, other, outputs) == frame_status::ok);
                REQUIRE(std::isfinite(outputs[0]));
            }
        }
    // Places in rings that have one frame or two; features; larger inputs of the rings behind; hidden units.
    CHECK(refused == 3 * 5 + 4 + 2 + 2 * 2 + 4 + 4 * 2 * kernels::padded_size<float>(2));
}

TEST_CASE("deployed_stream: a state of damaged bytes gives wrong numbers, and touches no other memory") {
    const deployed_stream<tagger> stream(drawn_network<tagger>());
    const auto memory = std::make_unique<deployed_stream<tagger>::state>(); // where a sanitizer looks
    std::memset(static_cast<void*>(memory.get()), 0x7F, sizeof(*memory));
    const std::vector<float> recording = recordings(1, 40, 3)[0];
    std::vector<float> outputs(40 * stream.outputs);
    CHECK(stream.run(recording, *memory, outputs) == 40);
}

TEST_CASE("deployed_stream: threads share one stream, each with its own state") {
    const auto stream = deploy_stream(drawn_network<wide>());
    const auto sequences = recordings(4, 4, 37);
    std::vector<std::vector<float>> expected, found(4);
    for (const auto& each : sequences)
        expected.push_back(in_stream(stream, each));
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            found[t].resize(4 * 41);
            for (std::size_t repeat = 0; repeat < 50; ++repeat) {
                decltype(stream)::state memory;
                (void)stream.run(sequences[t], memory, found[t]);
            }
        });
    for (std::thread& each : threads)
        each.join();
    for (std::size_t t = 0; t < 4; ++t)
        CHECK(same_bits(found[t], expected[t]));
}

TEST_CASE("deployed_stream: classify returns the largest logit and its probability") {
    const auto stream = deploy_stream(drawn_network<classifier<6>>());
    const auto recording = recordings(1, 6, 3)[0];
    decltype(stream)::state one, other;
    for (std::size_t frame = 0; frame < 6; ++frame) {
        const auto features = std::span(recording).subspan(frame * 3).first<3>();
        std::array<float, 4> logits{};
        CHECK(stream.step(features, one, logits) == frame_status::ok);
        const auto found = stream.classify(features, other);
        REQUIRE(found);
        const auto expected = classify_logits(logits, std::size_t{4});
        CHECK(found->index == expected->index);
        CHECK(found->probability == expected->probability);
    }
}

TEST_CASE("deploy_stream: the temperature of a model; an untrained network is refused") {
    model<tagger> trained;
    CHECK_THROWS_WITH_AS((void)deploy_stream(trained),
                         doctest::Contains("deploy_stream: expected a trained network"),
                         std::invalid_argument);
    trained.network = drawn_network<tagger>();
    trained.temperature = 0.25;
    const auto stream = deploy_stream(trained);
    CHECK(stream.temperature() == 0.25);
    decltype(stream)::state memory, same;
    std::array<float, stream.outputs> logits;
    const std::array features{1.0F, -0.5F, 2.0F};
    const auto found = stream.classify(features, memory);
    REQUIRE(stream.step(features, same, logits) == frame_status::ok);
    REQUIRE(found);
    CHECK(found->probability == classify_logits(logits, stream.outputs, 0.25)->probability);
    CHECK(found->probability != classify_logits(logits, stream.outputs)->probability);
    CHECK_THROWS_AS(deploy_stream(trained.network).set_temperature(0), std::invalid_argument);
}

TEST_CASE("deploy_stream: parameters that are not finite or too large are refused") {
    for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::max()})
        for (const std::size_t where : {std::size_t{0}, tagger::parameters / 2, tagger::parameters - 1}) {
            auto network = drawn_network<tagger>();
            network.learnable_values()[where] = wrong;
            std::string message;
            try {
                (void)deploy_stream(network);
            } catch (const std::invalid_argument& e) {
                message = e.what();
            }
            CAPTURE(where);
            CAPTURE(wrong);
            if (std::isfinite(wrong) && where == 0)
                continue; // a weight of the input: smaller inputs are still possible
            CHECK(message ==
                  "deploy_stream: expected parameters that give finite numbers, found some that are "
                  "not finite or too large");
        }
}
