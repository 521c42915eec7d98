#include "record.hpp"

#include <tactnet/detail/instruction_set.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <processor.hpp>
#include <string>
#include <utility>

namespace hard_cases {

namespace {

std::string text_of(double value) {
    if (std::isnan(value))
        return "NaN";
    if (std::isinf(value))
        return value > 0 ? "∞" : "−∞";
    char text[32];
    std::snprintf(text, sizeof(text), "%.3g", value);
    return text;
}

std::string json_text(std::string_view text) {
    std::string all = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            all += '\\';
        all += c;
    }
    return all + '"';
}

std::string compiler() {
#if defined(__clang__)
    return "Clang " + std::to_string(__clang_major__) + '.' + std::to_string(__clang_minor__);
#else
    return "GCC " + std::to_string(__GNUC__) + '.' + std::to_string(__GNUC_MINOR__);
#endif
}

void write(std::initializer_list<std::pair<std::string_view, std::string>> fields) {
    static const char* const path = std::getenv("TACTNET_HARD_CASES");
    if (path == nullptr)
        return;
    static std::ofstream file(path);
    std::string line = "{";
    for (const auto& [name, text] : fields)
        line += (line.size() > 1 ? ", " : "") + json_text(name) + ": " + json_text(text);
    file << line << "}\n" << std::flush;
    REQUIRE_MESSAGE(file.good(), "cannot write to ", path);
}

void write_case(std::string_view topic, std::string_view name, const std::string& exact, double plain,
                const std::string& ours, const std::string& plain_error, const std::string& bound,
                const std::string& error) {
    static const bool begun = [] {
        write({{"instruction_set", std::string(tactnet::instruction_set)},
               {"compiler", compiler()},
               {"processor", processor_name()}});
        return true;
    }();
    static_cast<void>(begun);
    write({{"topic", std::string(topic)},
           {"case", std::string(name)},
           {"exact", exact},
           {"plain", text_of(plain)},
           {"ours", ours},
           {"plain_error", plain_error},
           {"bound", bound},
           {"error", error}});
}

double unit_in_last_place(double exact) {
    const int exponent = exact == 0 ? -126 : std::max(std::ilogb(exact), -126);
    return std::ldexp(1.0, exponent - 23);
}

double error_of(double found, double exact, unit what) {
    if (found == exact)
        return 0;
    const double distance = std::abs(found - exact);
    switch (what) {
    case unit::absolute:
        return distance;
    case unit::relative:
        return distance / std::abs(exact);
    case unit::ulp:
        return distance / unit_in_last_place(exact);
    }
    return distance;
}

/// NaN is worse than all.
bool worse(double a, double b) {
    return std::isnan(a) ? !std::isnan(b) : a > b;
}

} // namespace

void hold(std::string_view topic, std::string_view name, unit what, std::span<const outcome> outcomes) {
    REQUIRE_FALSE(outcomes.empty());
    const outcome* shown = nullptr;    // where the naive implementation is worst
    const outcome* tightest = nullptr; // whose error takes the largest part of its bound
    double plain_error = -1, error = 0, part = -1;
    for (const outcome& o : outcomes) {
        const double of_plain = error_of(o.plain, o.exact, what), own = error_of(o.ours, o.exact, what);
        const double own_part = own == 0 ? 0 : own / o.bound;
        if (shown == nullptr || worse(of_plain, plain_error))
            shown = &o, plain_error = of_plain;
        if (tightest == nullptr || worse(own_part, part))
            tightest = &o, error = own, part = own_part;
    }
    INFO(std::string(topic), ", ", std::string(name), ": exact ", tightest->exact, ", found ",
         tightest->ours);
    CHECK(error <= tightest->bound);
    const char* const word = what == unit::ulp ? " ulp" : what == unit::relative ? " rel" : "";
    write_case(topic, name, text_of(shown->exact), shown->plain, text_of(shown->ours),
               text_of(plain_error) + word, text_of(tightest->bound) + word, text_of(error) + word);
}
void hold(std::string_view topic, std::string_view name, unit what, const outcome& one) {
    hold(topic, name, what, std::span(&one, 1));
}

void reported(std::string_view topic, std::string_view name, double plain, bool is_reported,
              std::string_view how) {
    INFO(std::string(topic), ", ", std::string(name), ": expected the report ", std::string(how));
    CHECK(is_reported);
    write_case(topic, name, "none", plain, std::string(how), "silent", "reported",
               is_reported ? "reported" : "silent");
}

void limit(std::string_view topic, std::string_view name, double plain, double ours,
           std::string_view reason) {
    write_case(topic, name, std::string(reason), plain, text_of(ours), "", "limit", text_of(ours));
}

} // namespace hard_cases
