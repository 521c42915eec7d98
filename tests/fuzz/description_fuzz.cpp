// Any bytes as the description of an array: either a sentence, or a description that is written and read
// again as the same, and that a decoder takes.

#include "decoder_fuzz.hpp"
#include "fuzz_target.hpp"

#include <tactnet/sensors/described/description_file.hpp>
#include <tactnet/sensors/described/matrix_stream.hpp>
#include <tactnet/sensors/described/text_stream.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    tactnet::sensor_description description;
    try {
        description = tactnet::parse_sensor({reinterpret_cast<const char*>(data), size});
    } catch (const tactnet::file_error& error) {
        fuzz::require(!error.expected().empty() && !error.found().empty());
        return 0;
    }
    const std::string json = tactnet::sensor_json(description);
    fuzz::require(tactnet::sensor_json(tactnet::parse_sensor(json)) == json);
    if (description.cells() > 64 || description.packet_bytes() > 256)
        return 0;
    if (description.cell == tactnet::cell_type::digits)
        fuzz::check(tactnet::text_stream(description), fuzz::bytes_of(data, size), fuzz::cells_of::described);
    else
        fuzz::check(tactnet::matrix_stream(description), fuzz::bytes_of(data, size),
                    fuzz::cells_of::described);
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    return {fuzz::input(R"({"rows": 2, "columns": 4, "cell": "int16", "byte_order": "big", "serpentine": true,
                            "blocks": "side by side", "transposed": true, "rotation": 270, "marker": "0A 20",
                            "checksum": {"kind": "crc8", "polynomial": 49, "negated": false}, "offset": -2.5})"),
            fuzz::input(R"({"rows": 2, "columns": 2, "cell": "digits", "line": "row", "header_lines": 1,
                            "leading_fields": 2, "seconds_per_tick": 1e-3, "broken": ["nan", "-inf", 7],
                            "broken_above": 1000, "full_scale": 10, "full_scale_pressure": 5})")};
}
