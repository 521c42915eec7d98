#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/image/augmentation.hpp>
#include <tactnet/image/resize.hpp>
#include <tactnet/image/transform.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/training/data/split.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <class Range>
using range_element = std::remove_cv_t<typename decltype(std::span(std::declval<Range&>()))::element_type>;

/// A contiguous range of std::array without gaps between their elements.
template <class Range, class T>
concept range_of_arrays = std::is_same_v<typename range_element<Range>::value_type, T> &&
                          sizeof(range_element<Range>) == std::tuple_size_v<range_element<Range>> * sizeof(T);

} // namespace detail

/// A span whose elements outlive the expression that it is made of: a temporary container does not convert. A
/// range of std::array becomes the span of all their elements.
template <class T>
class borrowed_span : public std::span<T> {
public:
    constexpr borrowed_span() = default;
    constexpr borrowed_span(T* elements, std::size_t size) : std::span<T>(elements, size) {}
    template <class Range>
        requires borrowed_range<Range> && std::is_convertible_v<Range, std::span<T>>
    constexpr borrowed_span(Range&& elements) : std::span<T>(elements) {}
    template <class Range>
        requires borrowed_range<Range> && detail::range_of_arrays<Range, std::remove_const_t<T>>
    constexpr borrowed_span(Range&& arrays)
        : std::span<T>(std::empty(arrays) ? nullptr : std::data(arrays)->data(),
                       std::size(arrays) * std::tuple_size_v<detail::range_element<Range>>) {}
    /// The elements of a temporary would be gone.
    template <class Range>
        requires(!borrowed_range<Range>)
    borrowed_span(const Range&&) = delete;
};

/// The pixels of images as counts. Floats are refused with a hint at labelled_features.
class image_pixels : public borrowed_span<const std::uint8_t> {
public:
    using borrowed_span<const std::uint8_t>::borrowed_span;
    template <class Range>
        requires(!borrowed_range<Range>)
    image_pixels(const Range&&) = delete; // inherited, it would be two errors
    template <class Range>
        requires borrowed_range<Range> && std::is_convertible_v<Range, std::span<const float>>
    constexpr image_pixels(Range&&, int = 0) { // with the same parameters, Clang 14 would inherit no other
        static_assert(sizeof(Range) == 0,
                      "labelled_images: images are 8-bit counts (std::uint8_t); for floats, such "
                      "as features or filtered values, use labelled_features");
    }
};

namespace detail {

template <shape Taken, shape Seen>
void vary_and_reduce(const image_transform& t, const std::uint8_t* from, float* to) {
    alignas(vector_alignment) std::array<float, Taken.size()> varied;
    transform_image<Taken>(t, std::span<const std::uint8_t, Taken.size()>(from, Taken.size()),
                           tensor_view<float, Taken>(varied.data()));
    resize<Taken, Seen>(tensor_view<const float, Taken>(varied.data()), tensor_view<float, Seen>(to));
    for (std::size_t e = 0; e < Seen.size(); ++e) // bicubic interpolation overshoots
        to[e] = std::clamp(to[e], 0.0f, 255.0f);
}

} // namespace detail

/// The larger images that small ones were reduced from. Shifting a touch by half a tactel of a small image,
/// or turning it by some degrees, gives an image that cannot be computed from the small one. To learn from
/// small images, transform what the sensor recorded and reduce the result. A view.
///
///     labelled_images{small, labels, 22, images_as_taken::of<shape{28, 50}, shape{7, 13}>(large)}
struct images_as_taken {
    /// Writes a transformed image, reduced.
    using variation = void (*)(const image_transform&, const std::uint8_t* from, float* to);

    borrowed_span<const std::uint8_t> pixels{}; ///< one image after the other, in the order of the small ones
    shape taken{}, seen{};                      ///< before and after they are reduced
    variation vary = nullptr;                   ///< null if there are no larger images

    /// Reduces as `resize` does: bicubic, with antialiasing.
    template <shape Taken, shape Seen>
    [[nodiscard]] static images_as_taken of(borrowed_span<const std::uint8_t> pixels) {
        return {pixels, Taken, Seen, &detail::vary_and_reduce<Taken, Seen>};
    }
    /// Whether there are larger images.
    [[nodiscard]] bool given() const { return vary != nullptr; }
    /// Tactels of the large images for one of the small, in the direction with more.
    [[nodiscard]] double tactels_for_one() const {
        return std::max(static_cast<double>(taken.rows) / static_cast<double>(seen.rows),
                        static_cast<double>(taken.columns) / static_cast<double>(seen.columns));
    }
};

/// Images of one size as 8-bit counts, and the class of each. The pixels are contiguous: a vector of bytes,
/// or of a std::array for each image. A view.
struct labelled_images {
    image_pixels pixels;
    borrowed_span<const std::size_t> labels;
    std::size_t classes = 0;
    images_as_taken taken{}; ///< the images that they were reduced from, if any

    template <shape Shape>
    [[nodiscard]] std::span<const std::uint8_t, Shape.size()> image(std::size_t index) const {
        return std::span<const std::uint8_t, Shape.size()>(pixels.data() + index * Shape.size(),
                                                           Shape.size());
    }
};

/// Features of samples, equally many for each and stored contiguously, and the class of each sample. Features
/// are the outputs of other layers, for layers that are trained on top of them. A view.
struct labelled_features {
    borrowed_span<const float> values;
    borrowed_span<const std::size_t> labels;
    std::size_t classes = 0;
};

/// The samples that a network learns from and is tested on: images or features. A view.
class labelled_samples {
public:
    labelled_samples(const labelled_images& images)
        : labels_(images.labels), classes_(images.classes), numbers_(images.pixels), taken_(images.taken) {}
    labelled_samples(const labelled_features& features)
        : labels_(features.labels), classes_(features.classes), numbers_(features.values) {}

    [[nodiscard]] std::size_t size() const { return labels_.size(); }
    [[nodiscard]] std::size_t classes() const { return classes_; }
    [[nodiscard]] std::size_t label(std::size_t sample) const { return labels_[sample]; }
    [[nodiscard]] std::span<const std::size_t> labels() const { return labels_; }
    [[nodiscard]] bool are_images() const { return numbers_.index() == 0; }

    /// The counts of all images. Throws std::logic_error for features.
    [[nodiscard]] std::span<const std::uint8_t> pixels() const {
        if (!are_images())
            throw std::logic_error("labelled_samples: expected images, found features");
        return std::get<0>(numbers_);
    }
    /// The images that these were reduced from, if any.
    [[nodiscard]] const images_as_taken& taken() const { return taken_; }
    /// Copies the counts or the features of one sample, as many as there is room for.
    void copy(std::size_t sample, std::span<float> to) const {
        std::visit(
            [&](const auto& numbers) {
                const auto of_sample = numbers.subspan(sample * to.size(), to.size());
                std::transform(of_sample.begin(), of_sample.end(), to.begin(),
                               [](auto number) { return static_cast<float>(number); });
            },
            numbers_);
    }

    /// Throws std::invalid_argument if the network has fewer outputs than there are classes, if a label is
    /// neither a class nor no_class, or if the number of values does not match the labels and the input.
    void check(shape input, std::size_t outputs) const {
        const std::size_t expected = size() * input.size(),
                          found = std::visit([](const auto& numbers) { return numbers.size(); }, numbers_);
        if (classes_ == 0 || classes_ > outputs)
            refuse({"1 to ", outputs, " classes"}, {classes_});
        if (found != expected)
            refuse({expected, are_images() ? " pixels" : " numbers"}, {found});
        if (taken_.given() && taken_.seen != input)
            refuse({"images as taken that are reduced to ", text_of(input)}, {text_of(taken_.seen)});
        if (taken_.given() && taken_.pixels.size() != size() * taken_.taken.size())
            refuse({size() * taken_.taken.size(), " pixels of images as taken"}, {taken_.pixels.size()});
        for (const std::size_t label : labels_)
            if (label >= classes_ && label != no_class)
                refuse({"labels below ", classes_}, {label});
    }
    /// Throws std::invalid_argument if a chosen sample is not one of these, as with the split of other
    /// samples.
    void check_indices(std::span<const std::size_t> chosen) const {
        for (const std::size_t sample : chosen)
            if (sample >= size())
                refuse({"indices below ", size(), " in the split"}, {sample});
    }
    /// As `check_indices`, and throws also if a chosen sample is of no class: such samples are for training
    /// alone.
    void check_classes(std::span<const std::size_t> chosen) const {
        check_indices(chosen);
        for (const std::size_t sample : chosen)
            if (label(sample) == no_class)
                refuse({"samples of a class for validation and test"}, {"an outlier, sample ", sample});
    }
    /// Throws std::invalid_argument for a feature that is not finite. `input` is the shape of a sample.
    void check_finite(shape input) const {
        if (are_images())
            return;
        const std::span<const float> features = std::get<1>(numbers_);
        for (std::size_t i = 0; i < features.size(); ++i)
            if (!std::isfinite(features[i]))
                refuse({"a finite number in sample ", i / input.size(), ", feature ", i % input.size()},
                       {std::to_string(features[i])});
    }

private:
    [[noreturn]] void refuse(detail::text_parts expected, detail::text_parts found) const {
        detail::throw_invalid_argument({are_images() ? "images: expected " : "features: expected ",
                                        detail::joined(expected), ", found ", detail::joined(found)});
    }
    static std::string text_of(const shape& s) {
        return detail::joined({s.rows, " x ", s.columns, " x ", s.channels});
    }

    std::span<const std::size_t> labels_;
    std::size_t classes_;
    std::variant<std::span<const std::uint8_t>, std::span<const float>> numbers_;
    images_as_taken taken_;
};

}} // namespace tactnet

template <class T>
inline constexpr bool std::ranges::enable_borrowed_range<tactnet::borrowed_span<T>> = true;
