#include <tactnet/deployment.hpp>
#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/deployment/export/onnx_model.hpp>
#include <tactnet/deployment/reflection_average.hpp>
#include <tactnet/io/deployed_file.hpp>
#include <tactnet/io/eight_bit_file.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/quantisation.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/training.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <support/error_of.hpp>
#include <support/files/temporary_folder.hpp>
#include <vector>

// The input function and the reflections of a network, from the formula to every form that a trained network
// takes.

using namespace tactnet;

namespace {

constexpr shape size{6, 7};
using net = network<size, conv2d<4, 3>, batch_norm, relu, max_pool<2>, dense<3>>;
constexpr std::array functions{input_function{count_rule::square_root},
                               input_function{count_rule::logarithm, 8},
                               input_function{count_rule::relative_logarithm, 1}};

std::vector<std::uint8_t> some_frames(std::size_t count) {
    std::vector<std::uint8_t> frames;
    random_stream random(3, random_purposes::order);
    for (std::size_t e = 0; e < count * size.size(); ++e)
        frames.push_back(static_cast<std::uint8_t>(random.below(3) == 0 ? random.below(256) : 0));
    return frames;
}

model<net> some_model(const input_function& function) {
    model<net> m;
    std::size_t i = 0;
    for (float& value : m.network.learnable_values())
        value = 0.3F * static_cast<float>(std::sin(static_cast<double>(++i)));
    std::ranges::fill(m.network.running_statistics(), 1.0F);
    for (std::size_t e = 0; e < size.size(); ++e)
        m.normalise.mean.data()[e] = static_cast<float>(e % 5);
    m.normalise.scale = 0.02F;
    m.normalise.function = function;
    m.classes = {"left", "middle", "right"};
    m.reflections = {{}, {true, {2, 1, 0}}};
    return m;
}

} // namespace

TEST_CASE("input_function: the formula in double, rounded to 2^-10, the same bits for bytes and floats") {
    const std::vector<std::uint8_t> frame = some_frames(1);
    double mean = 0;
    for (const std::uint8_t count : frame)
        mean += count / static_cast<double>(size.size());
    for (const input_function& f : functions) {
        CAPTURE(static_cast<int>(f.rule));
        const auto unit = static_cast<double>(f.knee);
        const auto expected = [&](double x) {
            const double t = f.rule == count_rule::relative_logarithm ? x / mean / unit : x / unit;
            return std::min(255.0, f.rule == count_rule::square_root
                                       ? std::sqrt(255 * x)
                                       : 255 * std::log1p(t) / std::log1p(255 / unit));
        };
        std::vector<float> floats(frame.begin(), frame.end()), of_bytes(frame.size());
        f.apply(floats);
        f.apply(frame.data(), of_bytes);
        CHECK(floats == of_bytes);
        for (std::size_t e = 0; e < frame.size(); ++e) {
            CHECK(std::abs(static_cast<double>(floats[e]) - expected(frame[e])) <= 0x1p-11 + 1e-7);
            CHECK(std::fmod(floats[e], 0x1p-10F) == 0);
        }
        std::vector<float> odd{-3, 0, 1e30F, std::numeric_limits<float>::infinity(), std::nanf("")};
        if (f.rule != count_rule::relative_logarithm) {
            f.apply(odd);
            CHECK(odd[0] == 0);
            CHECK(odd[1] == 0);
            CHECK(odd[2] == 255);
            CHECK(std::isnan(odd[3]));
            CHECK(std::isnan(odd[4]));
        }
        std::vector<float> empty(9), twice(frame.begin(), frame.end());
        f.apply(empty);
        CHECK(std::ranges::count(empty, 0.0F) == 9);
        if (f.rule == count_rule::relative_logarithm) {
            for (float& count : twice)
                count *= 2;
            f.apply(twice);
            CHECK(twice == floats);
        }
    }
    std::vector<float> same{1, 2, 3};
    input_function{}.apply(same);
    CHECK(same == std::vector<float>{1, 2, 3});
    const std::array<std::uint8_t, 3> bytes{1, 100, 255};
    input_function{}.apply(bytes.data(), same);
    CHECK(same == std::vector<float>{1, 100, 255});
}

TEST_CASE("input_function: deployed, in 8 bits, in files and in headers as in the model") {
    const support::temporary_folder folder;
    const std::vector<std::uint8_t> frames = some_frames(12);
    thread_pool alone;
    for (const input_function& f : functions) {
        CAPTURE(static_cast<int>(f.rule));
        const model<net> m = some_model(f);
        const std::vector<float> logits = m.logits(frames, alone);
        CHECK(logits != some_model({}).logits(frames, alone));

        const auto check = [&](const auto& network, double tolerance) {
            CHECK(network.function() == f);
            CHECK(network.reflections() == m.reflections);
            std::array<float, 3> bytes{}, floats{};
            for (std::size_t i = 0; i < 12; ++i) {
                const std::span<const std::uint8_t, size.size()> frame(frames.data() + i * size.size(),
                                                                       size.size());
                std::array<float, size.size()> counts{};
                std::ranges::copy(frame, counts.begin());
                CHECK(network.infer(frame, bytes) == frame_status::ok);
                CHECK(network.infer(counts, floats) == frame_status::ok);
                CHECK(bytes == floats);
                for (std::size_t c = 0; c < 3; ++c)
                    CHECK(bytes[c] == doctest::Approx(logits[i * 3 + c]).epsilon(tolerance));
                counts[5] = std::nanf("");
                CHECK(network.infer(counts, floats) == frame_status::not_finite);
            }
        };
        const auto deployed = deploy(m);
        const auto in_bytes = deploy<eight_bit>(m, frames);
        check(deployed, 1e-4);
        check(in_bytes, 0.1);

        save_model(folder / "net", m, {}, frames);
        CHECK(load_model<net>(folder / "net").normalise.function == f);
        check(load_deployed<net>(folder / "net"), 1e-4);
        save_deployed(folder / "bytes", in_bytes, {}, frames);
        check(load_deployed<net, eight_bit>(folder / "bytes"), 0.1);

        const std::string header =
            deployed_header(deployed, {.network = "net", .namespace_name = "mat", .classes = {}},
                            std::span<const std::uint8_t, size.size()>(frames.data(), size.size()));
        CHECK(header.find("tactnet::input_function{static_cast<tactnet::count_rule>(" +
                          std::to_string(static_cast<int>(f.rule)) + ")") != std::string::npos);
        CHECK(onnx_model(m).find(f.rule == count_rule::square_root ? "Sqrt" : "Log") != std::string::npos);
    }
    model<net> m = some_model({count_rule::logarithm, 0});
    CHECK(support::error_of<std::invalid_argument>([&] { static_cast<void>(deploy(m)); }).find("knee") !=
          std::string::npos);
}

TEST_CASE("reflection_average: by the rule of the model, with the outputs of partners exchanged") {
    const model<net> m = some_model({});
    const std::vector<std::uint8_t> frame = some_frames(1);
    std::vector<std::uint8_t> turned(frame.size());
    reflect_image(size, {.columns = true}, frame.data(), turned.data());
    const auto network = deploy(m);
    std::array<float, 3> upright{}, reflected{}, found{};
    using average = reflection_average<deployed<net>::view_type>;
    const auto memory = std::make_unique<average::workspace>();
    const auto of = [](const auto& image) { return std::span(image).template first<size.size()>(); };
    CHECK(network.infer(of(frame), upright) == frame_status::ok);
    CHECK(network.infer(of(turned), reflected) == frame_status::ok);
    CHECK(average(network.view()).infer(of(frame), found, *memory) == frame_status::ok);
    for (std::size_t c = 0; c < 3; ++c)
        CHECK(found[c] == (upright[c] + reflected[2 - c]) / 2);
}

TEST_CASE("model_description: no function, partner or axis that there is not") {
    const support::temporary_folder folder;
    struct wrong {
        const char *key, *value;
    };
    for (const wrong& w :
         {wrong{"input_function", "cube"}, wrong{"input_knee", "1e9"}, wrong{"reflected_axes", "up"},
          wrong{"column_partners", R"(["left","right"])"},
          wrong{"column_partners", R"(["a","left","right"])"},
          wrong{"column_partners", R"(["middle","right","left"])"}, wrong{"column_partners", "[]"}}) {
        CAPTURE(w.key);
        save_model(folder / "net", some_model(functions[1]));
        const safetensors good = safetensors::read(folder / "net");
        safetensors_writer writer;
        writer.metadata = good.metadata();
        CHECK(describe_model(good).reflections == some_model({}).reflections);
        writer.metadata[w.key] = w.value;
        writer.write(folder / "net");
        CHECK_THROWS_AS(static_cast<void>(describe_model(safetensors::read(folder / "net"))), file_error);
    }
}

TEST_CASE("deploy: partners are each other's, and among the outputs") {
    auto network = deploy(some_model({}));
    for (const std::vector<std::size_t>& partners :
         {std::vector<std::size_t>{1, 2, 0}, {0, 1, 3}, {0, 1, 2, 3}})
        CHECK_THROWS_AS(network.set_reflections({{true, partners}, {}}), std::invalid_argument);
    network.set_reflections({{true, {1, 0}}, {}});
}
