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

# tactnet_test(room SOURCES file... [QUICK file...] [LIBRARIES target...] [PARTS word...] [TIMEOUT seconds] [COST seconds] [FULLY_OPTIMISED]
#              [DATA] [FULL])
#
# One program test_<room> and one entry in CTest, or, for one that takes minutes, an entry <room>.<word> for the cases
# in files with each of these words in their names, and <room> for all others, so that they run side by side. A program
# in which no test case is left fails, rather than passing because nothing was wrong.
#
# FULLY_OPTIMISED is for rooms whose subject is the optimised code itself: the kernels, and what is built of them as
# users build it; there, QUICK are files at -O1
# (unless TACTNET_TEST_EVERY_SIZE is set, as the preset all-sizes does): those that compare many lists of layers with a reference, where most of
# the time of compiling would go. They stand last, so that of a function that other files have, too, the linker takes
# the fully optimised one. DATA is for rooms with cases in the suite "data" (`* doctest::test_suite("data")`): they need data that
# do not belong to the project (support/files/data_folder.hpp), and are an entry <room>.data of their own, which CTest
# reports as skipped where the data are missing. FULL leaves the room to the full suite. COST is about what the test takes, so that CTest starts the
# longest first.
function(tactnet_test room)
    cmake_parse_arguments(PARSE_ARGV 1 test "FULLY_OPTIMISED;DATA;FULL" "TIMEOUT;COST" "SOURCES;QUICK;LIBRARIES;PARTS")
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
    add_executable(test_${room} ${test_SOURCES} ${test_QUICK})
    if(test_QUICK AND NOT TACTNET_TEST_EVERY_SIZE)
        set_source_files_properties(
            ${test_QUICK} PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O1> SKIP_PRECOMPILE_HEADERS ON
        )
    endif()
    tactnet_use(test_${room})
    if(test_FULLY_OPTIMISED)
        set(kind optimised)
    else()
        set(kind quick)
        target_link_libraries(test_${room} PRIVATE tactnet_quick_to_compile)
    endif()
    target_include_directories(test_${room} PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}")
    target_link_libraries(test_${room} PRIVATE tactnet_test_main ${test_LIBRARIES})
    if(TARGET tactnet_precompiled_${kind})
        target_precompile_headers(test_${room} REUSE_FROM tactnet_precompiled_${kind})
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
