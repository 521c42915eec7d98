#include "number_options.hpp"

#include <tactnet/text/message.hpp>

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <system_error>

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

/// A check that the text is a number, by `read`, and acceptable.
template <class Read, class Accepts>
CLI::Validator check(std::string expected, std::string description, Read read, Accepts accepts) {
    return {[expected = std::move(expected), read, accepts](const std::string& text) {
                const auto value = read(text);
                return value && accepts(*value)
                           ? std::string()
                           : fmt::format("expected {}, found {}", expected, tactnet::in_quotes(text));
            },
            std::move(description)};
}

} // namespace

std::optional<std::uint64_t> whole_number_of(std::string_view text) {
    if (text.starts_with('+'))
        text.remove_prefix(1);
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
                 fmt::format("{} to {}", least, most), whole_number_of,
                 [=](std::uint64_t value) { return value >= least && value <= most; });
}

CLI::Validator positive_number() {
    return check("a number above 0", "above 0", number_of, [](double value) { return value > 0; });
}

CLI::Validator number_up_to(double most) {
    return check(fmt::format("a number from 0 to {}", most), fmt::format("0 to {}", most), number_of,
                 [=](double value) { return value >= 0 && value <= most; });
}

CLI::Validator share() {
    return check("a share from 0 to below 1", "0 to below 1", number_of, is_share);
}
