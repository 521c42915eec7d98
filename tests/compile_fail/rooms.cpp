// Cases of rooms that have few: each includes its room.

#ifdef CASE_dense_surf_single_tactel
// expect: dense_surf: expected one map of at least 2 x 2 tactels
#include <tactnet/features.hpp>

constexpr auto descriptors = tactnet::dense_surf<tactnet::shape{1, 1}>::most;

#elif defined(CASE_descriptors_of_temporary)
// expect: would dangle
#include <tactnet/features.hpp>

void run() {
    static_cast<void>(tactnet::dense_surf<tactnet::shape{14, 25, 1}>().descriptors());
}

#elif defined(CASE_words_of_temporary)
// expect: would dangle
#include <tactnet/features.hpp>

#include <vector>

void run() {
    static_cast<void>(tactnet::bag_of_words<2, 3>(std::vector<float>(4)).words());
}

#elif defined(CASE_resize_to_nothing)
// expect: resize: there must be at least one row, one column and one channel on both sides
#include <tactnet/image.hpp>

void run(tactnet::tensor_view<const float, tactnet::shape{7, 13}> from,
         tactnet::tensor_view<float, tactnet::shape{0, 13}> to) {
    tactnet::resize<tactnet::shape{7, 13}, tactnet::shape{0, 13}>(from, to);
}

#elif defined(CASE_transform_of_nothing)
// expect: transform_image: there must be at least one row, one column and one channel
#include <tactnet/image.hpp>

void run(tactnet::tensor_view<const float, tactnet::shape{7, 0}> from,
         tactnet::tensor_view<float, tactnet::shape{7, 0}> to) {
    tactnet::transform_image<tactnet::shape{7, 0}>({}, from, to);
}

#elif defined(CASE_image_too_small)
// expect: tactnet4, tactnet6, tactresnet: the image is smaller than the first kernel of 5 x 5 tactels; image_is_large_enough shows its rows and columns, then the least
// expect: LeastRows = 5; Rows = 4|image_is_large_enough<4UL, 9UL, 5, 5>
#include <tactnet/networks.hpp>

extern tactnet::tactnet4<tactnet::shape{4, 9}, 22> net;

#elif defined(CASE_frame_of_temporary)
// expect: the frame would dangle
#include <tactnet/sensors.hpp>

void run() {
    static_cast<void>(tactnet::read_recording("hand.csv")[5]);
}

#elif defined(CASE_frame_of_temporary_with_shape)
// expect: the frame would dangle
#include <tactnet/sensors.hpp>

void run() {
    static_cast<void>(tactnet::read_recording("hand.csv").as<tactnet::shape{28, 50, 1}>(5));
}

#elif defined(CASE_places_of_temporary)
// expect: would dangle
#include <tactnet/sensors.hpp>

void run() {
    static_cast<void>(tactnet::tekscan_map().places());
}

#elif defined(CASE_warnings_of_temporary)
// expect: would dangle
#include <tactnet/sensors.hpp>

void run() {
    static_cast<void>(tactnet::decoding_warnings().kept());
}

#elif defined(CASE_rows_of_temporary)
// expect: values of a temporary: give it a name
#include <tactnet/svm.hpp>

#include <vector>

void run() {
    static_cast<void>(tactnet::feature_rows<8>(std::vector<float>(16)));
}

#elif defined(CASE_try_view_of_temporary)
// expect: borrowed_range
#include <tactnet/tensor/batch.hpp>

#include <vector>

void run() {
    static_cast<void>(tactnet::try_view<tactnet::shape{2, 3}>(std::vector<float>(6)));
}

#elif defined(CASE_view_of_temporary)
// expect: would dangle
#include <tactnet/tensor/tensor.hpp>

using map = tactnet::tensor<float, tactnet::shape{2, 3}>;

void run() {
    static_cast<void>(map().view());
}

#elif defined(CASE_images_as_taken_of_temporary)
// expect: use of deleted function|deleted (constructor|function)
// expect: borrowed_span
#include <tactnet/training.hpp>

#include <vector>

std::vector<std::uint8_t> recorded();
const auto taken = tactnet::images_as_taken::of<tactnet::shape{28, 50}, tactnet::shape{7, 13}>(recorded());

#elif defined(CASE_labelled_features_of_temporary)
// expect: use of deleted function|deleted (constructor|function)
// expect: borrowed_span
#include <tactnet/training.hpp>

#include <vector>

std::vector<std::size_t> labels();
const std::vector<float> values{1, 2};
const tactnet::labelled_features features{values, labels(), 2};

#elif defined(CASE_labelled_images_of_temporary)
// expect: use of deleted function|deleted (constructor|function)
// expect: image_pixels
#include <tactnet/training.hpp>

#include <vector>

struct data_set {
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels;
};
data_set load();
const std::vector<std::size_t> labels{0, 1};
const tactnet::labelled_images images{load().pixels, labels, 2};

#elif defined(CASE_labelled_images_of_floats)
// expect: labelled_images: images are 8-bit counts .std::uint8_t.; for floats, such as features or filtered values, use labelled_features
#include <tactnet/training.hpp>

#include <vector>

const std::vector<float> values{1, 2};
const std::vector<std::size_t> labels{0, 1};
const tactnet::labelled_images images{values, labels, 2};
#endif
