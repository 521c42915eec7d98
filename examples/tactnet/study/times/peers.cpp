#include "study/times/peers.hpp"

#include "number_options.hpp"
#include "study/times/network_table.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>

namespace {

/// Microseconds: a number above 0 and no more than an hour.
std::optional<double> time_of(std::string_view text) {
    const auto time = number_of(text);
    return time && *time > 0 && *time <= 3.6e9 ? time : std::nullopt;
}

} // namespace

std::vector<peer_time> read_peer_times(const std::filesystem::path& file) {
    const network_table table(file, "network,batch", "benchmark_inference");
    for (const std::string& name : table.names())
        if (name.empty() ||
            name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") !=
                std::string::npos)
            table.refuse(1, "columns of letters, digits and _", name); // they are text of a picture later
    const auto processor = std::ranges::find(table.names(), "processor");
    std::vector<peer_time> times;
    for (const network_line& line : table.lines()) {
        if (line.cells[1] != "1")
            continue; // frames that pass together: a study shows single ones
        for (std::size_t column = 2; column < line.cells.size(); ++column) {
            std::string_view peer = table.names()[column];
            if (!peer.ends_with("_us") || peer.starts_with("tactnet"))
                continue;
            peer.remove_suffix(3);
            constexpr std::string_view in_8_bits = "_8bit";
            const std::size_t bits = peer.ends_with(in_8_bits) ? 8 : 32;
            if (bits == 8)
                peer.remove_suffix(in_8_bits.size());
            const std::string& cell = line.cells[column];
            if (cell == "nan")
                continue; // which the benchmark writes where a peer did not run
            const auto microseconds = time_of(cell);
            if (!microseconds)
                table.refuse(line.number, "microseconds above 0 of " + std::string(peer), cell);
            peer_time& time = times.emplace_back(
                peer_time{std::string(peer), line.method, line.rows, line.columns, *microseconds, bits});
            if (processor != table.names().end())
                time.processor = line.cells[static_cast<std::size_t>(processor - table.names().begin())];
        }
    }
    return times;
}
