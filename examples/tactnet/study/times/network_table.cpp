#include "study/times/network_table.hpp"

#include "number_options.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <printable.hpp>
#include <utility>

namespace {

constexpr std::size_t largest_table = std::size_t{1} << 20U; // bytes

/// The text in front of `separator`, which is taken off, or all of it.
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

/// "tactnet6/28x50"; false for other text.
bool read_network(std::string_view text, network_line& line) {
    line.method = next_part(text, '/');
    const auto rows = whole_number_of(next_part(text, 'x')), columns = whole_number_of(text);
    if (line.method.empty() || !rows || !columns || *rows == 0 || *columns == 0)
        return false;
    line.rows = *rows, line.columns = *columns;
    return true;
}

} // namespace

network_table::network_table(std::filesystem::path file, std::string_view head, std::string_view of)
    : file_(std::move(file)) {
    const std::vector<std::byte> content = tactnet::read_file(file_, largest_table);
    std::string_view rest(reinterpret_cast<const char*>(content.data()), content.size());
    const std::string_view first = next_part(rest, '\n');
    names_ = cells_of(first);
    const std::vector<std::string> wanted = cells_of(head);
    if (names_.size() < wanted.size() || !std::equal(wanted.begin(), wanted.end(), names_.begin()))
        refuse(1, fmt::format("the head of a table of {}, '{},…'", of, head), first);
    for (std::size_t number = 2; !rest.empty(); ++number) {
        const std::string_view text = next_part(rest, '\n');
        network_line line{{}, 0, 0, cells_of(text), number};
        if (line.cells.size() != names_.size())
            refuse(number, fmt::format("{} columns as in the head", names_.size()), text);
        if (!read_network(line.cells[0], line))
            refuse(number, "a network and its size, such as tactnet6/28x50", line.cells[0]);
        lines_.push_back(std::move(line));
    }
}

void network_table::refuse(std::size_t line, const std::string& expected, std::string_view found) const {
    throw tactnet::file_error(file_.string(), fmt::format("line {}", line), expected,
                              printable("'" + std::string(found.substr(0, 60)) + "'"));
}
