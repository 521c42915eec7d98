#include "number_options.hpp"

#include <tactnet/text/quoting.hpp>

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

namespace {

/// All of the text or nothing.
template <class Number, class Form>
std::optional<Number> all_of(std::string_view text, Form form) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, form);
    if (error != std::errc() || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

template <class Accepts>
CLI::Validator check(std::string expected, std::string description, Accepts accepts) {
    return CLI::Validator(
        [expected = std::move(expected), accepts](const std::string& text) {
            return accepts(text) ? std::string()
                                 : fmt::format("expected {}, found {}", expected, tactnet::in_quotes(text));
        },
        std::move(description));
}

template <class Accepts>
CLI::Validator number_check(std::string expected, std::string description, Accepts accepts) {
    return check(std::move(expected), std::move(description), [accepts](const std::string& text) {
        const auto value = number_of(text);
        return value && accepts(*value);
    });
}

} // namespace

std::optional<std::uint64_t> whole_number_of(std::string_view text) {
    if (text.starts_with('+'))
        text.remove_prefix(1);
    if (text.starts_with("0x") || text.starts_with("0X"))
        return all_of<std::uint64_t>(text.substr(2), 16);
    if (text.size() > 1 && text.starts_with('0'))
        return std::nullopt;
    return all_of<std::uint64_t>(text, 10);
}

std::optional<double> number_of(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-"))
        text.remove_prefix(1);
    const auto value = all_of<double>(text, std::chars_format::general);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

CLI::Validator whole_number(std::uint64_t least, std::uint64_t most) {
    return check(fmt::format("a whole number from {} to {}", least, most),
                 fmt::format("INT in [{} - {}]", least, most), [least, most](const std::string& text) {
                     const auto value = whole_number_of(text);
                     return value && *value >= least && *value <= most;
                 });
}

CLI::Validator seed() {
    return whole_number(0, std::numeric_limits<std::uint64_t>::max());
}

CLI::Validator positive_number() {
    return number_check("a number above 0", "POSITIVE", [](double value) { return value > 0; });
}

CLI::Validator share() {
    return number_check("a share from 0 to below 1", "FLOAT in [0 - 1)", is_share);
}
