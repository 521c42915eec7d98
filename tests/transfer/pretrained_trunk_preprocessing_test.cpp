#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/transfer/pretrained_trunk.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <span>
#include <support/files/temporary_folder.hpp>

using namespace tactnet;

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
