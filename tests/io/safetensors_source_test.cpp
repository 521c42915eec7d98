#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/format.hpp>
#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <support/files/bit_flips.hpp>
#include <support/files/temporary_folder.hpp>
#include <system_error>
#include <vector>

namespace {

using namespace tactnet;
using tactnet::element_type;

/// Every element type, and one tensor of more bytes than are read at a time.
safetensors_writer writer_of_all_types() {
    safetensors_writer writer;
    writer.metadata["network"] = "any";
    std::vector<std::byte> bytes(48);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = static_cast<std::byte>(7 * i % 64);
    for (const auto& row : detail::element_type_table)
        writer.add(std::string(row.name), row.type, {2, 24 / row.size}, std::span(bytes));
    writer.add("none", {0, 3}, std::span<const float>{});
    std::vector<float> many(700'001);
    std::iota(many.begin(), many.end(), 0.5F);
    writer.add("many", {many.size()}, std::span<const float>(many));
    return writer;
}

std::string error_of(const std::filesystem::path& path) {
    try {
        static_cast<void>(safetensors_source::open(path));
    } catch (const file_error& error) {
        return error.expected() + " | " + error.found();
    }
    return "no error";
}

TEST_CASE("safetensors_source: every tensor as a reader of the whole file gives it") {
    const support::temporary_folder folder;
    const auto path = folder.path() / "all.safetensors";
    writer_of_all_types().write(path);
    const safetensors whole = safetensors::read(path);
    safetensors_source source = safetensors_source::open(path);
    CHECK(source.metadata() == whole.metadata());
    CHECK(source.checksum() == checksum_state::verified);
    CHECK(source.file() == path.string());
    REQUIRE(source.tensors().size() == 15);
    for (const auto& entry : whole.tensors()) {
        const std::string& name = entry.first;
        CAPTURE(name);
        CHECK(source.at(name).extents == entry.second.extents);
        CHECK(source.values<float>(name) == whole.values<float>(name));
        CHECK(source.values<double>(name) == whole.values<double>(name));
    }
    CHECK(source.values<std::int64_t>("I64") == whole.values<std::int64_t>("I64"));
    CHECK_THROWS_AS(static_cast<void>(source.values<std::int64_t>("I32")), file_error);
    CHECK_THROWS_AS(static_cast<void>(source.values<float>("absent")), file_error);
    std::array<float, 3> room{};
    CHECK_THROWS_AS(source.read<float>("F32", room), std::invalid_argument);
}

TEST_CASE("safetensors_source: bytes go from file to file without being held, and give the same file") {
    const support::temporary_folder folder;
    writer_of_all_types().write(folder / "from");
    safetensors_source source = safetensors_source::open(folder / "from");
    safetensors_writer writer;
    writer.metadata = source.metadata();
    for (const auto& entry : source.tensors())
        writer.add(entry.first, entry.second.type, entry.second.extents,
                   [&, name = entry.first](const auto& take) { source.read_bytes(name, take); });
    writer.write(folder / "to");
    CHECK(read_file(folder / "to") == read_file(folder / "from"));
    CHECK(writer.to_bytes() == read_file(folder / "from"));

    // What does not give as many bytes as it said leaves nothing.
    const std::array<std::byte, 8> bytes{};
    for (const std::size_t given : {7U, 9U}) {
        safetensors_writer wrong;
        wrong.add("x", element_type::float32, {2}, [&](const auto& take) {
            take(std::span(bytes).first(4));
            take(std::span(bytes).first(given - 4));
        });
        CHECK_THROWS_AS(wrong.write(folder / "none"), std::logic_error);
    }
    safetensors_writer broken;
    broken.add("x", element_type::float32, {2},
               [&](const auto&) { throw file_error("from", "", "to read on", "nothing"); });
    CHECK_THROWS_AS(broken.write(folder / "none"), file_error);
    safetensors_writer changing; // between the checksum and the file
    std::byte reading{};
    changing.add("x", element_type::uint8, {1}, [&](const auto& take) {
        take(std::span(&reading, 1));
        reading = std::byte{1};
    });
    CHECK_THROWS_AS(changing.write(folder / "none"), file_error);
    CHECK_FALSE(std::filesystem::exists(folder / "none"));
}

TEST_CASE("safetensors_source: damage is detected as in a file that is read whole") {
    const support::temporary_folder folder;
    const auto path = folder.path() / "small.safetensors";
    safetensors_writer writer;
    writer.add("x", {4}, std::span<const float>(std::array{1.0F, 2.0F, 3.0F, 4.0F}));
    const auto unnoticed = support::unnoticed_flips(
        writer.to_bytes(),
        [&](const auto& bytes) {
            write_file(path, bytes);
            return error_of(path) != "no error";
        },
        300);
    CHECK(unnoticed.empty());

    auto bytes = writer.to_bytes();
    bytes.pop_back();
    write_file(path, bytes);
    CHECK(error_of(path) == "16 bytes of data for all tensors | 15");
    bytes.resize(20);
    write_file(path, bytes);
    CHECK(error_of(path).ends_with(" | 12 up to the end of the file"));
    write_file(path, std::string_view("abc"));
    CHECK(error_of(path) == "a safetensors file of at least 8 bytes | 3");
}

TEST_CASE("safetensors_source: what is no file, and a file that becomes shorter") {
    const support::temporary_folder folder;
    CHECK(error_of(folder.path()) == "a file | a folder");
    CHECK(error_of(folder.path() / "absent") == "a file | nothing of that name");
    if (std::filesystem::exists("/dev/zero"))
        CHECK(error_of("/dev/zero") == "a file | a pipe or a device");
#if defined(__unix__) || defined(__APPLE__)
    // Longer than any file system takes: not even whether there is such a file can be known.
    CHECK(error_of(folder.path() / std::string(5000, 'n')) ==
          "a readable file | '" + std::system_category().message(ENAMETOOLONG) + "'");
#endif

    const auto path = folder.path() / "all.safetensors";
    writer_of_all_types().write(path);
    safetensors_source source = safetensors_source::open(path);
    std::filesystem::resize_file(path, 1'000'000);
    CHECK_THROWS_AS(static_cast<void>(source.values<float>("many")), file_error);
}

static_assert(tactnet::element_size(element_type::boolean) == 1);
static_assert(tactnet::element_size(element_type::bfloat16) == 2);
static_assert(tactnet::element_size(element_type::float64) == 8);
static_assert(tactnet::element_type_of<float>() == element_type::float32);
static_assert(tactnet::element_type_of<double>() == element_type::float64);
static_assert(tactnet::element_type_of<std::uint8_t>() == element_type::uint8);
static_assert(tactnet::element_type_of<std::int16_t>() == element_type::int16);
static_assert(tactnet::element_type_of<std::uint32_t>() == element_type::uint32);
static_assert(tactnet::element_type_of<std::int64_t>() == element_type::int64);
static_assert(!tactnet::storable<bool> && !tactnet::storable<long double>);

TEST_CASE("element_type: each type is found by its own name") {
    for (const auto& row : tactnet::detail::element_type_table) {
        CHECK(tactnet::find_element_type(row.name) == row.type);
        CHECK(tactnet::element_type_name(row.type) == row.name);
        CHECK(tactnet::element_size(row.type) == row.size);
    }
    CHECK_FALSE(tactnet::find_element_type("f32"));
    CHECK_FALSE(tactnet::find_element_type(""));
    CHECK_FALSE(tactnet::find_element_type("F8_E4M3"));
}

TEST_CASE("element_type: float16: all 65536 numbers against the definition") {
    for (std::uint32_t bits = 0; bits < 65536; ++bits) {
        const double sign = (bits & 0x8000U) != 0 ? -1 : 1;
        const int exponent = static_cast<int>((bits >> 10) & 31U);
        const int fraction = static_cast<int>(bits & 1023U);
        const float value = tactnet::float16_to_float(static_cast<std::uint16_t>(bits));
        if (exponent == 31 && fraction != 0) {
            REQUIRE(std::isnan(value));
            continue;
        }
        const double expected = exponent == 31  ? INFINITY
                                : exponent == 0 ? std::ldexp(fraction, -24)
                                                : std::ldexp(1024 + fraction, exponent - 25);
        REQUIRE(static_cast<double>(value) == sign * expected);
        REQUIRE(std::signbit(value) == (sign < 0));
    }
}

TEST_CASE("element_type: bfloat16") {
    CHECK(tactnet::bfloat16_to_float(0x3F80) == 1.0F);
    CHECK(tactnet::bfloat16_to_float(0xC049) == -3.140625F);
    CHECK(tactnet::bfloat16_to_float(0x0001) == std::ldexp(1.0F, -133));
    CHECK(std::isinf(tactnet::bfloat16_to_float(0x7F80)));
    CHECK(std::isnan(tactnet::bfloat16_to_float(0x7FC0)));
}

} // namespace
