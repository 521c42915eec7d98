// Any bytes as recordings of novel and XSENSOR, as NPY and PGM, and as an equilibration of Tekscan.

#include "decoder_fuzz.hpp"
#include "fuzz_target.hpp"

#include <tactnet/sensors/described/npy.hpp>
#include <tactnet/sensors/described/pgm.hpp>
#include <tactnet/sensors/novel.hpp>
#include <tactnet/sensors/tekscan/equilibration.hpp>
#include <tactnet/sensors/xsensor.hpp>

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = fuzz::bytes_of(data, size);
    fuzz_forms(size, 5, [&](std::size_t form) {
        if (form == 0)
            return fuzz::check(tactnet::novel_ascii(), bytes);
        if (form == 1)
            return fuzz::check(tactnet::xsensor_csv(), bytes);
        if (form == 2)
            return fuzz::check(tactnet::npy_array(), bytes, fuzz::cells_of::described);
        if (form == 3)
            return fuzz::check(tactnet::pgm_images({.broken_above = 200}), bytes, fuzz::cells_of::described);
        try {
            const auto found = tactnet::parse_equilibration(bytes);
            fuzz::require(found.counts.size() == found.description.cells());
        } catch (const tactnet::file_error& error) {
            fuzz::require(!error.expected().empty() && !error.found().empty());
        }
    });
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    using namespace std::string_view_literals;
    return {
        fuzz::input("pressure values in kPa\ntime per frame [secs]: 0.5\n\ntime[secs] 1 2 7 8\n0.5 1.5 2 3 "
                    "0\n1 1 2 3 4"),
        fuzz::input(
            "File:,a\nUnits:,mmHg,\nFRAME,7,\nTime, 08:00:01.5\nSENSOR,L\nRows,1\nColumns,2\nSENSELS,\n1,2,\n"
            "GROUP,1\nSENSELS\n9\nFRAME,8\nSENSOR,L\nRows,1\nColumns,2\nSENSELS\n0,3,,\n"),
        fuzz::input("\x93NUMPY\1\0\x3E\0{'descr': '<u2', 'fortran_order': False, 'shape': (2, 1, 2), }\n"
                    "\1\0\2\0\3\0\4\0"sv),
        fuzz::input("P5 # grey\n2 1\n255\n\1\xC9P5 2 1 9\n\3\4"),
        fuzz::input("ROWS 1\nCOLS 1\n\xBB\xBA\xB8\x01\0\0\1\0\0\0"sv)};
}
