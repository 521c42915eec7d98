// Any bytes as a safetensors file: they are read, or refused with a file_error, and nothing else happens.
// What was read can be written, and reads as the same again. Checksums are ignored, or hardly any mutated
// file would reach what follows them; verifying one refuses the file or changes nothing.

#include "fuzz_target.hpp"
#include "safetensors_input.hpp"

#include <tactnet/io/safetensors.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace {

using fuzz::require;
using tactnet::element_type;
using tactnet::safetensors;

template <class T>
void read_as(const safetensors& file, const std::string& name, std::size_t elements) {
    try {
        require(file.values<T>(name).size() == elements);
    } catch (const tactnet::file_error&) {
        // Another element type, or a number too large.
    }
}

void check_verified(std::vector<std::byte> bytes, const safetensors& file) {
    try {
        const auto verified = safetensors::parse(std::move(bytes), "input");
        require(verified.metadata() == file.metadata() && verified.tensors().size() == file.tensors().size());
        require((verified.checksum() == tactnet::checksum_state::absent) ==
                (file.checksum() == tactnet::checksum_state::absent));
    } catch (const tactnet::file_error& error) {
        require(file.checksum() == tactnet::checksum_state::ignored &&
                error.place() == "checksum of the whole file");
    }
}

void check(std::vector<std::byte> bytes) {
    try {
        const auto file = safetensors::parse(bytes, "input", tactnet::checksum_rule::ignore);
        check_verified(std::move(bytes), file);
        tactnet::safetensors_writer writer;
        writer.metadata = file.metadata();
        for (const auto& [name, entry] : file.tensors()) {
            const std::span<const std::byte> stored = file.bytes(name);
            const std::size_t elements = stored.size() / tactnet::element_size(entry.type);
            read_as<float>(file, name, elements);
            read_as<double>(file, name, elements);
            read_as<std::uint8_t>(file, name, elements);
            read_as<std::int64_t>(file, name, elements);
            writer.add(name, entry.type, entry.extents, stored);
        }
        const auto again = safetensors::parse(writer.to_bytes(), "again");
        require(again.checksum() == tactnet::checksum_state::verified);
        require(again.metadata() == file.metadata());
        require(again.tensors().size() == file.tensors().size());
        for (const auto& [name, entry] : file.tensors()) {
            require(again.at(name).type == entry.type);
            require(again.at(name).extents == entry.extents);
            require(std::ranges::equal(again.bytes(name), file.bytes(name)));
        }
        require(!file.contains("no such tensor") || again.contains("no such tensor"));
    } catch (const tactnet::file_error& error) {
        require(error.file() == "input" && !error.expected().empty() && !error.found().empty());
        require(!std::string_view(error.what()).empty());
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    check_both_forms(data, size, check);
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    std::vector<std::vector<std::uint8_t>> seeds;
    const auto add = [&](const tactnet::safetensors_writer& writer) { add_seeds(seeds, writer); };
    tactnet::safetensors_writer empty;
    add(empty);

    tactnet::safetensors_writer network;
    network.metadata["format"] = "pt";
    network.metadata["escapes \" \\ \n"] = "\xC3\xA9\xF0\x9F\x98\x80";
    network.add("conv1.weight", {2, 1, 2, 2}, std::vector<float>{1, -2, 3, 0.5F, 0, 1e-40F, -0.0F, 7});
    network.add("conv1.bias", {2}, std::vector<float>{0.25F, 1e30F});
    network.add("bn1.num_batches_tracked", {}, std::vector<std::int64_t>{17});
    network.add("empty", {0, 3}, std::vector<double>{});
    add(network);

    tactnet::safetensors_writer types;
    constexpr std::array<std::byte, 8> some{std::byte{1}, std::byte{0}, std::byte{60}, std::byte{128}};
    for (const auto& row : tactnet::detail::element_type_table)
        types.add(std::string(row.name), row.type, {8 / row.size}, some);
    add(types);

    const std::string by_hand = R"( {"a":{"x":[1.5e-3,{"y":[true,false,null]}],"dtype":"U8","shape":[1,2],)"
                                R"("data_offsets":[0,2]},"\u00e9\ud83d\ude00":{"shape":[],"dtype":"I8",)"
                                R"("data_offsets":[2,3]}})"
                                "\xFF\1\2\3";
    seeds.emplace_back(by_hand.begin() + 1, by_hand.end());
    return seeds;
}
