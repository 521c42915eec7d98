#include <tactnet/sensors/warning.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <support/allocations.hpp>

using tactnet::decoding_warning;
using tactnet::decoding_warnings;
using tactnet::warning_text;

TEST_CASE("warning_text: texts and numbers, cut off where they are too long") {
    CHECK(warning_text().view().empty());
    CHECK(warning_text("cell ", 12U, " at ", 0.25, " s").view() == "cell 12 at 0.25 s");
    CHECK(warning_text(UINT64_MAX, -3).view() == "18446744073709551615-3");
    const std::string long_text(warning_text::capacity - 1, 'x');
    CHECK(warning_text(std::string_view(long_text), "yz", 1).view() == long_text + "y");
}

TEST_CASE("decoding_warnings: the first are kept, all are counted, and no heap is used") {
    decoding_warnings warnings;
    CHECK(warnings.count() == 0);
    CHECK(warnings.kept().empty());
    const std::size_t before = support::bytes_allocated();
    for (std::size_t i = 0; i < 1000; ++i)
        warnings.add({i, 0, 2, warning_text("a count of at least ", 3U), warning_text(i)});
    CHECK(support::bytes_allocated() == before);
    CHECK(warnings.count() == 1000);
    REQUIRE(warnings.kept().size() == decoding_warnings::capacity);
    CHECK(warnings.kept()[15] ==
          decoding_warning{15, 0, 2, warning_text("a count of at least 3"), warning_text("15")});
    CHECK(warnings.kept()[15].place() == "byte 15, frame 2");
    CHECK(decoding_warning{7, 3, 0, {}, {}}.place() == "byte 7, line 3");
    CHECK(warnings.kept()[15].message() == "byte 15, frame 2: expected a count of at least 3, found 15");
    CHECK(warnings.kept()[15].message("a.fsx") ==
          "a.fsx: byte 15, frame 2: expected a count of at least 3, found 15");
}
