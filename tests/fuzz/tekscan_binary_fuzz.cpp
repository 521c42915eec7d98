// Any bytes as a Tekscan binary recording, alone and with the mask of a map.

#include "decoder_fuzz.hpp"
#include "fuzz_target.hpp"

#include <tactnet/sensors/tekscan/binary.hpp>

#include <string>

namespace {

constexpr std::string_view header =
    "VERSION Tek API\nROWS 3\nCOLS 4\nUNITS PSI\nSECONDS_PER_FRAME 0.01\n\xBB\xBA";

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz_forms(size, 2, [&](std::size_t form) {
        if (form == 0)
            return fuzz::check(tactnet::tekscan_binary(), fuzz::bytes_of(data, size));
        // And as the frames after a good header, whose last cells have no tactels.
        std::vector<std::uint8_t> framed = fuzz::input(header);
        framed.insert(framed.end(), data, data + size);
        fuzz::check(tactnet::tekscan_binary({1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0}),
                    fuzz::bytes_of(framed.data(), framed.size()));
    });
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    using namespace std::string_view_literals;
    constexpr std::string_view frames =
        "\x00\x00\x02\x05\x06\x05\x00\x01\xFF\xFF\xFF"
        "\x01\x00\x04\x00\x01\x00\x00\x00\x02\x00\x08\x00\x10\x27\x00\x00\x00\x00\x00\x00"
        "\x10\x00\x08\x00\x34\xFD\x4B\x00\x00\x00\x00\x00\xFF\xFF"
        "\xFF\xFF\xFF\xFF"
        "\x09\x00\x01\x07\xFF\xFF\x07\x00\x00\x00\xFF\xFF\xFF\xFE"sv;
    return {fuzz::input(std::string(header) + std::string(frames)), fuzz::input(frames),
            fuzz::input("ROWS 1\r\nCOLS 2\r\nFRAMES 1\r\n\xBB\xBA\xFF\xFF\xFF\xFF\xFF\xFE"sv)};
}
