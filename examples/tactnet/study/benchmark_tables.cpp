#include "study/benchmark_tables.hpp"

#include "number_options.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <standard_output.hpp>
#include <string_view>
#include <tuple>
#include <utility>

namespace {

std::vector<std::string> parts_of(std::string_view text, char separator) {
    std::vector<std::string> parts;
    std::istringstream stream{std::string(text)};
    for (std::string part; std::getline(stream, part, separator);)
        parts.push_back(std::move(part));
    return parts;
}

/// A table of networks: a head, and lines that begin with a network and its size.
class network_table {
public:
    struct line {
        std::size_t number;
        std::vector<std::string> cells;
        std::string method{};
        std::size_t rows = 0, columns = 0;
    };

    /// Of at most 1 MiB, with a head that begins with `head`, columns `of` something.
    network_table(const std::filesystem::path& file, std::string_view head, std::string_view of)
        : file_(file.string()) {
        const auto content = tactnet::read_file(file, std::size_t{1} << 20U);
        std::vector<std::string> texts =
            parts_of({reinterpret_cast<const char*>(content.data()), content.size()}, '\n');
        texts.resize(std::max<std::size_t>(texts.size(), 1));
        for (std::string& text : texts)
            if (text.ends_with('\r'))
                text.pop_back();
        names = parts_of(texts[0], ',');
        const std::vector<std::string> wanted = parts_of(head, ',');
        if (names.size() < wanted.size() || !std::equal(wanted.begin(), wanted.end(), names.begin()))
            refuse(1, fmt::format("the head of a table of {}, '{},…'", of, head), texts[0]);
        for (std::size_t i = 1; i < texts.size(); ++i) {
            line next{i + 1, parts_of(texts[i], ',')};
            if (next.cells.size() != names.size())
                refuse(i + 1, fmt::format("{} columns as in the head", names.size()), texts[i]);
            const std::string& network = next.cells[0];
            const std::size_t slash = std::min(network.find('/'), network.size());
            const auto size = size_of(std::string_view(network).substr(std::min(slash + 1, network.size())));
            if (!size || slash == 0 || size->first == 0 || size->second == 0)
                refuse(i + 1, "a network and its size, such as tactnet6/28x50", network);
            next.method = network.substr(0, slash);
            std::tie(next.rows, next.columns) = *size;
            lines.push_back(std::move(next));
        }
    }
    /// Throws tactnet::file_error with the beginning of what was found.
    [[noreturn]] void refuse(std::size_t number, const std::string& expected, std::string_view found) const {
        throw tactnet::file_error(file_, fmt::format("line {}", number), expected,
                                  printable("'" + std::string(found.substr(0, 60)) + "'"));
    }

    std::vector<std::string> names;
    std::vector<line> lines;

private:
    std::string file_;
};

} // namespace

std::vector<peer_time> read_peer_times(const std::filesystem::path& file) {
    constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
    const network_table table(file, "network,batch", "benchmark_inference");
    for (const std::string& name : table.names)
        if (name.empty() || name.find_first_not_of(letters) != std::string::npos)
            table.refuse(1, "columns of letters, digits and _", name); // they are text of a picture later
    std::vector<peer_time> times;
    const auto processor =
        static_cast<std::size_t>(std::ranges::find(table.names, "processor") - table.names.begin());
    for (const auto& [number, cells, method, rows, columns] : table.lines)
        for (std::size_t column = 2; column < cells.size(); ++column) {
            std::string_view peer = table.names[column];
            // A study shows single frames, and not those that pass together.
            if (cells[1] != "1" || !peer.ends_with("_us") || peer.starts_with("tactnet") ||
                cells[column] == "nan")
                continue;
            peer.remove_suffix(3);
            const std::size_t bits = peer.ends_with("_8bit") ? 8 : 32;
            if (bits == 8)
                peer.remove_suffix(5);
            const auto time = number_of(cells[column]);
            if (!time || *time <= 0 || *time > 3.6e9) // an hour
                table.refuse(number, "microseconds above 0 of " + std::string(peer), cells[column]);
            times.push_back({std::string(peer), method, rows, columns, *time, bits,
                             processor < cells.size() ? cells[processor] : ""});
        }
    return times;
}

std::vector<code_size> read_code_bytes(const std::filesystem::path& file) {
    const network_table table(file, "network,bits,bytes", "the target tactnet_program_code_bytes");
    std::vector<code_size> sizes;
    for (const auto& [number, cells, method, rows, columns] : table.lines) {
        const auto bits = whole_number_of(cells[1]), bytes = whole_number_of(cells[2]);
        if (!bits || (*bits != 8 && *bits != 32))
            table.refuse(number, "8 or 32 bits of a weight", cells[1]);
        if (!bytes || *bytes == 0)
            table.refuse(number, "a number of bytes above 0", cells[2]);
        sizes.push_back({method, rows, columns, *bits, *bytes});
    }
    return sizes;
}
