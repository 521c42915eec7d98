#include <tactnet/training.hpp>

#include <vector>

#ifdef CASE_images_as_taken_of_temporary
// expect: use of deleted function|deleted (constructor|function)
// expect: borrowed_span
// at-most: 1
std::vector<std::uint8_t> recorded();
const auto taken = tactnet::images_as_taken::of<tactnet::shape{28, 50}, tactnet::shape{7, 13}>(recorded());
#endif

#ifdef CASE_labelled_features_of_temporary
// expect: use of deleted function|deleted (constructor|function)
// expect: borrowed_span
// at-most: 1
std::vector<std::size_t> labels();
const std::vector<float> values{1, 2};
const tactnet::labelled_features features{values, labels(), 2};
#endif

#ifdef CASE_labelled_images_of_temporary
// expect: use of deleted function|deleted (constructor|function)
// expect: borrowed_span
// at-most: 1
struct data_set {
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels;
};
data_set load();
const std::vector<std::size_t> labels{0, 1};
const tactnet::labelled_images images{load().pixels, labels, 2};
#endif
