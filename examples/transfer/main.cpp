// tactnet_transfer: SqueezeNet, trained on photographs, recognises touches: its features before a support
// vector machine (SqueezeNet-SVM of the paper), tested on many splits. Copy it, and change the trunk or the
// machine.
//
//     tactnet_transfer IMAGES WEIGHTS [SPLITS]
//
// IMAGES has one subfolder of 28 × 50 images a class; WEIGHTS is a safetensors file of SqueezeNet 1.1 with
// torchvision's names. Exit status: 0, or 2 with a message.

#include <tactnet/io/images/folder.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/io/pretrained.hpp>
#include <tactnet/networks/imagenet/squeezenet.hpp>
#include <tactnet/svm.hpp>
#include <tactnet/training/data/split.hpp>
#include <tactnet/training/metrics.hpp>
#include <tactnet/transfer.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <decode_image.hpp>
#include <exception>
#include <filesystem>
#include <memory>
#include <span>
#include <standard_output.hpp>
#include <stdexcept>
#include <stopwatch.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

namespace {

using namespace tactnet;

constexpr shape frame{28, 50}, photograph{227, 227, 3};
using trunk = squeezenet1_1_trunk<photograph>;

/// Features of all images, some at a time, so that one sees how far it is.
std::vector<float> features_of(const image_set& images, const trunk& network,
                               const photograph_preprocessing& form, feature_pooling pooling,
                               thread_pool& threads) {
    const feature_extractor<trunk, frame> extract(network, form, pooling);
    std::vector<float> rows;
    const stopwatch watch;
    for (std::size_t first = 0; first < images.size();) {
        std::vector<std::size_t> some;
        for (; first < images.size() && some.size() < 64; ++first)
            some.push_back(first);
        const std::vector<float> part = extract.rows(images.pixels, some, threads);
        rows.insert(rows.end(), part.begin(), part.end());
        std::fprintf(stderr, "\r%zu of %zu images, %.1f ms each", first, images.size(),
                     1e3 * watch.seconds() / static_cast<double>(first));
    }
    std::fprintf(stderr, "\n");
    return rows;
}

struct samples {
    std::vector<float> rows;
    std::vector<std::size_t> labels;
};
samples take(std::span<const float> rows, std::span<const std::size_t> labels,
             std::span<const std::size_t> chosen) {
    const std::size_t features = rows.size() / labels.size();
    samples result;
    for (const std::size_t i : chosen) {
        const auto row = rows.subspan(i * features, features);
        result.rows.insert(result.rows.end(), row.begin(), row.end());
        result.labels.push_back(labels[i]);
    }
    return result;
}

/// The mean over the splits of the part of the test images that a machine recognises.
template <class Kernel>
void test(const char* name, std::span<const float> rows, const image_set& images, std::size_t splits,
          const kernel_training_options<Kernel>& options, thread_pool& threads) {
    const std::size_t features = rows.size() / images.size();
    for (const split_rule rule : {split_rule::random, split_rule::blocked}) {
        std::vector<double> accuracies;
        for (std::uint64_t seed = 0; seed < splits; ++seed) {
            const data_split split = split_data(images.labels, images.classes.size(), rule, seed);
            const samples training = take(rows, images.labels, split.training),
                          tested = take(rows, images.labels, split.test);
            const auto machine = train_kernel_machine(feature_rows<>(training.rows, features),
                                                      training.labels, options, threads)
                                     .machine;
            const std::vector<std::size_t> found =
                machine.predict(feature_rows<>(tested.rows, features), threads);
            std::size_t right = 0;
            for (std::size_t i = 0; i < found.size(); ++i)
                right += found[i] == tested.labels[i] ? 1 : 0;
            accuracies.push_back(100.0 * static_cast<double>(right) / static_cast<double>(found.size()));
        }
        const auto all = mean_and_deviation::of(accuracies);
        std::array<char, 96> line{};
        std::snprintf(line.data(), line.size(), "%-32s %-8s %6.2f ± %.2f %%\n", name,
                      rule == split_rule::random ? "random" : "blocked", all.mean, all.deviation);
        print(line.data());
        finish_output();
    }
}

void run(const std::filesystem::path& folder, const std::filesystem::path& file, std::size_t splits) {
    thread_pool threads(std::max(1U, std::thread::hardware_concurrency()));
    safetensors_source weights = safetensors_source::open(file);
    const auto network = std::make_unique<trunk>();
    const std::array<std::string, 1> unread{"classifier."};
    load_pretrained(*network, weights, unread);
    const photograph_preprocessing form = stored_photograph_preprocessing(weights);
    const image_set images = load_images(list_image_folder(folder), frame.rows, frame.columns, decode_image);

    // As the paper: all features after fire9, one machine for each class, the cost that belongs to a
    // regularisation of 1 ÷ the number of images.
    test<linear_kernel>("all features, linear",
                        features_of(images, *network, form, feature_pooling::none, threads), images, splits,
                        {.cost = 1, .scheme = multiclass::one_versus_rest}, threads);
    // The largest value of each channel: 512 numbers, which do not change with the place of the touch.
    const std::vector<float> largest = features_of(images, *network, form, feature_pooling::maximum, threads);
    test<linear_kernel>("largest of each channel, linear", largest, images, splits,
                        {.cost = 1, .standardise = true}, threads);
    test<rbf_kernel>("largest of each channel, RBF", largest, images, splits,
                     {.cost = 10, .standardise = true}, threads);
}

std::size_t splits_in(std::string_view text) {
    std::size_t splits = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), splits);
    if (error != std::errc() || end != text.data() + text.size() || splits == 0 || splits > 10'000)
        throw std::invalid_argument("SPLITS: expected 1 to 10000, found '" + std::string(text) + "'");
    return splits;
}

} // namespace

int main(int count, char** arguments) {
    ignore_output_signals();
    if (count != 3 && count != 4) {
        std::fprintf(stderr, "tactnet_transfer: expected a folder of images, a file of weights and perhaps a "
                             "number of splits\n");
        return 2;
    }
    try {
        const std::size_t splits = count == 4 ? splits_in(arguments[3]) : 20;
        run(arguments[1], arguments[2], splits);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tactnet_transfer: %s\n", error.what());
        return 2;
    }
    return 0;
}
