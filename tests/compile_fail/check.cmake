# One case: code that must not compile, a source file or, where several stand in one, its part between #ifdef CASE_name
# and #endif. The first lines say what the compiler must print:
#
#   // expect: a regular expression, in CMake's dialect (no \d, no {n}), found somewhere in the output
#   // expect: another; all must be found
#   // at-most: 2          errors, so that the sentence is not buried under others; without this line, one
#   // characters: 20000   of output at most, for the same reason (optional)
#
# cmake -DCOMPILER=... -DSOURCE=... -DCASE=... -DINCLUDES=a|b -DDEFINITIONS=a|b -DOPTIONS=a|b -DPRECOMPILED=<header> -P check.cmake
cmake_minimum_required(VERSION 3.22)

set(arguments -std=c++20)
foreach(kind IN ITEMS INCLUDES DEFINITIONS OPTIONS)
    string(REPLACE "|" ";" ${kind} "${${kind}}")
endforeach()
list(APPEND arguments ${OPTIONS})
foreach(folder IN LISTS INCLUDES)
    if(folder)
        list(APPEND arguments "-I${folder}")
    endif()
endforeach()
foreach(definition IN LISTS DEFINITIONS)
    if(definition)
        list(APPEND arguments "-D${definition}")
    endif()
endforeach()

# Without a source: only precompiles what all cases read.
if(SOURCE STREQUAL "")
    execute_process(
        COMMAND "${COMPILER}" ${arguments} -x c++-header "${PRECOMPILED}" -o "${PRECOMPILED}.gch" COMMAND_ERROR_IS_FATAL ANY
    )
    return()
endif()

# The leading spaces keep CMake from breaking the lines.
function(fail text)
    message(FATAL_ERROR "  ${SOURCE} ${CASE}: ${text}")
endfunction()

file(READ "${SOURCE}" rest)
if(CASE)
    list(APPEND arguments -DCASE_${CASE})
    set(line "#ifdef CASE_${CASE}\n")
    string(FIND "${rest}" "${line}" begin)
    if(begin EQUAL -1)
        fail("has no such case.")
    endif()
    string(LENGTH "${line}" length)
    math(EXPR begin "${begin} + ${length}")
    string(SUBSTRING "${rest}" ${begin} -1 rest)
endif()
set(patterns 0)
set(at_most 1)
set(characters "")
while(rest MATCHES "^// *(expect|at-most|characters): *([^\n]*)\n")
    set(key "${CMAKE_MATCH_1}")
    set(value "${CMAKE_MATCH_2}")
    string(LENGTH "${CMAKE_MATCH_0}" length)
    string(SUBSTRING "${rest}" ${length} -1 rest)
    if(key STREQUAL "expect")
        math(EXPR patterns "${patterns} + 1")
        set(pattern_${patterns} "${value}")
    elseif(key STREQUAL "at-most")
        set(at_most "${value}")
    else()
        set(characters "${value}")
    endif()
endwhile()
if(patterns EQUAL 0)
    fail("says nothing of what is expected: the first line must be '// expect: ...'.")
endif()

set(ENV{LC_ALL} C) # quotation marks and words as they are written in the cases
execute_process(
    COMMAND "${COMPILER}" ${arguments} -include "${PRECOMPILED}" -fsyntax-only "${SOURCE}"
    RESULT_VARIABLE status
    OUTPUT_VARIABLE output
    ERROR_VARIABLE output
)

if(status EQUAL 0)
    fail("it compiles, but must not.")
endif()
# A missing header stops the compiler before it has seen anything of the case.
if(NOT status EQUAL 1 OR output MATCHES "fatal error:")
    fail("the compiler could not do its work (${status}):\n${output}")
endif()
foreach(index RANGE 1 ${patterns})
    if(NOT output MATCHES "${pattern_${index}}")
        fail("expected the compiler to say\n  ${pattern_${index}}\nfound\n${output}")
    endif()
endforeach()
string(REGEX MATCHALL " error: " errors "${output}")
list(LENGTH errors count)
if(count GREATER at_most)
    fail("expected at most ${at_most} error, found ${count}:\n${output}")
endif()
if(NOT characters STREQUAL "")
    string(LENGTH "${output}" count)
    if(count GREATER characters)
        fail("expected at most ${characters} characters, found ${count}:\n${output}")
    endif()
endif()
message("${output}")
