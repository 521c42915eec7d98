# A header of which the tests cover one half: each result of mutate.py is known.
#
# cmake -DPYTHON=<program> -DSCRIPT=<tests/mutation/mutate.py> -DCOMPILER=<compiler> -DFOLDER=<to work in> -P check.cmake
cmake_minimum_required(VERSION 3.22)

file(REMOVE_RECURSE "${FOLDER}")
file(WRITE "${FOLDER}/include/tactnet/room/sums.hpp" [[#pragma once
constexpr int sum(int a, int b) { return a + b; }
inline int product(int a, int b) { return a * b; }
inline bool positive(int a) {
    return a > 0;
}
template <class T>
T unused(T a) { return a - a; }
inline void fill(int* to) {
    to[0] = 7;
}
]])
file(WRITE "${FOLDER}/tests/support/precompiled.hpp" "#include <doctest/doctest.h>\n")
file(WRITE "${FOLDER}/tests/support/main.cpp" "#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN\n#include <doctest/doctest.h>\n")
file(WRITE "${FOLDER}/tests/room/sums_test.cpp" [[#include <tactnet/room/sums.hpp>
#include <doctest/doctest.h>
static_assert(sum(1, 1) == 2);
TEST_CASE("sums: products and signs") {
    CHECK(product(2, 3) == 6);
    CHECK(positive(1));
    int place = 0;
    fill(&place);
    CHECK(place >= 7);
}
]])

# expect_in_run(OPTIONS option... LINES regular expression...)
set(command "${PYTHON}" "${SCRIPT}" --tree "${FOLDER}" --compiler "${COMPILER}" --flags=-O0 --count 100 --each 100)
function(expect_in_run)
    cmake_parse_arguments(PARSE_ARGV 0 run "" "" "OPTIONS;LINES")
    execute_process(
        COMMAND ${command} ${run_OPTIONS} OUTPUT_VARIABLE output ERROR_VARIABLE errors RESULT_VARIABLE result
    )
    if(NOT result EQUAL 0)
        message(FATAL_ERROR "tests/mutation/mutate.py ${run_OPTIONS} failed: ${errors}")
    endif()
    foreach(expected IN LISTS run_LINES)
        if(NOT output MATCHES "${expected}")
            message(FATAL_ERROR "Expected '${expected}' in:\n${output}")
        endif()
    endforeach()
endfunction()

expect_in_run(
    LINES "sums.hpp:2 '\\+' to '-': killed by room/sums_test.cpp: static_assert"
          "sums.hpp:3 '\\*' to '/': killed by room/sums_test.cpp: sums: products and signs"
          "sums.hpp:5 '>' to '>=': survived"
          "sums.hpp:8 '-' to '\\+': same code"
          "sums.hpp:10 '7' to '8': survived"
          "sums.hpp:10 'to.0. = 7' to '': killed by"
)

# A second run resumes: nothing is left to do.
execute_process(COMMAND ${command} OUTPUT_VARIABLE again)
if(again MATCHES "min left" OR NOT again MATCHES "\\| all \\|")
    message(FATAL_ERROR "Expected the table alone, found:\n${again}")
endif()

# All at once: the same is noticed where a switch can show it, and what runs only while compiling is left to the other way.
file(REMOVE "${FOLDER}/output/mutants.jsonl")
expect_in_run(
    OPTIONS --together
    LINES "sums.hpp:2: no switch shows it"
          "sums.hpp:3 '\\*' to '/': killed by room/sums_test.cpp: sums: products and signs"
          "sums.hpp:5 '>' to '>=': survived"
          "sums.hpp:8: no switch shows it"
          "sums.hpp:10 '7' to '8': survived"
          "sums.hpp:10 'to.0. = 7' to '': killed by room/sums_test.cpp: sums: products and signs"
)
