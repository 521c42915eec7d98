find_package(doctest REQUIRED)

# The tests of the library: what `scripts/test` builds and runs (`ctest -L library`), in about ten minutes on two cores.
# Everything else belongs to `scripts/test full`.
add_custom_target(library_tests)

# tactnet_library_tests(TESTS name... [TARGETS target...]): adds tests of CTest, and the targets that they need.
function(tactnet_library_tests)
    cmake_parse_arguments(PARSE_ARGV 0 library "" "" "TESTS;TARGETS")
    set_property(TEST ${library_TESTS} APPEND PROPERTY LABELS library)
    if(library_TARGETS)
        add_dependencies(library_tests ${library_TARGETS})
    endif()
endfunction()

# tactnet_python_test(name script argument...): a test by a script of this folder, which reports 77 to be skipped. Without
# Python it is skipped and says so.
find_package(Python3 3.7 QUIET COMPONENTS Interpreter)
function(tactnet_python_test name script)
    if(Python3_Interpreter_FOUND)
        add_test(NAME ${name} COMMAND Python3::Interpreter "${CMAKE_CURRENT_SOURCE_DIR}/${script}" ${ARGN})
        set_tests_properties(${name} PROPERTIES SKIP_RETURN_CODE 77)
    else()
        add_test(NAME ${name} COMMAND "${CMAKE_COMMAND}" -E echo "skipped: needs python3")
        set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "skipped:")
    endif()
endfunction()

# tactnet_test_level(target optimised|quick|unoptimised): compiles a part of a test at its own level, at -O1, or at -O0.
function(tactnet_test_level target level)
    tactnet_use(${target})
    target_link_libraries(${target} PRIVATE tactnet_test_main)
    if(level STREQUAL "quick")
        target_link_libraries(${target} PRIVATE tactnet_quick_to_compile)
    elseif(level STREQUAL "unoptimised" AND CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
        target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O0>)
    endif()
endfunction()

# tactnet_test_part(target level [library...]): a program or object library of the sources of this folder.
function(tactnet_test_part target level)
    tactnet_test_level(${target} ${level})
    target_include_directories(${target} PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}")
    target_link_libraries(${target} PRIVATE ${ARGN})
    if(TARGET tactnet_precompiled_${level})
        target_precompile_headers(${target} REUSE_FROM tactnet_precompiled_${level})
    endif()
endfunction()

# tactnet_test(room SOURCES file... [UNOPTIMISED_SOURCES file...] [LIBRARIES target...] [PARTS word...]
#              [TIMEOUT seconds] [COST seconds] [FULLY_OPTIMISED | UNOPTIMISED] [DATA] [FULL])
#
# One program test_<room> and one entry in CTest, or, for one that takes minutes, an entry <room>.<word> for the cases
# in files with each of these words in their names, and <room> for all others, so that they run side by side. A program
# in which no test case is left fails, rather than passing because nothing was wrong.
#
# A Release build compiles a room at -O1, or
# - at its own level with FULLY_OPTIMISED: the kernels, and what is built of them as users build it;
# - at -O0 with UNOPTIMISED: where results are compared with references and to the bit, and little is computed. This takes
#   two thirds of the time to compile.
# UNOPTIMISED_SOURCES are files of an optimised room that are compiled at -O0 all the same: those that compare many
# sizes with a reference, where most of the time of compiling would go, and those about other things than numbers. They
# stand last, so that of a function that other files have, too, the linker takes the fully optimised one.
# With TACTNET_TEST_FULLY_OPTIMISED, as in the presets clang and all-sizes, both are like other rooms and files.
#
# DATA is for rooms with cases in the suite "data" (`* doctest::test_suite("data")`): they need data that do not belong to
# the project (support/files/data_folder.hpp), and are an entry <room>.data of their own, which CTest reports as skipped
# where the data are missing. FULL leaves the room to the full suite. COST is about what the test takes,
# so that CTest starts the longest first.
function(tactnet_test room)
    cmake_parse_arguments(
        PARSE_ARGV 1 test "FULLY_OPTIMISED;UNOPTIMISED;DATA;FULL" "TIMEOUT;COST"
        "SOURCES;UNOPTIMISED_SOURCES;LIBRARIES;PARTS"
    )
    if(test_UNPARSED_ARGUMENTS OR NOT test_SOURCES)
        message(FATAL_ERROR "tactnet_test(${room}): expected SOURCES file..., found '${ARGN}'.")
    endif()
    if(NOT test_TIMEOUT)
        set(test_TIMEOUT 600)
        if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
            set(test_TIMEOUT 2400)
        endif()
    endif()
    if(NOT test_COST)
        set(test_COST 20)
    endif()
    set(level quick)
    if(test_FULLY_OPTIMISED)
        set(level optimised)
    elseif(test_UNOPTIMISED AND NOT TACTNET_TEST_FULLY_OPTIMISED)
        set(level unoptimised)
    endif()
    add_executable(test_${room} ${test_SOURCES})
    tactnet_test_part(test_${room} ${level} ${test_LIBRARIES})
    if(test_UNOPTIMISED_SOURCES AND TACTNET_TEST_FULLY_OPTIMISED)
        target_sources(test_${room} PRIVATE ${test_UNOPTIMISED_SOURCES})
    elseif(test_UNOPTIMISED_SOURCES)
        add_library(test_${room}_unoptimised OBJECT ${test_UNOPTIMISED_SOURCES})
        tactnet_test_part(test_${room}_unoptimised unoptimised ${test_LIBRARIES})
        # Not as sources, which would come first in the linker's order.
        target_link_libraries(test_${room} PRIVATE $<TARGET_OBJECTS:test_${room}_unoptimised>)
    endif()
    set(entries ${room})
    set(others "")
    set(not_data "")
    if(test_DATA)
        add_test(NAME ${room}.data COMMAND test_${room} --test-suite=data)
        set_tests_properties(${room}.data PROPERTIES SKIP_RETURN_CODE 77)
        list(APPEND entries ${room}.data)
        set(not_data --test-suite-exclude=data)
    endif()
    # Not where the checkout lies, which may have such a word in its path.
    cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE folder)
    foreach(word IN LISTS test_PARTS)
        add_test(NAME ${room}.${word} COMMAND test_${room} "--source-file=*/${folder}/*${word}*" ${not_data})
        list(APPEND entries ${room}.${word})
        list(APPEND others "*/${folder}/*${word}*")
    endforeach()
    list(JOIN others "," others)
    set(all_but "")
    if(others)
        set(all_but "--source-file-exclude=${others}")
    endif()
    add_test(NAME ${room} COMMAND test_${room} ${all_but} ${not_data})
    set_tests_properties(
        ${entries} PROPERTIES TIMEOUT ${test_TIMEOUT} COST ${test_COST} FAIL_REGULAR_EXPRESSION "test cases: +0 "
    )
    if(NOT test_FULL)
        tactnet_library_tests(TESTS ${entries} TARGETS test_${room})
    endif()
endfunction()

# Sets a variable to a Python with numpy and PyTorch, or to nothing.
function(tactnet_find_torch_python variable)
    find_package(Python3 QUIET COMPONENTS Interpreter)
    set(found "")
    foreach(python IN ITEMS "${Python3_EXECUTABLE}" /usr/bin/python3)
        if(python AND NOT found)
            execute_process(
                COMMAND "${python}" -c "import numpy, torch" RESULT_VARIABLE missing OUTPUT_QUIET ERROR_QUIET
            )
            if(missing EQUAL 0)
                set(found "${python}")
            endif()
        endif()
    endforeach()
    set(${variable} "${found}" PARENT_SCOPE)
endfunction()

# Writes the files that a text contains, each after a line `==> path`, into the folder of its name in the build tree.
function(tactnet_unfold name)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${name}.txt")
    set(folder "${CMAKE_CURRENT_BINARY_DIR}/${name}")
    file(REMOVE_RECURSE "${folder}")
    file(READ "${CMAKE_CURRENT_SOURCE_DIR}/${name}.txt" rest)
    string(APPEND rest "==> ")
    while(rest MATCHES "^==> ([^\n]+)\n")
        set(path "${CMAKE_MATCH_1}")
        string(LENGTH "${CMAKE_MATCH_0}" begin)
        string(SUBSTRING "${rest}" ${begin} -1 rest)
        string(FIND "${rest}" "\n==> " end)
        string(SUBSTRING "${rest}" 0 ${end} text)
        file(WRITE "${folder}/${path}" "${text}\n")
        math(EXPR end "${end} + 1")
        string(SUBSTRING "${rest}" ${end} -1 rest)
    endwhile()
    set(${name} "${folder}" PARENT_SCOPE)
endfunction()
