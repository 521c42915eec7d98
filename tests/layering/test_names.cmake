# Checks that tests/ mirrors include/, so that the test of a header is easy to find: under its own name, or, of several
# headers of a folder, under the name of the folder: those of io/images/ in io/images_test.cpp, those of io/ itself in
# io/io_test.cpp. And that each test case says first what it tests.
#
# cmake -DTESTS=<folder of tests> -DHEADERS=<folder that holds tactnet/> -P test_names.cmake
cmake_minimum_required(VERSION 3.22)

file(GLOB_RECURSE tests RELATIVE "${TESTS}" "${TESTS}/*_test.cpp")
# Those in layering/ are wrong on purpose.
list(FILTER tests EXCLUDE REGEX "^layering/")
if(NOT tests)
    message(FATAL_ERROR "There are no tests in ${TESTS}.")
endif()
list(SORT tests)

set(problems "")
foreach(test IN LISTS tests)
    string(REGEX REPLACE "_test\\.cpp$" "" header "${test}")
    # A header whose tests are many has several files, each with its topic after the header's name.
    string(REGEX REPLACE "/.*" "" room "${test}")
    set(mirrors OFF)
    while(NOT mirrors)
        if(EXISTS "${HEADERS}/tactnet/${header}.hpp" OR IS_DIRECTORY "${HEADERS}/tactnet/${header}"
           OR (header STREQUAL "${room}/${room}" AND IS_DIRECTORY "${HEADERS}/tactnet/${room}")
        )
            set(mirrors ON)
        elseif(header MATCHES "_[^_/]*$")
            string(REGEX REPLACE "_[^_/]*$" "" header "${header}")
        else()
            break()
        endif()
    endwhile()
    # The tests of examples/ mirror that folder, and some are listed there.
    if(test MATCHES "^examples/")
        set(of_example ON)
    else()
        set(of_example OFF)
    endif()
    # Hard cases are of many headers: their files are topics.
    if(NOT mirrors AND NOT of_example AND NOT test MATCHES "^hard_cases/")
        string(APPEND problems "  ${test}: tests no header of that name; expected <header>_test.cpp or "
                               "<header>_<topic>_test.cpp, or a folder of headers in place of the header\n"
        )
    endif()

    file(READ "${TESTS}/${test}" text)
    if(text MATCHES "find_data\\(" AND NOT text MATCHES "test_suite\\(\"data\"\\)")
        string(APPEND problems "  ${test}: reads data that do not belong to the project; expected * doctest::test_suite(\"data\")\n")
    endif()

    file(GLOB_RECURSE lists "${TESTS}/${room}/CMakeLists.txt")
    set(built OFF)
    foreach(list IN LISTS lists)
        file(READ "${list}" text)
        get_filename_component(folder "${list}" DIRECTORY)
        file(RELATIVE_PATH file "${folder}" "${TESTS}/${test}")
        string(FIND "${text}" "${file}" found)
        if(found GREATER_EQUAL 0)
            set(built ON)
        endif()
    endforeach()
    if(NOT built AND NOT of_example)
        string(APPEND problems "  ${test}: no CMakeLists.txt of tests/${room}/ lists it\n")
    endif()

    file(READ "${TESTS}/${test}" text)
    string(REGEX REPLACE "[][;]" " " text "${text}")
    string(REGEX MATCHALL "TEST_CASE[A-Z_]*\\([ \n]*\"[^\"]*" cases "${text}")
    foreach(case IN LISTS cases)
        string(REGEX REPLACE "^[^\"]*\"" "" case "${case}")
        if(NOT case MATCHES "^[A-Za-z_][A-Za-z0-9_:]*: ")
            string(APPEND problems "  ${test}: expected a test case 'subject: what holds', found '${case}'\n")
        else()
            string(REGEX REPLACE ":.*" "" subject "${case}")
            string(REPLACE "_" "[ _]" subject "${subject}")
            if(case MATCHES "^[^:]*: ${subject}[a-z ]*: ")
                string(APPEND problems "  ${test}: says its subject twice: '${case}'\n")
            endif()
        endif()
    endforeach()
endforeach()

if(problems)
    message(FATAL_ERROR "What tests are called (see docs/contribute/rooms.md):\n${problems}")
endif()
list(LENGTH tests count)
message("${count} tests, each next to its header")
