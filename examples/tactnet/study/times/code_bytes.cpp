#include "study/times/code_bytes.hpp"

#include "number_options.hpp"
#include "study/times/network_table.hpp"

std::vector<code_size> read_code_bytes(const std::filesystem::path& file) {
    const network_table table(file, "network,bits,bytes", "the target tactnet_program_code_bytes");
    std::vector<code_size> sizes;
    for (const network_line& line : table.lines()) {
        const auto bits = whole_number_of(line.cells[1]), bytes = whole_number_of(line.cells[2]);
        if (!bits || (*bits != 8 && *bits != 32))
            table.refuse(line.number, "8 or 32 bits of a weight", line.cells[1]);
        if (!bytes || *bytes == 0)
            table.refuse(line.number, "a number of bytes above 0", line.cells[2]);
        sizes.push_back({line.method, line.rows, line.columns, *bits, *bytes});
    }
    return sizes;
}
