// Any bytes as a map of a Tekscan sensor, and as whatever the bytes themselves show.

#include "decoder_fuzz.hpp"
#include "fuzz_target.hpp"

#include <tactnet/sensors/any_recording.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz_forms(size, 2, [&](std::size_t form) {
        if (form == 0)
            fuzz::check(tactnet::tekscan_map(), fuzz::bytes_of(data, size));
        else
            fuzz::check(tactnet::any_recording(), fuzz::bytes_of(data, size));
    });
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    return {fuzz::input(
                "SENSOR_TYPE NULL\r\nROWS 2\r\nCOLS 3\r\nSENSEL_AREA 1\r\nCOMMENT @@\r\n\tA map.\r\n@@\r\n"
                "SENSOR_MAP @@\r\n0, 2, 4\r\nB, -1, 65535\r\n@@\r\n"),
            fuzz::input("ROWS 1\nCOLS 2\nSENSOR_MAP @@\n7 8\n@@\n"),
            fuzz::input("ROWS 1\nCOLS 2\n\"ASCII_DATA @@\"\n7,8\n"),
            fuzz::input("ROWS 1\nCOLS 2\n\xBB\xBA\xFF\xFF")};
}
