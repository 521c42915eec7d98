#include <tactnet/io/pretrained.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <support/error_of.hpp>
#include <support/files/temporary_folder.hpp>
#include <vector>

using namespace tactnet;

namespace {

using trunk = network<shape{4, 6, 3}, conv2d<2, 3>, batch_norm, relu>;

/// Numbers that 16-bit types hold exactly: sign, small integers and halves.
float exact(std::size_t i) {
    return static_cast<float>(static_cast<int>(i % 31) - 7) / 2;
}

/// The upper half of a float; for float16 the same numbers have other bits.
std::uint16_t as_bfloat16(float value) {
    return static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(value) >> 16U);
}
std::uint16_t as_float16(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    if (value == 0)
        return 0;
    return static_cast<std::uint16_t>((bits >> 16U & 0x8000U) | (((bits >> 23U & 0xFFU) - 112U) << 10U) |
                                      (bits >> 13U & 0x3FFU));
}

safetensors_writer file_of(element_type type) {
    safetensors_writer writer;
    for (const parameter& p : trunk::describe()) {
        std::vector<float> values(p.size);
        for (std::size_t i = 0; i < p.size; ++i)
            values[i] = p.role == parameter_role::running_variance ? 1.5F : exact(i + p.offset);
        std::vector<std::uint16_t> halves(p.size);
        std::transform(values.begin(), values.end(), halves.begin(),
                       type == element_type::float16 ? as_float16 : as_bfloat16);
        if (type == element_type::float32)
            writer.add(p.name, p.extents, std::span<const float>(values));
        else
            writer.add(p.name, type, p.extents, std::as_bytes(std::span(halves)));
    }
    return writer;
}

void check_read(const trunk& n) {
    n.for_each_parameter([](const parameter& p, std::span<const float> values) {
        for (std::size_t i = 0; i < values.size(); ++i)
            REQUIRE(values[i] == (p.role == parameter_role::running_variance ? 1.5F : exact(i + p.offset)));
    });
}

} // namespace

TEST_CASE("pretrained: weights in float32, float16 and bfloat16") {
    const support::temporary_folder folder;
    const auto path = folder.path() / "weights.safetensors";
    for (const element_type type : {element_type::float32, element_type::float16, element_type::bfloat16}) {
        CAPTURE(element_type_name(type));
        file_of(type).write(path);
        trunk n;
        load_pretrained(n, path);
        check_read(n);
    }
}

TEST_CASE("pretrained: a trunk from the file of a whole network") {
    const support::temporary_folder folder;
    const auto path = folder.path() / "weights.safetensors";
    safetensors_writer writer = file_of(element_type::float32);
    writer.add("classifier.weight", {2}, std::span<const float>(std::array{1.0F, 2.0F}));
    writer.write(path);
    trunk n;
    const trunk before = n;
    CHECK_THROWS_AS(load_pretrained(n, path), file_error);
    CHECK(std::ranges::equal(n.learnable_values(), before.learnable_values()));
    const std::array<std::string, 1> unread{"classifier."};
    load_pretrained(n, path, unread);
    CHECK_FALSE(std::ranges::equal(n.learnable_values(), before.learnable_values()));
}

TEST_CASE("pretrained: a network among other tensors, under a prefix") {
    const support::temporary_folder folder;
    const auto path = folder.path() / "weights.safetensors";
    const safetensors plain = safetensors::parse(file_of(element_type::float16).to_bytes(), "plain");
    const auto write = [&](const char* extra, const std::string& left_out = "") {
        safetensors_writer writer;
        for (const auto& [name, tensor] : plain.tensors())
            if (name != left_out)
                writer.add("trunk." + name, tensor.type, tensor.extents, plain.bytes(name));
        const std::array one{1.0F};
        writer.add("weights", {1}, std::span<const float>(one));
        writer.add("trunk.input_mean", {1}, std::span<const float>(one));
        writer.add("trunk.classifier.weight", {1}, std::span<const float>(one));
        if (*extra != 0)
            writer.add(extra, {1}, std::span<const float>(one));
        writer.write(path);
    };
    const std::array<std::string, 1> unread{"classifier."};
    const auto error_of_loading = [&] {
        trunk n;
        safetensors_source file = safetensors_source::open(path);
        const std::string error =
            support::error_of<file_error>([&] { load_pretrained(n, file, unread, "trunk."); });
        if (error == "no error")
            check_read(n);
        return error;
    };
    write("");
    CHECK(error_of_loading() == "no error");
    write("classifier.bias"); // what has no prefix is someone else's
    CHECK(error_of_loading() == "no error");
    write("trunk.another");
    CHECK(
        error_of_loading() ==
        path.string() +
            ": expected only the 6 arrays of this network, found tensor 'trunk.another' of another network");
    write("", plain.tensors().begin()->first);
    CHECK(error_of_loading().starts_with(path.string() + ": expected a tensor 'trunk." +
                                         plain.tensors().begin()->first));
}

TEST_CASE("pretrained: values that cannot be") {
    const support::temporary_folder folder;
    const auto path = folder.path() / "weights.safetensors";
    safetensors_writer writer;
    for (const parameter& p : trunk::describe()) {
        std::vector<float> values(p.size, 1);
        if (p.role == parameter_role::shift)
            values[1] = std::numeric_limits<float>::quiet_NaN();
        writer.add(p.name, p.extents, std::span<const float>(values));
    }
    writer.write(path);
    trunk n;
    const std::string error = support::error_of<file_error>([&] { load_pretrained(n, path); });
    CHECK(error.ends_with(".bias', element 1: expected a finite number, found nan"));
}
