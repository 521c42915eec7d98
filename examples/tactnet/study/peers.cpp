#include "study/peers.hpp"

#include "number_options.hpp"

#include <tactnet/io/file.hpp>
#include <tactnet/io/file_error.hpp>

#include <fmt/format.h>

#include <optional>
#include <printable.hpp>
#include <string_view>

namespace {

constexpr std::size_t largest_table = std::size_t{1} << 20U; // bytes

/// The text in front of `separator`, which is taken off, or all of it.
std::string_view next_part(std::string_view& text, char separator) {
    const std::size_t length = text.find(separator);
    const std::string_view part = text.substr(0, length);
    text.remove_prefix(length == std::string_view::npos ? text.size() : length + 1);
    return part;
}

std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    if (line.ends_with('\r'))
        line.remove_suffix(1);
    while (!line.empty())
        cells.push_back(next_part(line, ','));
    return cells;
}

/// Microseconds: a number above 0 and no more than an hour.
std::optional<double> time_of(std::string_view text) {
    const auto time = number_of(text);
    return time && *time > 0 && *time <= 3.6e9 ? time : std::nullopt;
}

/// "tactnet6/28x50", or nothing.
std::optional<peer_time> network_of(std::string_view text) {
    peer_time network{};
    network.method = next_part(text, '/');
    const auto rows = whole_number_of(next_part(text, 'x')), columns = whole_number_of(text);
    if (network.method.empty() || !rows || !columns || *rows == 0 || *columns == 0)
        return {};
    network.rows = *rows, network.columns = *columns;
    return network;
}

} // namespace

std::vector<peer_time> read_peer_times(const std::filesystem::path& table) {
    const std::vector<std::byte> content = tactnet::read_file(table, largest_table);
    std::string_view rest(reinterpret_cast<const char*>(content.data()), content.size());
    std::size_t number = 1;
    const auto refuse = [&](const std::string& expected, std::string_view found) {
        throw tactnet::file_error(table.string(), fmt::format("line {}", number), expected,
                                  printable("'" + std::string(found.substr(0, 60)) + "'"));
    };
    const std::string_view head = next_part(rest, '\n');
    const std::vector<std::string_view> names = cells_of(head);
    if (names.size() < 2 || names[0] != "network" || names[1] != "batch")
        refuse("the head of a table of benchmark_inference, 'network,batch,…'", head);
    for (const std::string_view name : names)
        if (name.empty() ||
            name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") !=
                std::string_view::npos)
            refuse("columns of letters, digits and _", name); // they are text of a picture later
    std::vector<peer_time> times;
    while (!rest.empty()) {
        ++number;
        const std::string_view line = next_part(rest, '\n');
        const std::vector<std::string_view> cells = cells_of(line);
        if (cells.size() != names.size())
            refuse(fmt::format("{} columns as in the head", names.size()), line);
        const auto network = network_of(cells[0]);
        if (!network)
            refuse("a network and its size, such as tactnet6/28x50", cells[0]);
        if (cells[1] != "1")
            continue; // frames that pass together: a study shows single ones
        for (std::size_t column = 2; column < cells.size(); ++column) {
            std::string_view peer = names[column];
            if (!peer.ends_with("_us") || peer.starts_with("tactnet"))
                continue;
            peer.remove_suffix(3);
            constexpr std::string_view in_8_bits = "_8bit";
            const std::size_t bits = peer.ends_with(in_8_bits) ? 8 : 32;
            if (bits == 8)
                peer.remove_suffix(in_8_bits.size());
            if (cells[column] == "nan")
                continue; // which the benchmark writes where a peer did not run
            const auto microseconds = time_of(cells[column]);
            if (!microseconds)
                refuse("microseconds above 0 of " + std::string(peer), cells[column]);
            times.push_back(
                {std::string(peer), network->method, network->rows, network->columns, *microseconds, bits});
        }
    }
    return times;
}
