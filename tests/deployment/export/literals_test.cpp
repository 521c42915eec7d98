#include <tactnet/deployment/export/literals.hpp>

#include <doctest/doctest.h>

#include <string>

using namespace tactnet;

TEST_CASE("string_literal: printable ASCII stays, what means something is escaped, all else is octal") {
    using detail::string_literal;
    CHECK(string_literal("") == "\"\"");
    CHECK(string_literal(" a~") == "\" a~\"");
    CHECK(string_literal("a\"b\\c") == "\"a\\\"b\\\\c\"");
    CHECK(string_literal("?\?=") == "\"\\?\\?=\"");
    CHECK(string_literal(std::string("\x1f\x7f\0", 3)) == "\"\\037\\177\\000\"");
    CHECK(string_literal("\xc3\xa9") == "\"\\303\\251\""); // é in UTF-8
}

TEST_CASE("one_line: no character is left that ends a comment or continues it in the next line") {
    CHECK(detail::one_line("a\nb\rc\td\\") == "a b c d ");
    CHECK(detail::one_line(" ~\xc3\xa9") == " ~\xc3\xa9");
}
