#include "reports/report.hpp"

#include "usage_error.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <system_error>
#include <unistd.h>

void check_writable(const std::filesystem::path& path) {
    std::error_code code;
    if (path.filename().empty() || std::filesystem::is_directory(path, code))
        throw usage_error(
            fmt::format("{}: expected the name of a file to write, found a folder", path.string()));
    auto folder = std::filesystem::absolute(path).parent_path();
    while (!std::filesystem::exists(folder, code) && folder.has_parent_path() &&
           folder != folder.parent_path())
        folder = folder.parent_path();
    if (!std::filesystem::is_directory(folder, code))
        throw usage_error(fmt::format("{}: expected a folder to write in, found a file at {}", path.string(),
                                      folder.string()));
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        throw usage_error(fmt::format("{}: expected a folder to write in, found no permission for {}",
                                      path.string(), folder.string()));
}

void make_folder_of(const std::filesystem::path& path) {
    std::error_code code;
    if (path.has_parent_path())
        std::filesystem::create_directories(path.parent_path(), code);
    if (code)
        throw usage_error(fmt::format("{}: expected to make the folder, found '{}'",
                                      path.parent_path().string(), code.message()));
}

std::string csv_field(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos)
        return std::string(text);
    std::string quoted = "\"";
    for (const char c : text)
        quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

std::string csv_of(std::span<const nlohmann::ordered_json> rows) {
    std::string text;
    for (const nlohmann::ordered_json& row : rows) {
        std::string head, line;
        bool first = true;
        for (const auto& [key, value] : row.items()) {
            // A NaN is null in JSON lines, which know none.
            const bool known =
                !value.is_null() && (!value.is_number_float() || std::isfinite(value.get<double>()));
            head += (first ? "" : ",") + key;
            line += (first ? "" : ",") + (!known              ? ""
                                          : value.is_string() ? csv_field(value.get<std::string>())
                                                              : value.dump());
            first = false;
        }
        text += (text.empty() ? head + '\n' : "") + line + '\n';
    }
    return text;
}

std::string grouped(std::size_t number) {
    std::string text = fmt::to_string(number);
    for (std::size_t place = text.size(); place > 3; place -= 3)
        text.insert(place - 3, " ");
    return text;
}

std::string table(const std::vector<std::vector<std::string>>& rows) {
    const auto width_of = [](std::string_view text) { // characters, of UTF-8
        return static_cast<std::size_t>(
            std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
    };
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i)
            widths[i] = std::max(widths[i], width_of(row[i]));
    }
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string space(widths[i] - width_of(row[i]), ' ');
            line += (i > 0 ? "  " : "") + (i == 0 ? row[i] + space : space + row[i]);
        }
        text += line + '\n';
        if (&row == &rows.front()) {
            for (std::size_t i = 0; i < widths.size(); ++i)
                text += (i > 0 ? "  " : "") + std::string(widths[i], '-');
            text += '\n';
        }
    }
    return text;
}

namespace {

/// Nothing for what is not a number: an epoch without validation.
std::string number_or_nothing(double value) {
    return std::isfinite(value) ? fmt::to_string(value) : "";
}
nlohmann::json number_or_null(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

} // namespace

std::string learning_curve_csv(std::span<const tactnet::epoch_report> history) {
    std::string text = "epoch,rate,loss,validation_loss,validation_accuracy\n";
    for (const auto& e : history)
        text += fmt::format("{},{},{},{},{}\n", e.epoch, e.rate, number_or_nothing(e.loss),
                            number_or_nothing(e.validation_loss), number_or_nothing(e.validation_accuracy));
    return text;
}

std::string learning_curve_json_lines(std::span<const tactnet::epoch_report> history) {
    std::string text;
    for (const auto& e : history)
        text += nlohmann::ordered_json{{"epoch", e.epoch},
                                       {"rate", e.rate},
                                       {"loss", number_or_null(e.loss)},
                                       {"validation_loss", number_or_null(e.validation_loss)},
                                       {"validation_accuracy", number_or_null(e.validation_accuracy)}}
                    .dump() +
                '\n';
    return text;
}

std::string confusion_csv(const tactnet::confusion_matrix& confusion,
                          const std::vector<std::string>& classes) {
    std::string text = "true class";
    for (const std::string& name : classes)
        text += ',' + csv_field(name);
    for (std::size_t truth = 0; truth < classes.size(); ++truth) {
        text += '\n' + csv_field(classes[truth]);
        for (std::size_t recognised = 0; recognised < classes.size(); ++recognised)
            text += ',' + fmt::to_string(confusion(truth, recognised));
    }
    return text + '\n';
}
