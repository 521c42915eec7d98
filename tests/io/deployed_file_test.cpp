#include <tactnet/decision/probabilities.hpp>
#include <tactnet/io/deployed_file.hpp>
#include <tactnet/io/eight_bit_file.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/quantisation.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <support/same_bits.hpp>
#include <utility>
#include <vector>

// Files of networks in 8 bits. That every bit comes back is tested with the networks of deployment/eight_bit.

using namespace tactnet;
using support::same_bits;

namespace {

using net = network<shape{6, 7}, conv2d<4, 3>, relu, residual<sequence<conv2d<4, 3>>>, batch_norm, relu,
                    concatenation<sequence<conv2d<4, 1>>, sequence<conv2d<8, 3>>>, max_pool<2>, dense<5>>;
using bytes_net = deployed<net, eight_bit>;
constexpr std::size_t pixels = net::input_shape.size();

std::vector<std::uint8_t> images(std::size_t count) {
    std::vector<std::uint8_t> all;
    for (std::size_t i = 0; i < count * pixels; ++i)
        all.push_back(static_cast<std::uint8_t>(i * i % 251));
    return all;
}
/// Its weights are no whole multiples of scales as the calibration leaves them, and no two rows are alike.
model<net> trained(std::size_t classes) {
    model<net> m;
    std::size_t i = 0;
    m.network.for_each_parameter([&](const parameter& p, auto values) {
        for (float& v : values)
            v = p.role == parameter_role::running_variance ? 1.5f : std::sin(static_cast<float>(++i)) / 4;
    });
    std::fill(m.normalise.mean.begin(), m.normalise.mean.end(), 20.5f);
    m.normalise.scale = 1.0f / 64;
    for (std::size_t c = 0; c < classes; ++c)
        m.classes.push_back("class " + std::to_string(c));
    return m;
}
bytes_net in_bytes(std::size_t classes = net::outputs) {
    return deploy<eight_bit>(trained(classes), std::span<const std::uint8_t>(images(3)));
}
std::vector<float> outputs_of(const bytes_net& network) {
    return detail::logits_of(network, images(4), net::outputs);
}

const folded_layout& layout() {
    static const folded_layout all = folded_layout_of<bytes_net::view_type>();
    return all;
}
safetensors stored(const bytes_net& network, std::span<const std::uint8_t> selftest = {}) {
    safetensors_writer writer;
    writer.metadata["network"] = "own";
    add_deployed(writer, layout(), network.folded(), network.classes(), selftest,
                 [&](std::span<const std::uint8_t> some) {
                     return detail::logits_of(network, some, network.classes().size());
                 });
    return safetensors::parse(writer.to_bytes(), "net.safetensors");
}

/// The same file with changes: arrays left out, given instead or besides, and other metadata.
struct change {
    std::set<std::string> without{};
    std::function<void(safetensors_writer&)> with = [](safetensors_writer&) {};
};
safetensors changed(const safetensors& file, const change& what) {
    safetensors_writer writer;
    writer.metadata = file.metadata();
    for (const auto& [name, entry] : file.tensors())
        if (!what.without.contains(name))
            writer.add(name, entry.type, entry.extents, file.bytes(name));
    what.with(writer);
    return safetensors::parse(writer.to_bytes(), "net.safetensors");
}
template <class T>
safetensors with_element(const safetensors& file, const std::string& name, std::size_t element, T value) {
    std::vector<T> values = file.values<T>(name);
    values.at(element) = value;
    return changed(file, {{name}, [&](safetensors_writer& w) {
                              w.add(name, element_type_of<T>(), file.at(name).extents,
                                    std::as_bytes(std::span(values)));
                          }});
}

void refuses(const safetensors& file, const std::string& place, const std::string& expected,
             const std::string& found) {
    try {
        static_cast<void>(load_deployed<net, eight_bit>(file));
        FAIL_CHECK("loaded, where it should have refused " << place << " " << found);
    } catch (const file_error& error) {
        CHECK(error.file() == "net.safetensors");
        CHECK_MESSAGE(error.place() == place, error.what());
        CHECK_MESSAGE(error.expected().find(expected) != std::string::npos, error.what());
        CHECK_MESSAGE(error.found().find(found) != std::string::npos, error.what());
    }
}

} // namespace

TEST_CASE("load_deployed: one file gives one probability everywhere, by the temperature that it states") {
    const support::temporary_folder folder;
    const auto path = folder.path() / "net.safetensors", in_bits = folder.path() / "net_8bit.safetensors";
    model<net> m = trained(3);
    m.temperature = 0.5;
    save_model(path, m, {}, images(2));
    CHECK(describe_model(safetensors::read(path)).temperature == 0.5);
    CHECK(load_model<net>(path).temperature == 0.5);
    const auto loaded = load_deployed<net>(path);
    const auto bits = deploy<eight_bit>(load_model<net>(path), std::span<const std::uint8_t>(images(3)));
    save_deployed(in_bits, bits);
    const auto bits_loaded = load_deployed<net, eight_bit>(in_bits);
    const auto counts = images(1);
    const std::span<const std::uint8_t, pixels> frame(counts);
    const auto check = [&](const auto& network) {
        std::array<float, net::outputs> logits;
        REQUIRE(network.infer(frame, logits) == frame_status::ok);
        const double right = temperature_scaling{0.5}.classify(logits, 3)->probability;
        CHECK(right != classify_logits(logits, std::size_t{3})->probability);
        CHECK(network.temperature() == 0.5);
        CHECK(network.classify(frame)->probability == right);
        CHECK(network.view().classify(frame)->probability == right);
        thread_pool alone;
        CHECK(network.classify(std::span<const std::uint8_t>(counts), alone)[0]->probability == right);
    };
    check(loaded), check(bits), check(bits_loaded);

    // A file that states it only in the metadata of its writer, and a temperature that is none.
    m.temperature = 1;
    save_model(path, m, {{"temperature", "2"}});
    CHECK(load_deployed<net>(path).temperature() == 2);
    m.temperature = 0;
    CHECK_THROWS_WITH_AS(save_model(path, m),
                         "model: expected a temperature from 0.001 to 1000, found 0.000000",
                         std::invalid_argument);
    CHECK_THROWS_AS((void)deploy(m), std::invalid_argument);
    CHECK(load_model<net>(path).temperature == 2);
}

TEST_CASE("load_deployed: a model's file gives what load_model and deploy give, tested in that form") {
    const support::temporary_folder folder;
    const auto path = folder.path() / "net.safetensors";
    const model<net> m = trained(3);
    save_model(path, m, {}, images(2));
    const auto loaded = load_deployed<net>(path), own = deploy(load_model<net>(path));
    CHECK(std::equal(loaded.classes().begin(), loaded.classes().end(), own.classes().begin(),
                     own.classes().end()));
    CHECK(same_bits(loaded.folded(), own.folded()));

    // Logits that another network gave.
    model<net> other = trained(3);
    other.network.learnable_values()[0] += 1;
    safetensors_writer writer;
    add_model(writer, model_parts_of(m), images(2),
              [&](std::span<const std::uint8_t> some) { return detail::class_logits(other, some); });
    const safetensors wrong = safetensors::parse(writer.to_bytes(), "wrong.safetensors");
    CHECK_THROWS_WITH_AS((void)load_deployed<net>(wrong), doctest::Contains("self-test"), file_error);
    CHECK_NOTHROW((void)load_deployed<net>(safetensors::read(path), 1e-4)); // an epsilon that hardly differs
}

TEST_CASE("load_deployed: a network that ends in a softmax keeps its self-test of logits") {
    using with_softmax = network<shape{6, 7}, conv2d<4, 3>, relu, dense<5>, softmax>;
    model<with_softmax> m;
    std::size_t i = 0;
    for (float& v : m.network.learnable_values())
        v = std::sin(static_cast<float>(++i)) / 4;
    m.classes = {"a", "b"};
    const support::temporary_folder folder;
    const auto path = folder.path() / "net.safetensors";
    save_model(path, m, {}, images(2));
    const auto loaded = load_deployed<with_softmax>(path);
    CHECK(std::equal(loaded.classes().begin(), loaded.classes().end(), m.classes.begin(), m.classes.end()));
}

TEST_CASE("save_deployed: weights are signed bytes, all else is named by its step") {
    const support::temporary_folder folder;
    const bytes_net network = in_bytes();
    save_deployed(folder / "net.safetensors", network, {{"network", "own"}}, images(2));
    const safetensors file = safetensors::read(folder / "net.safetensors");
    CHECK(file.metadata() ==
          file_metadata{{"bits", "8"},
                        {"classes", R"(["class 0","class 1","class 2","class 3","class 4"])"},
                        {"columns", "7"},
                        {"format", "tactnet"},
                        {"input", "mean"},
                        {"network", "own"},
                        {"rows", "6"},
                        {"version", "1"}});
    std::map<std::string, std::string> arrays;
    for (const auto& [name, entry] : file.tensors())
        arrays[name] = std::string(element_type_name(entry.type)) + " " + shape_text(entry.extents);
    CHECK(arrays.at("step1.weight") == "I8 4x1x3x3");
    CHECK(arrays.at("step1.bias") == "F32 4");
    CHECK(arrays.at("step1.scale") == "F32 4");
    CHECK(arrays.at("step1.input") == "F32 2");
    CHECK(arrays.at("step2.main.step1.added") == "F32 2");
    CHECK(arrays.at("step3.weight") == "F32 4"); // a batch norm by itself, which takes words of 16 bits
    CHECK(arrays.at("step4.branch2.step1.weight") == "I8 8x4x3x3");
    CHECK(arrays.at("step6.weight") == "I8 5x12x3x4");
    CHECK(arrays.at("input_mean") == "F32 6x7");
    CHECK(arrays.at("input_words") == "F32 2");
    CHECK(arrays.at("selftest.input") == "U8 2x6x7");
    CHECK(arrays.at("selftest.logits") == "F32 2x5");
    CHECK(arrays.size() == 33);
    CHECK(describe_model(file).bits == 8U);

    const bytes_net loaded = load_deployed<net, eight_bit>(folder / "net.safetensors");
    CHECK(same_bits(loaded.folded(), network.folded()));
    CHECK(same_bits(outputs_of(loaded), outputs_of(network)));
    CHECK(std::ranges::equal(loaded.classes(), network.classes()));
    // The same bytes once more.
    save_deployed(folder / "again.safetensors", loaded, {{"network", "own"}}, images(2));
    CHECK(read_file(folder / "again.safetensors") == read_file(folder / "net.safetensors"));
}

TEST_CASE("save_deployed: weights between whole multiples of their scales are kept as they are packed") {
    const bytes_net good = in_bytes();
    std::vector<float> folded(good.folded().begin(), good.folded().end());
    for (const folded_step& step : layout().steps)
        if (const auto* const scales = step.find("scale"); scales != nullptr)
            for (std::size_t i = 0; i < step.arrays[0].size; ++i)
                folded[step.arrays[0].offset + i] += 0.3f * folded[scales->offset];
    constexpr std::size_t numbers = bytes_net::view_type::folded_elements;
    const std::span<const float, numbers> all(folded.data(), numbers);
    bytes_net between(all);
    between.set_classes(trained(net::outputs).classes);
    const bytes_net loaded = load_deployed<net, eight_bit>(stored(between));
    CHECK_FALSE(same_bits(loaded.folded(), between.folded()));
    CHECK(same_bits(outputs_of(loaded), outputs_of(between)));
}

TEST_CASE("save_deployed: of fewer classes than outputs it keeps as many filters") {
    const bytes_net network = in_bytes(3);
    const safetensors file = stored(network, images(2));
    file.require_extents("step6.weight", std::vector<std::size_t>{3, 12, 3, 4});
    file.require_extents("step6.scale", std::vector<std::size_t>{3});
    file.require_extents("selftest.logits", std::vector<std::size_t>{2, 3});
    const bytes_net loaded = load_deployed<net, eight_bit>(file);
    CHECK(loaded.classes().size() == 3);
    CHECK(same_bits(detail::logits_of(loaded, images(4), 3), detail::logits_of(network, images(4), 3)));
    const std::vector<float> all = outputs_of(loaded);
    for (std::size_t i = 0; i < all.size(); ++i)
        if (i % net::outputs >= 3)
            CHECK(all[i] == 0);
    CHECK(outputs_of(network) != all);

    safetensors_writer writer;
    const auto no_logits = [](std::span<const std::uint8_t>) { return std::vector<float>(); };
    for (const std::size_t classes : {0U, 6U}) {
        const std::vector<std::string> names(classes, "name");
        CHECK_THROWS_AS(add_deployed(writer, layout(), network.folded(), names, {}, no_logits),
                        std::invalid_argument);
    }
}

TEST_CASE("load_deployed: a file in the other number format is rejected, and the error names both") {
    const support::temporary_folder folder;
    save_model(folder / "float.safetensors", trained(5));
    const safetensors floats = safetensors::parse(read_file(folder / "float.safetensors"), "net.safetensors");
    refuses(floats, "metadata 'bits'", "'8', of a network in 8 bits",
            "none: weights in single precision, of which deploy<eight_bit> and training images make such a "
            "network");
    const safetensors whole = stored(in_bytes());
    CHECK_THROWS_WITH_AS(
        static_cast<void>(load_model<net>(whole)),
        "net.safetensors: metadata 'bits': expected weights in single precision, found '8': a "
        "network in 8 bits, which load_deployed<network, eight_bit> reads",
        file_error);
    const auto says = [&](const char* key, const char* value) {
        return changed(whole, {{}, [&](safetensors_writer& w) { w.metadata[key] = value; }});
    };
    for (const char* bits : {"4", "16", "eight", "8.0", "-8", ""})
        refuses(says("bits", bits), "metadata 'bits'", "'8', or none for single precision",
                "'" + std::string(bits) + "'");
    refuses(says("rows", "7"), "metadata", "a network for 6 x 7", "one for 7 x 7");
    refuses(says("classes", "[]"), "metadata 'classes'", "1 to 5 names", "0");
    refuses(says("classes", R"(["a","b","c","d","e","f"])"), "metadata 'classes'", "1 to 5 names", "6");
    refuses(says("version", "2"), "metadata 'version'", "format version 1", "'2'");
    // Fewer names than filters: of another shape, all of them.
    refuses(says("classes", R"(["a","b","c","d"])"), "", "arrays of this network", "3 of another shape");
}

TEST_CASE("load_deployed: arrays that are missing, misshapen or of another network are refused") {
    const safetensors good = stored(in_bytes());
    for (const auto& [name, entry] : good.tensors())
        refuses(changed(good, {{name}, [](safetensors_writer&) {}}), "",
                "a tensor '" + name + "' of " + shape_text(entry.extents), "none of that name");
    refuses(
        changed(good, {{}, [](safetensors_writer& w) { w.add("conv9.weight", {1}, std::vector<float>{1}); }}),
        "", "only the 31 arrays of this network", "'conv9.weight' of another network");
    for (const auto& tensor : good.tensors()) {
        const std::string& name = tensor.first;
        const safetensors_entry& entry = tensor.second;
        std::vector<std::size_t> extents = entry.extents;
        extents.push_back(1);
        refuses(changed(good,
                        {{name},
                         [&](safetensors_writer& w) { w.add(name, entry.type, extents, good.bytes(name)); }}),
                "tensor '" + name + "'", shape_text(entry.extents), shape_text(extents));
    }
    // Bytes without a sign, and floats, are no weights.
    refuses(changed(good,
                    {{"step1.weight"},
                     [&](safetensors_writer& w) {
                         w.add("step1.weight", element_type::uint8, {4, 1, 3, 3}, good.bytes("step1.weight"));
                     }}),
            "tensor 'step1.weight'", "element type I8", "U8");
    refuses(changed(good, {{"step1.weight"},
                           [&](safetensors_writer& w) {
                               w.add("step1.weight", {4, 1, 3, 3}, good.values<float>("step1.weight"));
                           }}),
            "tensor 'step1.weight'", "element type I8", "F32");
}

TEST_CASE("load_deployed: numbers that cannot be are refused where they stand") {
    const safetensors good = stored(in_bytes());
    const auto refuses_number = [&](const std::string& name, std::size_t element, float value,
                                    const std::string& expected) {
        refuses(with_element(good, name, element, value),
                "tensor '" + name + "', element " + std::to_string(element), expected, "");
    };
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                    infinity = std::numeric_limits<float>::infinity();
    for (const float scale : {0.0f, -0.0f, -1.0f, nan, infinity, -infinity, 1e-40f, 1e31f})
        for (const char* name : {"step1.scale", "step1.input", "step1.output", "step2.main.step1.added",
                                 "step4.branch1.step1.scale", "step6.scale"})
            refuses_number(name, 0, scale, "a scale (a normal number above 0, at most 1e30)");
    for (const float zero : {-1.0f, 256.0f, 7.5f, nan, infinity})
        for (const char* name : {"step1.input", "step1.output", "step2.main.step1.added", "step6.input"})
            refuses_number(name, 1, zero, "a zero (a whole number from 0 to 255)");
    for (const char* name : {"step1.bias", "step3.weight", "step3.bias", "step6.bias"})
        for (const float value : {nan, infinity, -infinity})
            refuses_number(name, 2, value, "a finite number");
    for (const char* name : {"step1.bias", "step2.main.step1.bias", "step6.bias"})
        refuses_number(name, 1, 1e30f, "a filter and a bias whose sums have at most 32 bits");
    refuses_number("input_words", 0, 100, "a power of two");
    refuses_number("input_words", 1, 1e6f, "at most 32767 steps");
    refuses_number("input_mean", 5, nan, "a mean from which no count of 8 bits is further");
    // The least of signed bytes would be more than 127 steps.
    refuses(with_element(good, "step4.branch2.step1.weight", 17, std::int8_t{-128}),
            "tensor 'step4.branch2.step1.weight', element 17", "a whole number from -127 to 127", "-128");
    CHECK_NOTHROW(static_cast<void>(load_deployed<net, eight_bit>(
        with_element(good, "step4.branch2.step1.weight", 17, std::int8_t{-127}))));
}

TEST_CASE("load_deployed: the self-test holds to the bit") {
    const safetensors good = stored(in_bytes(), images(2));
    const float logit = good.values<float>("selftest.logits")[7];
    CHECK_NOTHROW(static_cast<void>(load_deployed<net, eight_bit>(good)));
    for (const float other : {std::nextafter(logit, 1e9f), std::nextafter(logit, -1e9f), 0.0f, -logit})
        refuses(with_element(good, "selftest.logits", 7, other), "self-test, image 1, class 2", "the logit ",
                "");
    refuses(with_element(good, "selftest.logits", 7, std::numeric_limits<float>::quiet_NaN()),
            "tensor 'selftest.logits', element 7", "a finite number", "nan");
    // One step of one weight shows.
    const auto weight = good.values<std::int8_t>("step6.weight")[40];
    refuses(with_element(good, "step6.weight", 40,
                         static_cast<std::int8_t>(weight > 0 ? weight - 9 : weight + 9)),
            "self-test, image 0, class 0", "the logit ", "");
    refuses(changed(good, {{"selftest.input"}, [](safetensors_writer&) {}}), "", "'selftest.input'",
            "others");
}
