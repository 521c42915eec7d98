#pragma once

#include <tactnet/io/images/folder.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/svm/feature_rows.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

// Raw pixels as features, for what compares support vector machines.

namespace benchmark {

/// Pixels of images, 1 is the largest count.
struct pixel_rows {
    static constexpr std::size_t rows = 28, columns = 50, features = rows * columns;
    std::vector<float> values;
    std::vector<std::size_t> labels;

    [[nodiscard]] tactnet::feature_rows<features> view() const {
        return tactnet::feature_rows<features>(values);
    }
    void add(std::span<const std::uint8_t> image, std::size_t label) {
        for (const std::uint8_t count : image)
            values.push_back(static_cast<float>(count) / 255);
        labels.push_back(label);
    }
};

struct pixel_split {
    pixel_rows training, test;
};

/// Draws 32 images of each class for training, class after class; the others are for the test.
[[nodiscard]] inline pixel_split split_pixels(const tactnet::image_set& images, std::uint64_t seed) {
    constexpr std::size_t for_training = 32;
    pixel_split split;
    for (std::size_t label = 0; label < images.classes.size(); ++label) {
        std::vector<std::size_t> members;
        for (std::size_t i = 0; i < images.size(); ++i)
            if (images.labels[i] == label)
                members.push_back(i);
        tactnet::random_stream(seed, tactnet::random_purposes::split, static_cast<std::uint32_t>(label))
            .shuffle(members);
        for (std::size_t k = 0; k < members.size(); ++k)
            (k < for_training ? split.training : split.test).add(images.image(members[k]), label);
    }
    return split;
}

/// `decode` as tactnet::load_images takes it.
template <class Decoder>
[[nodiscard]] tactnet::image_set load_pixels(const std::filesystem::path& folder, Decoder decode) {
    return tactnet::load_images(tactnet::list_image_folder(folder), pixel_rows::rows, pixel_rows::columns,
                                decode);
}

} // namespace benchmark
