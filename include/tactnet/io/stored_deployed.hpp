#pragma once

#include <tactnet/deployment/eight_bit/checks.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/model_description.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/stored_arrays.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

// A network deployed in 8 bits as one file: weights as signed bytes with a scale for each filter, biases,
// ranges of maps, the mean frame, classes, and a self-test. What is saved and loaded has the same bits, of
// its packed weights and of its outputs, with every instruction set: so the self-test is compared to the bit.
//
// This header knows no network's type, but the layout of its folded numbers: programs of many networks may
// call it in one place. Files of a network that is known are in deployed_file.hpp.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What a file holds of a network in 8 bits, for one whose type is known elsewhere.
struct stored_deployed {
    std::vector<float> folded; ///< as the constructor of `deployed` takes them
    std::vector<std::string> classes;
};

namespace detail {

/// The arrays of a file for so many classes. Of the last step it has a filter for each class, as of the
/// network in single precision: others stand for nothing.
[[nodiscard]] inline stored_arrays arrays_of(const folded_layout& layout, std::size_t classes) {
    stored_arrays arrays{{{"input_mean", image_extents(layout.input)}, {"input_words", {2}}}, layout.outputs};
    for (const folded_step& step : layout.steps)
        for (const folded_step::array& array : step.arrays) {
            arrays.list.push_back({array.name, array.extents});
            if (layout.ends_in_weights && &step == &layout.steps.back() && array.kind != folded_kind::range)
                arrays.list.back().extents.front() = classes;
        }
    return arrays;
}

/// visit(array, number of elements in a file for so many classes), in the order of the layout.
template <class Visit>
void for_each_folded(const folded_layout& layout, std::size_t classes, const Visit& visit) {
    const stored_arrays arrays = arrays_of(layout, classes);
    std::size_t i = 2; // behind those of the frame
    for (const folded_step& step : layout.steps)
        for (const folded_step::array& array : step.arrays) {
            std::size_t elements = 1;
            for (const std::size_t extent : arrays.list[i].extents)
                elements *= extent;
            visit(step, array, arrays.list[i++].extents, elements);
        }
}

/// Signed bytes times the scales of their filters.
inline void read_weights(const safetensors& file, const folded_step::array& array,
                         std::span<const float> scales, std::span<float> to) {
    const std::vector<std::int8_t> whole = file.values<std::int8_t>(array.name);
    const std::size_t of_one = array.size / array.extents.front();
    for (std::size_t i = 0; i < whole.size(); ++i) {
        if (whole[i] < -127)
            throw file_error(file.file(), tensor_place(array.name) + ", element " + std::to_string(i),
                             "a whole number from -127 to 127", "-128");
        to[i] = static_cast<float>(whole[i]) * scales[i / of_one];
    }
}

} // namespace detail

/// Reads a network in 8 bits of this layout. Throws file_error for a file in single precision, for arrays
/// that are missing, of other extents or element types, or of another network, and for numbers that cannot
/// be. The self-test is left to `check_deployed`.
[[nodiscard]] inline stored_deployed read_deployed(const safetensors& file, const folded_layout& layout) {
    model_description d = describe_model(file);
    if (!d.bits)
        throw file_error(file.file(), "metadata 'bits'", "'8', of a network in 8 bits",
                         "none: weights in single precision, of which deploy<eight_bit> and training images "
                         "make such a network");
    detail::require_size(file, d, layout.input);
    if (d.classes.empty() || d.classes.size() > layout.outputs)
        throw file_error(file.file(), "metadata 'classes'",
                         "1 to " + std::to_string(layout.outputs) + " names",
                         std::to_string(d.classes.size()));
    const std::size_t classes = d.classes.size();
    require_arrays(file, detail::arrays_of(layout, classes), classes);

    stored_deployed stored{std::vector<float>(layout.numbers), std::move(d.classes)};
    const std::span<float> folded(stored.folded);
    const auto read = [&](const std::string& name, std::size_t begin) {
        const std::vector<float> values = file.values<float>(name);
        std::copy(values.begin(), values.end(), folded.begin() + static_cast<std::ptrdiff_t>(begin));
    };
    read("input_mean", 0);
    read("input_words", layout.input.size());
    detail::for_each_folded(layout, classes, [&](const auto&, const auto& array, const auto&, std::size_t) {
        if (array.kind == folded_kind::scales) // of filters that are not stored
            std::fill_n(folded.begin() + static_cast<std::ptrdiff_t>(array.offset), array.size, 1.0f);
        if (array.kind != folded_kind::weights)
            read(array.name, array.offset);
    });
    // Before weights are multiplied with scales that are none.
    const auto require = [&] {
        if (const auto problem = find_problem(layout, folded))
            throw file_error(file.file(),
                             detail::tensor_place(problem->array) + ", element " +
                                 std::to_string(problem->element),
                             problem->expected, problem->found);
    };
    require();
    detail::for_each_folded(
        layout, classes, [&](const auto& step, const auto& array, const auto&, std::size_t elements) {
            if (array.kind == folded_kind::weights) {
                const auto& scales = *step.find("scale");
                detail::read_weights(file, array, folded.subspan(scales.offset, scales.size),
                                     folded.subspan(array.offset, elements));
            }
        });
    require();
    return stored;
}

/// Throws file_error unless the images that a file carries for that give the very logits of the file.
inline void check_deployed(const safetensors& file, shape input, std::size_t classes,
                           const logits_function& logits) {
    check_selftest(file, input, classes, logits, 0);
}

/// Adds a network in 8 bits to what is to be written. `selftest` holds images to keep with their logits,
/// which are asked for then. Throws std::invalid_argument unless there are 1 to as many classes as outputs.
inline void add_deployed(safetensors_writer& writer, const folded_layout& layout,
                         std::span<const float> folded, std::span<const std::string> classes,
                         std::span<const std::uint8_t> selftest, const logits_function& logits) {
    detail::check_classes("deployed", classes.size(), layout.outputs);
    const std::span<const float> mean = folded.first(layout.input.size());
    add_description(writer.metadata,
                    {.network = {},
                     .rows = layout.input.rows,
                     .columns = layout.input.columns,
                     .classes = {classes.begin(), classes.end()},
                     .epsilon = {},
                     .subtracts_mean = std::any_of(mean.begin(), mean.end(), [](float v) { return v != 0; }),
                     .scale = {},
                     .bits = 8});
    writer.add("input_mean", detail::image_extents(layout.input), mean);
    writer.add("input_words", {2}, folded.subspan(mean.size(), 2));
    detail::for_each_folded(
        layout, classes.size(),
        [&](const folded_step& step, const folded_step::array& array, const auto& extents,
            std::size_t elements) {
            const std::span<const float> values = folded.subspan(array.offset, elements);
            if (array.kind != folded_kind::weights)
                return writer.add(array.name, extents, values);
            const std::size_t of_one = array.size / array.extents.front();
            std::vector<std::int8_t> whole;
            for (std::size_t i = 0; i < elements; ++i)
                whole.push_back(detail::quantised(
                    values[i], static_cast<double>(folded[step.find("scale")->offset + i / of_one])));
            writer.add(array.name, element_type::int8, extents, std::as_bytes(std::span(whole)));
        });
    if (!selftest.empty()) {
        const std::size_t count = selftest.size() / layout.input.size();
        writer.add("selftest.logits", {count, classes.size()}, std::span<const float>(logits(selftest)));
        writer.add("selftest.input", detail::image_extents(layout.input, count), selftest);
    }
}

} // namespace TACTNET_ARCH
} // namespace tactnet
