#include <tactnet/io/checkpoint.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/io/svm_file.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <support/error_of.hpp>
#include <support/files/bit_flips.hpp>
#include <support/files/temporary_folder.hpp>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{4, 6, 1};
using small_network = network<size, conv2d<2, 3>, batch_norm, relu, max_pool<2>, dense<3>>;

model<small_network> example() {
    model<small_network> m;
    float next = 0.25F;
    m.network.for_each_parameter([&](const auto&, auto values) {
        for (auto& value : values)
            value = next += 0.03125F;
    });
    m.normalise.mean.data()[3] = 7.5F;
    m.classes = {"cable", "a \"quoted\", one", "Schlüssel"};
    return m;
}

std::string error_of(std::vector<std::byte> bytes) {
    return support::error_of<file_error>(
        [&] { static_cast<void>(safetensors::parse(std::move(bytes), "file")); });
}
bool noticed(const std::vector<std::byte>& bytes) {
    return error_of(bytes) != "no error";
}

/// The bytes of what is written to a file.
std::vector<std::byte> written(const std::function<void(const std::filesystem::path&)>& write) {
    const support::temporary_folder folder;
    write(folder / "file");
    return read_file(folder / "file");
}

/// A file without tensors.
std::vector<std::byte> with_metadata(const std::string& members) {
    const std::string header = "{\"__metadata__\":{" + members + "}}";
    const std::uint64_t length = header.size();
    std::vector<std::byte> bytes(8 + header.size());
    std::memcpy(bytes.data(), &length, 8);
    std::memcpy(bytes.data() + 8, header.data(), header.size());
    return bytes;
}

} // namespace

TEST_CASE("safetensors: no single bit of a weight file changes unnoticed") {
    for (const std::size_t images : {0U, 2U}) {
        const std::vector<std::uint8_t> pixels(images * size.size(), 9);
        const auto bytes = written([&](const auto& path) {
            save_model(path, example(), {{"network", "small"}, {"seed", "7"}}, pixels);
        });
        REQUIRE_FALSE(noticed(bytes));
        MESSAGE(bytes.size() * 8, " bits");
        CHECK(support::unnoticed_flips(bytes, noticed) == std::vector<std::size_t>{});
    }
}

TEST_CASE("safetensors: no single bit of the file of a support vector machine changes unnoticed") {
    kernel_machine_parameters<rbf_kernel> parts;
    parts.kernel.gamma = 0.5;
    parts.features = 2;
    parts.labels = {0, 3, 4};
    parts.support_counts = {1, 2, 1};
    parts.support_vectors = {1, 2, 3, 4, -1, 0.5F, 0, 7};
    parts.coefficients = {0.5, -0.25, 0.5, -0.25, 0.5, -0.25, 0.5, -0.25};
    parts.offsets = {0.5, -1, 0};
    parts.sigmoids = {{-1, 0.5}, {-2, 0}, {0, 1}};
    const auto bytes = written([&](const auto& path) {
        save_machine(path, kernel_machine<rbf_kernel>(parts), {{"classes", "[\"a\",\"b\",\"c\"]"}});
    });
    REQUIRE_FALSE(noticed(bytes));
    CHECK(support::unnoticed_flips(bytes, noticed) == std::vector<std::size_t>{});
}

TEST_CASE("safetensors: no single bit of a checkpoint changes unnoticed") {
    std::vector<float> weights(20, 0.5F);
    std::vector<double> statistics(7, -1);
    const std::vector<state_array> arrays{{"values", weights, {}}, {"best.statistics", {}, statistics}};
    const std::vector<double> progress{3, 0.5, 0.25};
    const file_metadata settings{{"seed", "3"}, {"network", "small"}};
    const auto bytes = written([&](const auto& path) { save_checkpoint(path, arrays, progress, settings); });
    REQUIRE_FALSE(noticed(bytes));
    CHECK(support::unnoticed_flips(bytes, noticed) == std::vector<std::size_t>{});

    const support::temporary_folder folder;
    write_file(folder / "t.checkpoint", std::span<const std::byte>(bytes));
    CHECK(load_checkpoint(
              folder / "t.checkpoint", arrays, [](std::span<const double>) {}, settings) ==
          checksum_state::verified);
}

TEST_CASE("safetensors: two thousand flips in a larger file") {
    safetensors_writer writer;
    std::vector<float> values(30'000);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(i % 977) / 977;
    for (const char* name : {"conv1.weight", "conv2.weight", "fc.weight"})
        writer.add(name, {100, 300}, values);
    const auto bytes = writer.to_bytes();
    REQUIRE_FALSE(noticed(bytes));
    CHECK(support::unnoticed_flips(bytes, noticed, 2000) == std::vector<std::size_t>{});
}

TEST_CASE("safetensors: a reader reports whether there was a checksum, and what was found") {
    safetensors_writer writer;
    writer.metadata["format"] = "pt";
    writer.add("a", {2}, std::vector<float>{1, 2});
    auto bytes = writer.to_bytes();
    const auto file = safetensors::parse(bytes, "file");
    CHECK(file.checksum() == checksum_state::verified);
    CHECK(file.metadata() == file_metadata{{"format", "pt"}});
    CHECK(safetensors::parse(with_metadata(R"("format":"pt")"), "file").checksum() == checksum_state::absent);

    bytes.back() ^= std::byte{1};
    const std::string error = error_of(bytes);
    CAPTURE(error);
    CHECK(error.starts_with("file: checksum of the whole file: expected tactnet-xxh64:"));
    CHECK(error.find(", as when it was written, found tactnet-xxh64:") != std::string::npos);
    CHECK(error.find("is damaged, or was changed by a program that kept the metadata 'tactnet.checksum'") !=
          std::string::npos);
    const auto ignored = safetensors::parse(bytes, "file", checksum_rule::ignore);
    CHECK(ignored.checksum() == checksum_state::ignored);
    CHECK(ignored.values<float>("a")[0] == 1);

    const support::temporary_folder folder;
    write_file(folder / "damaged", std::span<const std::byte>(bytes));
    CHECK_THROWS_AS(static_cast<void>(safetensors::read(folder / "damaged")), file_error);
}

TEST_CASE("safetensors: malformed checksums are rejected") {
    const std::string right = R"("tactnet.checksum":"tactnet-xxh64:0123456789abcdef")";
    const auto has = [](const std::string& error, std::string_view part) {
        CAPTURE(error);
        CHECK(error.find(part) != std::string::npos);
    };
    has(error_of(with_metadata(right)),
        "checksum of the whole file: expected tactnet-xxh64:0123456789abcdef");
    has(error_of(with_metadata(right + "," + right)), "each key once, found 'tactnet.checksum' again");
    has(error_of(with_metadata(right + R"(,"\u0074actnet.checksum":"tactnet-xxh64:0123456789abcdef")")),
        "each key once");
    has(error_of(with_metadata(R"("tactnet.checksun":"tactnet-xxh64:0123456789abcdef")")),
        "metadata 'tactnet.checksun': expected checksums under 'tactnet.checksum' alone, found "
        "'tactnet-xxh64:0123456789abcdef': the file is damaged");
    for (const std::string value :
         {"", "none", "tactnet-xxh64:0123456789ABCDEF", "tactnet-xxh64:0123456789abcde",
          "tactnet-xxh64:0123456789abcdef0", R"(tactnet-xxh64:\u00310123456789abcde)"})
        has(error_of(with_metadata(R"("tactnet.checksum":")" + value + '"')),
            "metadata 'tactnet.checksum': expected 'tactnet-xxh64:' and 16 hexadecimal digits, found '");
    has(error_of(with_metadata(R"("tactnet.checksum":1)")), "expected a string, found '1'");
}

TEST_CASE("safetensors: the checksum is the writer's alone") {
    safetensors_writer writer;
    const auto bytes = writer.to_bytes();
    writer.metadata[std::string(safetensors_checksum_key)] = "mine";
    CHECK(writer.to_bytes() == bytes);
    writer.metadata["other"] = "tactnet-xxh64: mine";
    CHECK_THROWS_AS(static_cast<void>(writer.to_bytes()), std::invalid_argument);
}
