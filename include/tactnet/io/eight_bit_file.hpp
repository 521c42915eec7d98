#pragma once

#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/deployment/eight_bit/layout.hpp>
#include <tactnet/detail/function_ref.hpp>
#include <tactnet/io/deployed_file.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/model_description.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/io/stored_arrays.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

// A network deployed in 8 bits as one file: weights as signed bytes with a scale per filter, biases, ranges
// of maps, the mean frame, classes, and a self-test. A saved and loaded network has bit-identical packed
// weights and outputs with every instruction set, so the self-test is compared to the bit.
//
// This header needs no network type, only the layout of the folded numbers: programs of many networks may
// call it in one place. eight_bit_file.hpp has the files of a network type.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A network in 8 bits as read from a file, without its type.
struct stored_deployed {
    std::vector<float> folded; ///< for the constructor of `deployed`
    std::vector<std::string> classes;
    double temperature = 1; ///< of probabilities
    input_function function{};
    reflection_rule reflections = reflection_rule::all();
};

namespace detail {

/// The arrays of a file for so many classes: those of the frame, then those of the steps. As in single
/// precision, the last step has a filter per class; the others are not stored. Offsets count in the folded
/// numbers.
[[nodiscard]] [[gnu::cold]] inline stored_arrays arrays_of(const folded_layout& layout, std::size_t classes) {
    const std::size_t pixels = layout.input.size();
    stored_arrays arrays{
        {{"input_mean", image_extents(layout.input), {}, 0, pixels}, {"input_words", {2}, {}, pixels, 2}},
        layout.outputs};
    for (const folded_step& step : layout.steps)
        for (const folded_step::array& array : step.arrays) {
            named_array& stored = arrays.list.emplace_back(array);
            if (layout.ends_in_weights && &step == &layout.steps.back() && array.kind != folded_kind::range) {
                stored.size = stored.size / stored.extents.front() * classes;
                stored.extents.front() = classes;
            }
        }
    return arrays;
}

/// Calls visit(array of the layout, the same array in the file, offset of the scales of its filters) for the
/// arrays of the steps.
[[gnu::cold]] inline void
for_each_folded(const folded_layout& layout, const stored_arrays& arrays,
                function_ref<void(const folded_step::array&, const named_array&, std::size_t)> visit) {
    std::size_t i = 2; // after those of the frame
    for (const folded_step& step : layout.steps) {
        const folded_step::array* const scales = step.find("scale");
        for (const folded_step::array& array : step.arrays)
            visit(array, arrays.list[i++], scales == nullptr ? 0 : scales->offset);
    }
}

} // namespace detail

/// Reads a network in 8 bits of this layout. Throws file_error for a file in single precision, for arrays
/// that are missing, have other extents or element types, or belong to another network, and for invalid
/// numbers. `check_deployed` runs the self-test.
[[nodiscard]] [[gnu::cold]] inline stored_deployed read_deployed(const safetensors& file,
                                                                 const folded_layout& layout) {
    model_description d = describe_model(file);
    if (!d.bits)
        detail::throw_file_error(
            file.file(), {"metadata 'bits'"}, {"'8', of a network in 8 bits"},
            {"none: weights in single precision, of which deploy<eight_bit> and training images "
             "make such a network"});
    detail::require_size(file, d, layout.input);
    const std::size_t classes = d.classes.size();
    if (classes == 0 || classes > layout.outputs)
        detail::throw_file_error(file.file(), {"metadata 'classes'"}, {"1 to ", layout.outputs, " names"},
                                 {classes});
    const stored_arrays arrays = detail::arrays_of(layout, classes);
    require_arrays(file, arrays, classes);

    stored_deployed stored{std::vector<float>(layout.numbers), std::move(d.classes),
                           d.temperature.value_or(1.0), d.function.value_or(input_function{}),
                           d.reflections.value_or(reflection_rule::all())};
    float* const folded = stored.folded.data();
    const auto read = [&](const named_array& array) {
        const std::vector<float> values = file.values<float>(array.name);
        std::copy(values.begin(), values.end(), folded + array.offset);
    };
    read(arrays.list[0]);
    read(arrays.list[1]);
    detail::for_each_folded(layout, arrays, [&](const auto& array, const auto& in_file, std::size_t) {
        if (array.kind == folded_kind::scales) // of filters that are not stored
            std::fill_n(folded + array.offset, array.size, 1.0f);
        if (array.kind != folded_kind::weights)
            read(in_file);
    });
    const auto require_valid = [&] {
        if (const auto problem = detail::find_problem(layout, stored.folded))
            detail::throw_element_error(file.file(), problem->array, problem->element, problem->expected,
                                        problem->found);
    };
    // Before weights are multiplied with invalid scales.
    require_valid();
    detail::for_each_folded(layout, arrays, [&](const auto& array, const auto& in_file, std::size_t scales) {
        if (array.kind != folded_kind::weights)
            return;
        const std::vector<std::int8_t> whole = file.values<std::int8_t>(in_file.name);
        const std::size_t of_one = array.size / array.extents.front();
        for (std::size_t i = 0; i < whole.size(); ++i) {
            if (whole[i] < -127)
                detail::throw_element_error(file.file(), array.name, i, "a whole number from -127 to 127",
                                            "-128");
            folded[array.offset + i] = static_cast<float>(whole[i]) * folded[scales + i / of_one];
        }
    });
    require_valid();
    return stored;
}

/// Throws file_error unless the self-test's images in the file give exactly the logits of the file.
[[gnu::cold]] inline void check_deployed(const safetensors& file, shape input, std::size_t classes,
                                         const logits_function& logits) {
    check_selftest(file, input, classes, logits, 0);
}

/// Adds a network in 8 bits to a file. `selftest` holds images to store with their logits, which `logits`
/// computes. Throws std::invalid_argument unless there are 1 to as many classes as outputs.
[[gnu::cold]] inline void add_deployed(safetensors_writer& writer, const folded_layout& layout,
                                       std::span<const float> folded, std::span<const std::string> classes,
                                       std::span<const std::uint8_t> selftest, const logits_function& logits,
                                       double temperature = 1, const input_function& function = {},
                                       const reflection_rule& reflections = reflection_rule::all()) {
    detail::check_classes("deployed", classes.size(), layout.outputs);
    const std::span<const float> mean = folded.first(layout.input.size());
    bool subtracts = false;
    for (const float value : mean)
        subtracts = subtracts || value != 0;
    add_description(writer.metadata, {.network = {},
                                      .rows = layout.input.rows,
                                      .columns = layout.input.columns,
                                      .classes = {classes.begin(), classes.end()},
                                      .epsilon = {},
                                      .subtracts_mean = subtracts,
                                      .scale = {},
                                      .bits = 8,
                                      .temperature = detail::to_store(temperature),
                                      .function = detail::to_store(function),
                                      .reflections = detail::to_store(reflections)});
    const stored_arrays arrays = detail::arrays_of(layout, classes.size());
    const auto add = [&](const named_array& array) {
        writer.add(array.name, array.extents, folded.subspan(array.offset, array.size));
    };
    add(arrays.list[0]);
    add(arrays.list[1]);
    detail::for_each_folded(layout, arrays, [&](const auto& array, const auto& in_file, std::size_t scales) {
        if (array.kind != folded_kind::weights)
            return add(in_file);
        const std::size_t of_one = array.size / array.extents.front();
        std::vector<std::int8_t> whole;
        for (std::size_t i = 0; i < in_file.size; ++i)
            whole.push_back(detail::quantised(folded[array.offset + i],
                                              static_cast<double>(folded[scales + i / of_one])));
        writer.add(in_file.name, element_type::int8, in_file.extents, std::as_bytes(std::span(whole)));
    });
    detail::add_selftest(writer, layout.input, classes.size(), selftest, logits);
}

// Deployed networks in 8 bits, from and to files of their own, which stored_deployed.hpp describes.

/// Loads a network in 8 bits from a file that `save_deployed` wrote:
///
///     const auto network = load_deployed<net, eight_bit>("tactnet6_8bit.safetensors");
///
/// Throws file_error as `read_deployed`, also unless the self-test in the file gives exactly its logits.
template <class Network, class Format>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] [[gnu::cold]] deployed<Network, eight_bit> load_deployed(const safetensors& file) {
    using bytes = deployed<Network, eight_bit>;
    stored_deployed stored = read_deployed(file, folded_layout_of<typename bytes::view_type>());
    constexpr std::size_t numbers = bytes::view_type::folded_elements;
    bytes network(std::span<const float, numbers>(stored.folded.data(), numbers));
    network.set_input_function(stored.function);
    network.set_reflections(std::move(stored.reflections));
    const std::size_t classes = stored.classes.size();
    check_deployed(file, Network::input_shape, classes, [&](std::span<const std::uint8_t> images) {
        return detail::logits_of(network, images, classes);
    });
    network.set_classes(std::move(stored.classes));
    network.set_temperature(stored.temperature);
    return network;
}
/// Reads the file of a network in 8 bits.
template <class Network, class Format>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] [[gnu::cold]] deployed<Network, eight_bit> load_deployed(const file_name& path) {
    return load_deployed<Network, eight_bit>(safetensors::read(path));
}

/// Writes a network in 8 bits, all or nothing. `metadata` should state the "network" and may state more;
/// `selftest` holds images to store with their logits, which loading expects bit by bit. Throws file_error,
/// and as `add_deployed`.
template <class Network>
[[gnu::cold]] void save_deployed(const std::filesystem::path& path,
                                 const deployed<Network, eight_bit>& network, file_metadata metadata = {},
                                 std::span<const std::uint8_t> selftest = {}) {
    safetensors_writer writer;
    writer.metadata = std::move(metadata);
    add_deployed(
        writer, folded_layout_of<typename deployed<Network, eight_bit>::view_type>(), network.folded(),
        network.classes(), selftest,
        [&](std::span<const std::uint8_t> images) {
            return detail::logits_of(network, images, network.classes().size());
        },
        network.temperature(), network.function(), network.reflections());
    writer.write(path);
}

}} // namespace tactnet
