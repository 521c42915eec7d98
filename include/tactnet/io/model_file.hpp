#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/image/normalisation.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/json_scanner.hpp>
#include <tactnet/io/parameters.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/text.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

// A trained network as one file: arrays, the mean of its inputs, and in the metadata what it is and how its
// inputs are meant. A file may carry inputs and the logits that they gave; loading then checks that they
// still do, so that no mistake of a compiler, a processor or a format goes unseen.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A network with all that it takes to recognise an image.
template <class Network>
struct model {
    Network network;
    normalisation<Network::input_shape> normalise;
    /// As many as the network tells apart: the first outputs, in order.
    std::vector<std::string> classes;

    /// Logits of images stored one after the other: one row of `classes.size()` each.
    /// Throws std::invalid_argument unless there is a whole number of images, one or more.
    [[nodiscard]] std::vector<float> logits(std::span<const std::uint8_t> images,
                                            thread_pool& threads) const {
        constexpr std::size_t size = Network::input_shape.size();
        const std::size_t count = images.size() / size;
        if (count == 0 || images.size() % size != 0)
            throw std::invalid_argument("logits: expected images of " + std::to_string(size) +
                                        " pixels, found " + std::to_string(images.size()) + " pixels");
        typename Network::workspace space;
        typename Network::input_batch in(count);
        typename Network::output_batch out(count);
        for (std::size_t i = 0; i < count; ++i)
            in.set(i, normalise(images.subspan(i * size).template first<size>()));
        network.prepare(threads, space);
        network.logits(threads, space, in, out);
        std::vector<float> result;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < classes.size(); ++c)
                result.push_back(out(i, c));
        return result;
    }
};

using file_metadata = std::map<std::string, std::string, std::less<>>;

/// What a weight file says about itself. What it does not say is empty.
struct model_description {
    std::string network;
    std::optional<std::size_t> rows, columns;
    std::vector<std::string> classes;
    std::optional<double> epsilon; ///< of batch norms
    std::optional<bool> subtracts_mean;
    std::optional<float> scale;
};

namespace detail {

/// The shortest text that reads back as the same number.
template <class Number>
std::string number_text(Number value) {
    char text[64];
    const auto end = std::to_chars(text, text + sizeof(text), value);
    return std::string(text, end.ptr);
}

/// The positive number under a key. Anything else throws if the key is known to be ours (`strict`), and is
/// passed over if it may be another program's word for something else.
template <class Number>
std::optional<Number> number_in(const safetensors& file, std::string_view key, const char* expected,
                                bool strict) {
    const auto found = file.metadata().find(key);
    if (found == file.metadata().end())
        return std::nullopt;
    const std::string& text = found->second;
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value > Number{}) ||
        !std::isfinite(static_cast<double>(value))) {
        if (!strict)
            return std::nullopt;
        throw file_error(file.file(), "metadata '" + std::string(key) + "'", expected, in_quotes(text));
    }
    return value;
}

/// Self-tests compare with what another machine has computed in float.
inline constexpr float selftest_tolerance = 1e-4F;

inline std::string json_array(const std::vector<std::string>& texts) {
    std::string json = "[";
    for (const std::string& text : texts)
        json += (json.size() > 1 ? "," : "") + json_string(text);
    return json + "]";
}

/// Of images in a file: [rows, columns], and channels in front where there are several. With a count,
/// that many of them.
inline std::vector<std::size_t> image_extents(shape image, std::optional<std::size_t> count = std::nullopt) {
    std::vector<std::size_t> extents;
    if (count)
        extents.push_back(*count);
    if (image.channels > 1)
        extents.push_back(image.channels);
    extents.insert(extents.end(), {image.rows, image.columns});
    return extents;
}

template <class Network>
void check_selftest(const safetensors& file, const model<Network>& m) {
    if (!file.contains("selftest.input") && !file.contains("selftest.logits"))
        return;
    const auto& extents = file.at("selftest.input").extents;
    const std::size_t count = extents.empty() ? 0 : extents.front();
    file.require_extents("selftest.input", image_extents(Network::input_shape, count));
    file.require_extents("selftest.logits", std::vector{count, m.classes.size()});
    const std::vector<float> expected = file.values<float>("selftest.logits");
    thread_pool alone;
    const std::vector<float> found = m.logits(file.values<std::uint8_t>("selftest.input"), alone);
    float largest = 0;
    for (const float value : expected)
        largest = std::max(largest, std::abs(value));
    for (std::size_t i = 0; i < expected.size(); ++i)
        if (!(std::abs(found[i] - expected[i]) <= selftest_tolerance * largest))
            throw file_error(file.file(),
                             "self-test, image " + std::to_string(i / m.classes.size()) + ", class " +
                                 std::to_string(i % m.classes.size()),
                             "the logit " + number_text(expected[i]), number_text(found[i]));
}

} // namespace detail

/// Reads the metadata alone, to find the network that the file is for. Throws file_error for another version
/// of the format, and for values that mean nothing. Files made elsewhere may say nothing at all, or use the
/// same keys for anything: of theirs only the name and what reads as a number is taken.
[[nodiscard]] inline model_description describe_model(const safetensors& file) {
    const auto text = [&](std::string_view key) {
        const auto found = file.metadata().find(key);
        return found == file.metadata().end() ? std::string() : found->second;
    };
    model_description d;
    const bool ours = text("format") == "tactnet";
    if (ours && text("version") != "1")
        throw file_error(file.file(), "metadata 'version'", "format version 1", in_quotes(text("version")));
    d.network = text("network");
    d.rows = detail::number_in<std::size_t>(file, "rows", "a number of rows", ours);
    d.columns = detail::number_in<std::size_t>(file, "columns", "a number of columns", ours);
    d.epsilon = detail::number_in<double>(file, "epsilon", "a positive number", ours);
    if (!ours)
        return d;
    const std::string classes = text("classes"), input = text("input");
    json_scanner scanner(classes, file.file() + ": metadata 'classes'", 0);
    scanner.array([&] { d.classes.push_back(scanner.string()); });
    scanner.end();
    if (input != "mean" && input != "scale")
        throw file_error(file.file(), "metadata 'input'", "'mean' or 'scale'", in_quotes(input));
    d.subtracts_mean = input == "mean";
    d.scale = detail::number_in<float>(file, "input_scale", "a positive number", ours);
    return d;
}

/// Fills a model from a file. Without metadata: epsilon 1e-5, inputs are counts minus `input_mean` where
/// there is one, classes are named class_00, class_01, …. `epsilon` goes before the file's. Throws
/// file_error, also when a self-test in the file does not give its logits.
template <class Network>
[[nodiscard]] model<Network> load_model(const safetensors& file,
                                        std::optional<double> epsilon = std::nullopt) {
    constexpr auto shape = Network::input_shape;
    const model_description d = describe_model(file);
    if ((d.rows && *d.rows != shape.rows) || (d.columns && *d.columns != shape.columns))
        throw file_error(file.file(), "metadata",
                         "a network for " + std::to_string(shape.rows) + " x " +
                             std::to_string(shape.columns),
                         "one for " + (d.rows ? std::to_string(*d.rows) : "?") + " x " +
                             (d.columns ? std::to_string(*d.columns) : "?"));
    model<Network> m;
    const std::size_t classes = stored_classes<Network>(file);
    if (!d.classes.empty() && d.classes.size() != classes)
        throw file_error(file.file(), "metadata 'classes'",
                         std::to_string(classes) + " names, as there are logits",
                         std::to_string(d.classes.size()));
    m.network.epsilon = epsilon ? *epsilon : d.epsilon.value_or(1e-5);
    load_parameters(m.network, file, classes);
    if (d.subtracts_mean.value_or(file.contains("input_mean"))) {
        file.require_extents("input_mean", detail::image_extents(shape));
        const std::vector<float> mean = file.values<float>("input_mean");
        detail::check_values(file, "input_mean", mean);
        std::copy(mean.begin(), mean.end(), m.normalise.mean.begin());
    }
    m.normalise.scale = d.scale.value_or(1.0F);
    m.classes = d.classes;
    for (std::size_t c = m.classes.size(); c < classes; ++c)
        m.classes.push_back((c < 10 ? "class_0" : "class_") + std::to_string(c));
    detail::check_selftest(file, m);
    return m;
}

template <class Network>
[[nodiscard]] model<Network> load_model(const std::filesystem::path& path,
                                        std::optional<double> epsilon = std::nullopt) {
    return load_model<Network>(safetensors::read(path), epsilon);
}

/// Writes a model, all or nothing. `metadata` should say the "network" and may say more; what the model
/// itself knows is added. `selftest` holds images to keep with their logits. Throws file_error.
template <class Network>
void save_model(const std::filesystem::path& path, const model<Network>& m, file_metadata metadata = {},
                std::span<const std::uint8_t> selftest = {}) {
    constexpr auto shape = Network::input_shape;
    const bool subtracts =
        std::any_of(m.normalise.mean.begin(), m.normalise.mean.end(), [](float v) { return v != 0; });
    safetensors_writer writer;
    writer.metadata = std::move(metadata);
    writer.metadata["format"] = "tactnet";
    writer.metadata["version"] = "1";
    writer.metadata["rows"] = std::to_string(shape.rows);
    writer.metadata["columns"] = std::to_string(shape.columns);
    writer.metadata["classes"] = detail::json_array(m.classes);
    writer.metadata["epsilon"] = detail::number_text(m.network.epsilon);
    writer.metadata["input"] = subtracts ? "mean" : "scale";
    writer.metadata["input_scale"] = detail::number_text(m.normalise.scale);
    add_parameters(writer, m.network, m.classes.size());
    if (subtracts)
        writer.add("input_mean", detail::image_extents(shape),
                   std::span<const float>(m.normalise.mean.data(), shape.size()));
    if (!selftest.empty()) {
        thread_pool alone;
        const std::vector<float> logits = m.logits(selftest, alone);
        const std::size_t count = selftest.size() / shape.size();
        writer.add("selftest.input", detail::image_extents(shape, count), selftest);
        writer.add("selftest.logits", {count, m.classes.size()}, std::span<const float>(logits));
    }
    writer.write(path);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
