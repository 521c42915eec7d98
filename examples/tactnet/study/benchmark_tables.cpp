#include "study/benchmark_tables.hpp"

#include "number_options.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <printable.hpp>
#include <string_view>

namespace {

/// Throws tactnet::file_error with the beginning of what was found.
using refuse_line = std::function<void(const std::string& expected, std::string_view found)>;

struct network_size {
    std::string method;
    std::size_t rows, columns;
};

/// The text before `separator`, which is removed too, or all of it.
std::string_view next_part(std::string_view& text, char separator) {
    const std::size_t length = text.find(separator);
    const std::string_view part = text.substr(0, length);
    text.remove_prefix(length == std::string_view::npos ? text.size() : length + 1);
    return part;
}

std::vector<std::string> cells_of(std::string_view line) {
    std::vector<std::string> cells;
    if (line.ends_with('\r'))
        line.remove_suffix(1);
    while (!line.empty())
        cells.emplace_back(next_part(line, ','));
    return cells;
}

/// "tactnet6/28x50".
std::optional<network_size> network_of(std::string_view text) {
    const std::string method(next_part(text, '/'));
    const auto rows = whole_number_of(next_part(text, 'x')), columns = whole_number_of(text);
    if (method.empty() || !rows || !columns || *rows == 0 || *columns == 0)
        return std::nullopt;
    return network_size{method, *rows, *columns};
}

/// Calls take_head(names, refuse) and, for each line, take(network, cells, refuse). The head of the file, of
/// at most 1 MiB, has to begin with `head`, columns `of` something.
template <class TakeHead, class Take>
void read_table(const std::filesystem::path& file, std::string_view head, std::string_view of,
                const TakeHead& take_head, const Take& take) {
    std::size_t number = 0;
    const refuse_line refuse = [&](const std::string& expected, std::string_view found) {
        throw tactnet::file_error(file.string(), fmt::format("line {}", number), expected,
                                  printable("'" + std::string(found.substr(0, 60)) + "'"));
    };
    const auto content = tactnet::read_file(file, std::size_t{1} << 20U);
    std::string_view rest(reinterpret_cast<const char*>(content.data()), content.size());
    std::vector<std::string> names;
    do {
        const std::string_view text = next_part(rest, '\n');
        const std::vector<std::string> cells = cells_of(text);
        if (++number == 1) {
            const std::vector<std::string> wanted = cells_of(head);
            if (cells.size() < wanted.size() || !std::equal(wanted.begin(), wanted.end(), cells.begin()))
                refuse(fmt::format("the head of a table of {}, '{},…'", of, head), text);
            names = cells;
            take_head(names, refuse);
            continue;
        }
        if (cells.size() != names.size())
            refuse(fmt::format("{} columns as in the head", names.size()), text);
        const auto network = network_of(cells[0]);
        if (!network)
            refuse("a network and its size, such as tactnet6/28x50", cells[0]);
        take(*network, cells, refuse);
    } while (!rest.empty());
}

} // namespace

std::vector<peer_time> read_peer_times(const std::filesystem::path& file) {
    constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
    std::vector<std::string> names;
    std::vector<peer_time> times;
    const auto take_head = [&](const std::vector<std::string>& head, const refuse_line& refuse) {
        names = head;
        for (const std::string& name : names)
            if (name.empty() || name.find_first_not_of(letters) != std::string::npos)
                refuse("columns of letters, digits and _", name); // they are text of a picture later
    };
    const auto take = [&](const network_size& network, const std::vector<std::string>& cells,
                          const refuse_line& refuse) {
        if (cells[1] != "1")
            return; // frames that pass together: a study shows single ones
        const auto processor = std::ranges::find(names, "processor") - names.begin();
        for (std::size_t column = 2; column < cells.size(); ++column) {
            std::string_view peer = names[column];
            if (!peer.ends_with("_us") || peer.starts_with("tactnet") || cells[column] == "nan")
                continue;
            peer.remove_suffix(3);
            const std::size_t bits = peer.ends_with("_8bit") ? 8 : 32;
            if (bits == 8)
                peer.remove_suffix(5);
            const auto time = number_of(cells[column]);
            if (!time || *time <= 0 || *time > 3.6e9) // an hour
                refuse("microseconds above 0 of " + std::string(peer), cells[column]);
            times.push_back(
                {std::string(peer), network.method, network.rows, network.columns, *time, bits,
                 processor < std::ssize(names) ? cells[static_cast<std::size_t>(processor)] : ""});
        }
    };
    read_table(file, "network,batch", "benchmark_inference", take_head, take);
    return times;
}

std::vector<code_size> read_code_bytes(const std::filesystem::path& file) {
    std::vector<code_size> sizes;
    const auto take = [&](const network_size& network, const std::vector<std::string>& cells,
                          const refuse_line& refuse) {
        const auto bits = whole_number_of(cells[1]), bytes = whole_number_of(cells[2]);
        if (!bits || (*bits != 8 && *bits != 32))
            refuse("8 or 32 bits of a weight", cells[1]);
        if (!bytes || *bytes == 0)
            refuse("a number of bytes above 0", cells[2]);
        sizes.push_back({network.method, network.rows, network.columns, *bits, *bytes});
    };
    read_table(
        file, "network,bits,bytes", "the target tactnet_program_code_bytes", [](const auto&, const auto&) {},
        take);
    return sizes;
}
