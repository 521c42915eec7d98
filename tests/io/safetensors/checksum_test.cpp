#include <tactnet/io/safetensors/checksum.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

using namespace tactnet;

namespace {

/// The bytes that xxHash's own program checks itself with (xxhsum.c of version 0.8.1).
std::vector<std::byte> sanity_bytes(std::size_t count) {
    std::vector<std::byte> bytes;
    std::uint64_t generator = 2654435761;
    for (std::size_t i = 0; i < count; ++i, generator *= 11400714785074694797U)
        bytes.push_back(static_cast<std::byte>(generator >> 56));
    return bytes;
}

} // namespace

TEST_CASE("checksum: XXH64's published values") {
    struct {
        std::size_t length;
        std::uint64_t plain, seeded;
    } const published[] = {
        {0, 0xEF46DB3751D8E999, 0xAC75FDA2929B17EF},   {1, 0xE934A84ADB052768, 0x5014607643A9B4C3},
        {4, 0x9136A0DCA57457EE, 0xCAAB286BD8E9FDB5},   {14, 0x8282DCC4994E35C8, 0xC3BD6BF63DEB6DF0},
        {222, 0xB641AE8CB691C174, 0x20CB8AB7AE10C14A},
    };
    for (const auto& row : published) {
        CAPTURE(row.length);
        const std::vector<std::byte> bytes = sanity_bytes(row.length);
        CHECK(xxh64().update(bytes).digest() == row.plain);
        CHECK(xxh64(2654435761).update(bytes).digest() == row.seeded);
    }
    CHECK(xxh64().update("a").digest() == 0xD24EC4F1A98C6E5B);
    CHECK(xxh64().update("abc").digest() == 0x44BC2CF5AD770999);
}

TEST_CASE("checksum: the same in pieces of any size") {
    const std::vector<std::byte> bytes = sanity_bytes(222);
    for (std::size_t size = 1; size < 100; ++size) {
        xxh64 sum;
        for (std::size_t at = 0; at < bytes.size(); at += size)
            sum.update(std::span(bytes).subspan(at, std::min(size, bytes.size() - at)));
        CHECK(sum.digest() == 0xB641AE8CB691C174);
    }
}

TEST_CASE("checksum: as text and back, and no other text") {
    CHECK(checksum_text(0) == "tactnet-xxh64:0000000000000000");
    CHECK(checksum_text(0xEF46DB3751D8E999) == "tactnet-xxh64:ef46db3751d8e999");
    CHECK(parse_checksum("tactnet-xxh64:ef46db3751d8e999") == 0xEF46DB3751D8E999);
    for (const std::string_view wrong :
         {"", "tactnet-xxh64:", "tactnet-xxh64:ef46db3751d8e99", "tactnet-xxh64:ef46db3751d8e9999",
          "tactnet-xxh64:EF46DB3751D8E999", "tactnet-xxh64:ef46db3751d8e99g",
          "tactnet-xxh32:ef46db3751d8e999", "tactnet-xxh64: f46db3751d8e999"})
        CHECK_FALSE(parse_checksum(wrong));
}

TEST_CASE("checksum: of text around its own digits") {
    std::string text = "before " + checksum_text(0) + " behind";
    const std::size_t place = 7 + checksum_mark.size();
    const std::uint64_t sum = xxh64().update(text).digest();
    const auto around = [&] { return checksum_around(std::as_bytes(std::span(text)), place); };
    CHECK(around() == sum);
    text.replace(7, checksum_mark.size() + checksum_digits, checksum_text(sum));
    CHECK(around() == sum);
    text.back() = 'D';
    CHECK(around() != sum);
}
