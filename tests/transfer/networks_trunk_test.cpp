#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/transfer/as_photograph.hpp>
#include <tactnet/transfer/networks.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <vector>

using namespace tactnet;

namespace {

using net =
    network<shape{6, 8}, as_photograph<extent2d(9, 12)>, named<"features", sequential<conv2d<4, 3>, relu>>,
            named<"classifier", sequential<conv2d<5, 1>, global_average_pool>>>;

struct weights {
    support::temporary_folder folder;
    safetensors_writer writer;
    weights() { add("features.0.weight", {4, 3, 3, 3}), add("features.0.bias", {4}); }
    void add(const std::string& name, const std::vector<std::size_t>& extents, float first = 0.5F) {
        std::size_t size = 1;
        for (const std::size_t extent : extents)
            size *= extent;
        std::vector<float> values(size);
        for (std::size_t i = 0; i < size; ++i)
            values[i] = first + static_cast<float>(i);
        writer.add(name, extents, std::span<const float>(values));
    }
    std::vector<std::vector<float>> read(const photograph_preprocessing& form = torchvision_photograph) {
        const auto path = folder.path() / "weights";
        writer.write(path);
        safetensors_source file = safetensors_source::open(path);
        return pretrained_trunk(file, stored_arrays_of<net>(), form);
    }
    std::string error() {
        try {
            read();
        } catch (const file_error& error) {
            return error.what();
        }
        return "";
    }
};

} // namespace

TEST_CASE("pretrained_trunk: all arrays but those of the last layer, whatever classes the file knows") {
    for (const bool whole : {false, true}) {
        weights file;
        if (whole)
            file.add("classifier.0.weight", {1000, 4, 1, 1}), file.add("classifier.0.bias", {1000});
        const auto arrays = file.read();
        REQUIRE(arrays.size() == net::describe().size());
        CHECK(arrays[2].size() == 108);
        CHECK(arrays[2][107] == 107.5F);
        CHECK(arrays[3] == std::vector{0.5F, 1.5F, 2.5F, 3.5F});
        CHECK(arrays[4].empty());
        CHECK(arrays[5].empty());
    }
}

TEST_CASE("pretrained_trunk: mean and variance for inputs of 0 … 1") {
    weights file;
    const auto torchvision = file.read();
    const double means[] = {0.485, 0.456, 0.406}, deviations[] = {0.229, 0.224, 0.225};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        CHECK(static_cast<double>(torchvision[0][channel]) == doctest::Approx(means[channel]).epsilon(1e-6));
        CHECK(static_cast<double>(torchvision[1][channel]) ==
              doctest::Approx(deviations[channel] * deviations[channel]).epsilon(1e-6));
    }
    const auto caffe = file.read(mean_photograph(123, 117, 104));
    CHECK(caffe[0][2] == doctest::Approx(104.0 / 255));
    CHECK(caffe[1][0] == doctest::Approx(1.0 / 255 / 255));
}

TEST_CASE("pretrained_trunk: what does not belong") {
    weights surplus;
    surplus.add("features.3.weight", {1});
    CHECK(surplus.error().ends_with(
        "expected only the 2 arrays of this network, found tensor 'features.3.weight' "
        "of another network"));
    weights broken;
    broken.writer = {};
    broken.add("features.0.weight", {4, 3, 3, 3}, std::numeric_limits<float>::infinity());
    CHECK(broken.error().ends_with("expected a tensor 'features.0.bias' of 4, found none of that name"));
    broken.add("features.0.bias", {4});
    CHECK(broken.error().ends_with("'features.0.weight', element 0: expected a finite number, found inf"));

    using plain = network<shape{6, 8}, conv2d<4, 3>, dense<5>>;
    weights any;
    any.writer.write(any.folder.path() / "weights");
    safetensors_source file = safetensors_source::open(any.folder.path() / "weights");
    CHECK_THROWS_AS(
        static_cast<void>(pretrained_trunk(file, stored_arrays_of<plain>(), torchvision_photograph)),
        std::invalid_argument);
}

TEST_CASE("pretrained_trunk: of a photograph and a last layer alone, the numbers of the photograph") {
    using shallow = network<shape{6, 8}, as_photograph<extent2d(9, 12)>, dense<5>>;
    weights any;
    any.writer = {};
    for (const std::size_t last : {2u, 3u})
        any.add(stored_arrays_of<shallow>().list[last].name, {1000});
    any.writer.write(any.folder.path() / "weights");
    safetensors_source source = safetensors_source::open(any.folder.path() / "weights");
    const auto arrays = pretrained_trunk(source, stored_arrays_of<shallow>(), torchvision_photograph);
    REQUIRE(arrays.size() == 4);
    CHECK(arrays[0].size() == 3);
    CHECK(arrays[1].size() == 3);
    CHECK(arrays[2].empty());
    CHECK(arrays[3].empty());
}

TEST_CASE("stored_photograph_preprocessing: torchvision's, or the means that the file has") {
    const support::temporary_folder folder;
    safetensors_writer writer;
    writer.add("other.input_mean", {3}, std::span<const float>(std::array{123.5F, 117.0F, 104.0F}));
    writer.add("wrong.input_mean", {1, 3}, std::span<const float>(std::array{1.0F, 2.0F, 3.0F}));
    writer.add("broken.input_mean", {3}, std::span<const float>(std::array{1.0F, 2.0F, NAN}));
    writer.write(folder / "file");
    const safetensors whole = safetensors::read(folder / "file");
    safetensors_source source = safetensors_source::open(folder / "file");
    CHECK(stored_photograph_preprocessing(whole).normalise.mean == torchvision_photograph.normalise.mean);
    CHECK(stored_photograph_preprocessing(source).normalise.scale == torchvision_photograph.normalise.scale);
    for (const photograph_preprocessing& form : {stored_photograph_preprocessing(whole, "other."),
                                                 stored_photograph_preprocessing(source, "other.")}) {
        CHECK(form.normalise.mean == std::array{123.5F, 117.0F, 104.0F});
        CHECK(form.normalise.scale == std::array{1.0F, 1.0F, 1.0F});
        CHECK(form.pixel == resized_pixel::count);
    }
    for (const char* prefix : {"wrong.", "broken."})
        CHECK_THROWS_AS(static_cast<void>(stored_photograph_preprocessing(source, prefix)), file_error);
}
