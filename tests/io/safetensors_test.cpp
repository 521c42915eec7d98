#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <support/error_of.hpp>
#include <support/files/data_folder.hpp>
#include <support/files/temporary_folder.hpp>
#include <vector>

using tactnet::element_type;
using tactnet::file_error;
using tactnet::safetensors;
using tactnet::safetensors_writer;

namespace {

/// A file by hand: length, header, then `data` bytes that count up from zero.
std::vector<std::byte> make_file(std::string_view header, std::size_t data) {
    const std::uint64_t length = header.size();
    std::vector<std::byte> bytes(8 + header.size() + data);
    std::memcpy(bytes.data(), &length, 8);
    if (!header.empty())
        std::memcpy(bytes.data() + 8, header.data(), header.size());
    for (std::size_t i = 0; i < data; ++i)
        bytes[8 + header.size() + i] = static_cast<std::byte>(i);
    return bytes;
}

std::string error_of(std::vector<std::byte> bytes) {
    return support::error_of<file_error>([&] { safetensors::parse(std::move(bytes), "file"); });
}

std::string error_of(std::string_view header, std::size_t data) {
    return error_of(make_file(header, data));
}

template <class T>
safetensors with(element_type type, const std::vector<T>& values) {
    safetensors_writer writer;
    writer.add("x", type, {values.size()}, std::as_bytes(std::span(values)));
    return safetensors::parse(writer.to_bytes(), "file");
}

} // namespace

TEST_CASE("safetensors: a file by hand") {
    const auto file = safetensors::parse(
        make_file(R"({"__metadata__":{"format":"pt"},"b":{"dtype":"U8","shape":[2,3],"data_offsets":[4,10]},)"
                  R"("a":{"data_offsets":[0,4],"unknown":[{"x":null}],"shape":[],"dtype":"F32"}}   )",
                  10),
        "file");
    CHECK(file.file() == "file");
    CHECK(file.metadata().size() == 1);
    CHECK(file.metadata().at("format") == "pt");
    CHECK(file.tensors().size() == 2);
    CHECK(file.contains("a"));
    CHECK_FALSE(file.contains("c"));
    CHECK(file.at("b").extents == std::vector<std::size_t>{2, 3});
    CHECK(file.at("b").type == element_type::uint8);
    CHECK(file.at("a").extents.empty());
    CHECK(file.values<std::uint8_t>("b") == std::vector<std::uint8_t>{4, 5, 6, 7, 8, 9});
    CHECK(file.values<float>("a").size() == 1);
    CHECK(file.bytes("a").size() == 4);
    CHECK(file.bytes("a")[3] == std::byte{3});
}

TEST_CASE("safetensors: a header that does not agree with the format, or with itself") {
    struct {
        std::string_view header;
        std::size_t data;
        std::string_view error;
    } const cases[] = {
        {"", 0, "file: header, byte 8: expected '{', found an empty header"},
        {" {}", 0, "file: header, byte 8: expected '{', found ' '"},
        {"[]", 0, "file: header, byte 8: expected '{', found '['"},
        {"{", 0, "file: header, byte 9: expected a string, found the end of the header"},
        {"{}x", 0, "file: header, byte 10: expected nothing more, found 'x'"},
        {"{}", 1, "file: end of the file: expected 0 bytes of data for all tensors, found 1"},
        {R"({"a":1})", 0, "file: header, byte 13: expected '{', found '1'"},
        {R"({"a":{}})", 0, "file: tensor 'a': expected the member 'dtype', found none"},
        {R"({"a":{"dtype":"U8","shape":[1]}})", 1,
         "file: tensor 'a': expected the member 'data_offsets', found none"},
        {R"({"a":{"dtype":"U8","data_offsets":[0,1]}})", 1,
         "file: tensor 'a': expected the member 'shape', found none"},
        {R"({"a":{"dtype":"F8","shape":[1],"data_offsets":[0,1]}})", 1,
         "file: tensor 'a': expected a known element type (F32, U8, …), found 'F8'"},
        {R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1],"shape":[1]}})", 1,
         "expected each key once, found 'shape' again"},
        {R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]},"\u0061":{"dtype":"U8","shape":[1],"data_offsets":[0,1]}})",
         1, "expected each key once, found 'a' again"},
        {R"({"__metadata__":{"k":"1","k":"2"}})", 0, "expected each key once, found 'k' again"},
        {R"({"__metadata__":{"k":1}})", 0, "expected a string, found '1'"},
        {R"({"__metadata__":{},"__metadata__":{}})", 0, "expected each key once"},
        {R"({"a":{"dtype":"U8","shape":[-1],"data_offsets":[0,1]}})", 1,
         "expected a whole number, found '-'"},
        {R"({"a":{"dtype":"U8","shape":[1.0],"data_offsets":[0,1]}})", 1,
         "expected a whole number, found '.'"},
        {R"({"a":{"dtype":"U8","shape":1,"data_offsets":[0,1]}})", 1, "expected '[', found '1'"},
        {R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[0]}})", 1, "begin at most end, found 1 numbers"},
        {R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[1,0]}})", 1, "begin at most end, found [1, 0]"},
        {R"({"a":{"dtype":"F32","shape":[2,3],"data_offsets":[0,20]}})", 20,
         "file: tensor 'a': expected 24 bytes for F32 2x3, found 20 in data_offsets"},
        {R"({"a":{"dtype":"F32","shape":[4294967296,4294967296],"data_offsets":[0,0]}})", 0,
         "expected a size within the address space, found F32 4294967296x4294967296"},
        {R"({"a":{"dtype":"F32","shape":[4611686018427387904],"data_offsets":[0,0]}})", 0,
         "expected a size within the address space"},
        {R"({"a":{"dtype":"U8","shape":[2],"data_offsets":[0,2]},"b":{"dtype":"U8","shape":[2],"data_offsets":[1,3]}})",
         3,
         "file: tensor 'b': expected data that begin where the tensor before ends, at 2, found 1 (an "
         "overlap)"},
        {R"({"a":{"dtype":"U8","shape":[2],"data_offsets":[0,2]},"b":{"dtype":"U8","shape":[0],"data_offsets":[1,1]}})",
         2, "(an overlap)"},
        {R"({"a":{"dtype":"U8","shape":[2],"data_offsets":[0,2]},"b":{"dtype":"U8","shape":[2],"data_offsets":[3,5]}})",
         5,
         "file: tensor 'b': expected data that begin where the tensor before ends, at 2, found 3 (a "
         "gap)"},
        {R"({"a":{"dtype":"U8","shape":[2],"data_offsets":[1,3]}})", 3, "at 0, found 1 (a gap)"},
        {R"({"a":{"dtype":"U8","shape":[2],"data_offsets":[0,2]}})", 1,
         "file: file cut short: expected 2 bytes of data for all tensors, found 1"},
        {R"({"a":{"dtype":"U8","shape":[2],"data_offsets":[0,2]}})", 3,
         "file: end of the file: expected 2 bytes of data for all tensors, found 3"},
        {R"({"a":{"dtype":"U8","shape":[18446744073709551615],"data_offsets":[0,18446744073709551615]}})", 3,
         "file: file cut short: expected 18446744073709551615 bytes"},
    };
    for (const auto& wrong : cases) {
        const std::string found = error_of(wrong.header, wrong.data);
        CAPTURE(wrong.header);
        CAPTURE(found);
        CHECK(found.find(wrong.error) != std::string::npos);
    }
}

TEST_CASE("safetensors: lengths that the file does not have") {
    CHECK(error_of(std::vector<std::byte>{}) ==
          "file: expected a safetensors file of at least 8 bytes, found 0");
    CHECK(error_of(std::vector<std::byte>(7)) ==
          "file: expected a safetensors file of at least 8 bytes, found 7");
    auto bytes = make_file("{}", 0);
    bytes[0] = std::byte{3};
    CHECK(error_of(bytes) == "file: header: expected 3 bytes, found 2 up to the end of the file");
    for (std::size_t i = 0; i < 8; ++i)
        bytes[i] = std::byte{0xFF};
    CHECK(error_of(bytes) == "file: header length: expected at most 100000000 bytes in a safetensors file, "
                             "found 18446744073709551615");
}

TEST_CASE("safetensors: a file of another kind is named") {
    const auto error = [](std::string_view begin) {
        const auto bytes = std::as_bytes(std::span(begin.data(), begin.size()));
        return error_of(std::vector<std::byte>(bytes.begin(), bytes.end()));
    };
    CHECK(error("hello world, a text\n") ==
          "file: expected a safetensors file, found text that begins with 'hello wo'");
    CHECK(error("{\n  \"classes\": 22\n}")
              .starts_with("file: expected a safetensors file, found text that begins with '{"));
    CHECK(error("PK\x03\x04\n\n\x08\x08 archive/data.pkl")
              .starts_with("file: expected a safetensors file, found a zip archive"));
    CHECK(
        error("\x80\x02}q\x01(X\x05 conv").starts_with("file: expected a safetensors file, found a pickle"));
    CHECK(error("\x80\x04\x95q\x01(X\x05 conv")
              .starts_with("file: expected a safetensors file, found a pickle"));
    CHECK(
        error("\x89HDF\r\n\x1A\n 0000").starts_with("file: expected a safetensors file, found an HDF5 file"));
    CHECK(error("MATLAB 5.0 MAT-file")
              .starts_with("file: expected a safetensors file, found a file of MATLAB"));
}

TEST_CASE("safetensors: a file cut at any byte is an error, never a crash") {
    safetensors_writer writer;
    writer.metadata["key"] = "value";
    writer.add("w", {2, 2}, std::vector<float>{1, 2, 3, 4});
    writer.add("n", {1}, std::vector<std::int64_t>{7});
    const auto whole = writer.to_bytes();
    CHECK(error_of(whole) == "no error");
    for (std::size_t size = 0; size < whole.size(); ++size)
        CHECK(error_of({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}) != "no error");
}

TEST_CASE("safetensors: tensors without elements share a place with their neighbours") {
    const auto file = safetensors::parse(
        make_file(R"({"a":{"dtype":"U8","shape":[2],"data_offsets":[0,2]},"b":{"dtype":"F32","shape":[0,5],)"
                  R"("data_offsets":[0,0]},"c":{"dtype":"F32","shape":[0],"data_offsets":[2,2]}})",
                  2),
        "file");
    CHECK(file.values<float>("b").empty());
    CHECK(file.values<float>("c").empty());
    CHECK(file.values<std::uint8_t>("a").size() == 2);
    CHECK(safetensors::parse(make_file("{}", 0), "file").tensors().empty());
}

TEST_CASE("safetensors: what is asked for and not there") {
    safetensors_writer writer;
    writer.add("conv1.weight", {8, 1, 5, 5}, std::vector<float>(200));
    const auto file = safetensors::parse(writer.to_bytes(), "net.safetensors");
    const auto message = [](auto action) -> std::string { return support::error_of<file_error>(action); };
    const std::string missing =
        "net.safetensors: expected a tensor 'conv2.weight', found others, such as 'conv1.weight'";
    CHECK(message([&] { file.at("conv2.weight"); }) == missing);
    CHECK(message([&] { file.bytes("conv2.weight"); }) == missing);
    CHECK(message([&] { file.values<float>("conv2.weight"); }) == missing);
    CHECK(message([&] {
              file.require_extents("conv1.weight", std::array<std::size_t, 4>{8, 1, 5, 5});
          }) == "no error");
    CHECK(message([&] {
              file.require_extents("conv1.weight", std::array<std::size_t, 4>{8, 1, 3, 3});
          }) == "net.safetensors: tensor 'conv1.weight': expected 8x1x3x3, found 8x1x5x5");
    CHECK(message([&] { file.require_extents("conv1.weight", std::array<std::size_t, 1>{200}); }) !=
          "no error");
    CHECK(message([&] { file.values<std::uint8_t>("conv1.weight"); }) ==
          "net.safetensors: tensor 'conv1.weight': expected element type U8, found F32");
    CHECK(message([] { safetensors::read("no such file"); }) ==
          "no such file: expected a file, found nothing of that name");
}

TEST_CASE("safetensors: every element type as float and double") {
    using floats = std::vector<float>;
    using doubles = std::vector<double>;
    CHECK(with<std::uint8_t>(element_type::boolean, {0, 1}).values<float>("x") == floats{0, 1});
    CHECK(with<std::uint8_t>(element_type::uint8, {0, 200}).values<float>("x") == floats{0, 200});
    CHECK(with<std::int8_t>(element_type::int8, {-128, 127}).values<double>("x") == doubles{-128, 127});
    CHECK(with<std::int16_t>(element_type::int16, {-32768}).values<float>("x") == floats{-32768});
    CHECK(with<std::uint16_t>(element_type::uint16, {65535}).values<float>("x") == floats{65535});
    CHECK(with<std::int32_t>(element_type::int32, {-2147483647}).values<double>("x") == doubles{-2147483647});
    CHECK(with<std::uint32_t>(element_type::uint32, {4294967295U}).values<double>("x") ==
          doubles{4294967295.0});
    CHECK(with<std::int64_t>(element_type::int64, {-5}).values<float>("x") == floats{-5});
    CHECK(with<std::uint64_t>(element_type::uint64, {1ULL << 63}).values<float>("x") == floats{0x1p63F});
    CHECK(with<std::uint16_t>(element_type::float16, {0x3C00, 0xC000}).values<double>("x") == doubles{1, -2});
    CHECK(with<std::uint16_t>(element_type::bfloat16, {0x3F80, 0xC000}).values<float>("x") == floats{1, -2});
    CHECK(with<float>(element_type::float32, {0.1F}).values<double>("x") ==
          doubles{static_cast<double>(0.1F)});
    CHECK(with<double>(element_type::float64, {0.1, -3}).values<float>("x") == floats{0.1F, -3});
    CHECK(with<double>(element_type::float64, {0.1}).values<double>("x") == doubles{0.1});
    CHECK_THROWS_AS(with<double>(element_type::float64, {1e39}).values<float>("x"), file_error);
    CHECK(with<double>(element_type::float64, {1e39}).values<double>("x") == doubles{1e39});
    const auto special = with<double>(element_type::float64, {-INFINITY, NAN}).values<float>("x");
    CHECK(special.at(0) == -INFINITY);
    CHECK(std::isnan(special.at(1)));
    CHECK(with<std::int64_t>(element_type::int64, {INT64_MIN}).values<std::int64_t>("x").at(0) == INT64_MIN);
    CHECK_THROWS_AS((with<std::int8_t>(element_type::int8, {1}).values<std::uint8_t>("x")), file_error);
    CHECK_THROWS_AS((with<std::uint8_t>(element_type::boolean, {1}).values<std::uint8_t>("x")), file_error);
}

TEST_CASE("safetensors: written and read again, bit by bit") {
    safetensors_writer writer;
    writer.metadata["quote \" backslash \\ tab \t bell \a"] = "caf\xC3\xA9 \xF0\x9F\x98\x80\n";
    writer.metadata["empty"] = "";
    std::vector<float> weights(60);
    std::iota(weights.begin(), weights.end(), -7.25F);
    weights[3] = std::numeric_limits<float>::denorm_min();
    weights[4] = -0.0F;
    writer.add("w", {3, 4, 5}, weights);
    writer.add("bytes", {3}, std::vector<std::uint8_t>{1, 2, 255});
    writer.add("scalar \"\\\n", {}, std::vector<double>{0.1});
    writer.add("count", {1}, std::vector<std::int64_t>{INT64_MIN});
    writer.add("none", {0, 4}, std::vector<float>{});

    const support::temporary_folder folder;
    writer.write(folder / "file.safetensors");
    CHECK(tactnet::read_file(folder / "file.safetensors") == writer.to_bytes());
    const auto file = safetensors::read(folder / "file.safetensors");
    CHECK(file.metadata() == writer.metadata);
    CHECK(file.tensors().size() == 5);
    const auto read = file.values<float>("w");
    REQUIRE(read.size() == weights.size());
    CHECK(std::memcmp(read.data(), weights.data(), read.size() * sizeof(float)) == 0);
    CHECK(file.at("w").extents == std::vector<std::size_t>{3, 4, 5});
    CHECK(file.values<std::uint8_t>("bytes") == std::vector<std::uint8_t>{1, 2, 255});
    CHECK(file.values<double>("scalar \"\\\n") == std::vector<double>{0.1});
    CHECK(file.values<std::int64_t>("count") == std::vector<std::int64_t>{INT64_MIN});
    CHECK(file.at("none").extents == std::vector<std::size_t>{0, 4});
}

TEST_CASE("safetensors: the layout: padded to eight bytes, largest elements first, then by name, whatever "
          "was added first") {
    const std::vector<float> one{1};
    const std::vector<double> two{2};
    const std::vector<std::uint8_t> three{3};
    safetensors_writer a, b;
    a.add("c", {1}, three), a.add("z", {1}, one), a.add("a", {1}, one), a.add("m", {1}, two);
    b.add("m", {1}, two), b.add("a", {1}, one), b.add("z", {1}, one), b.add("c", {1}, three);
    const auto bytes = a.to_bytes();
    CHECK(bytes == b.to_bytes());
    const auto file = safetensors::parse(bytes, "file");
    CHECK(file.at("m").begin == 0);
    CHECK(file.at("a").begin == 8);
    CHECK(file.at("z").begin == 12);
    CHECK(file.at("c").begin == 16);
    CHECK((bytes.size() - 17) % 8 == 0);

    safetensors_writer small;
    small.add("a", {1}, one);
    const auto written = small.to_bytes();
    const std::string text(reinterpret_cast<const char*>(written.data()) + 8, written.size() - 12);
    // The checksums are from another implementation of XXH64.
    CHECK(text == R"({"__metadata__":{"tactnet.checksum":"tactnet-xxh64:9077e78335b1555f"},)"
                  R"("a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}}     )");
    CHECK(safetensors_writer().to_bytes() ==
          make_file(R"({"__metadata__":{"tactnet.checksum":"tactnet-xxh64:94f833bd8af0f8db"}}  )", 0));
}

TEST_CASE("safetensors: what cannot be written is refused when it is added") {
    safetensors_writer writer;
    writer.add("a", {2}, std::vector<float>(2));
    CHECK_THROWS_AS(writer.add("a", {2}, std::vector<float>(2)), std::invalid_argument);
    CHECK_THROWS_AS(writer.add("b", {3}, std::vector<float>(2)), std::invalid_argument);
    CHECK_THROWS_AS(writer.add("__metadata__", {1}, std::vector<float>(1)), std::invalid_argument);
    CHECK_THROWS_AS(writer.add("caf\xE9", {1}, std::vector<float>(1)), std::invalid_argument);
    CHECK_THROWS_AS(writer.add("b", {SIZE_MAX, 2}, std::vector<float>{}), std::invalid_argument);
    writer.metadata["caf\xE9"] = "x";
    const support::temporary_folder folder;
    CHECK_THROWS_AS(writer.write(folder / "file"), std::invalid_argument);
    CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("safetensors: published files" * doctest::test_suite("data")) {
    if (const auto path = support::find_data("published_tactnet4_14x25.safetensors")) {
        const auto file = safetensors::read(*path);
        CHECK(file.metadata().at("classes") == "alphabetical");
        CHECK(file.at("conv2.weight").extents == std::vector<std::size_t>{16, 8, 2, 2});
        file.require_extents("input_mean", std::array<std::size_t, 2>{14, 25});
        for (const auto& [name, entry] : file.tensors())
            for (const float value : file.values<float>(name))
                REQUIRE(std::isfinite(value));
    }
    if (const auto path = support::find_data("published_tactnet4_14x25_golden.safetensors")) {
        const auto file = safetensors::read(*path);
        CHECK(file.values<std::uint8_t>("inputs").size() == 110 * 14 * 25);
        CHECK(file.values<float>("inputs").size() == 110 * 14 * 25);
        CHECK(file.values<double>("logits").size() == 110 * 22);
    }
    if (const auto path = support::find_data("squeezenet1_1_imagenet_features.safetensors")) {
        const auto file = safetensors::read(*path);
        CHECK(file.at("features.0.weight").extents == std::vector<std::size_t>{64, 3, 3, 3});
        // Read and written again, all bytes of all tensors are there.
        safetensors_writer writer;
        writer.metadata = file.metadata();
        for (const auto& [name, entry] : file.tensors())
            writer.add(name, entry.type, entry.extents, file.bytes(name));
        const auto again = safetensors::parse(writer.to_bytes(), "again");
        REQUIRE(again.tensors().size() == file.tensors().size());
        for (const auto& [name, entry] : file.tensors())
            CHECK(std::ranges::equal(again.bytes(name), file.bytes(name)));
    }
}
