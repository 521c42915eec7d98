find_package(doctest REQUIRED)
if(MINGW) # a test of many types has more sections than the usual format of objects can number
    add_compile_options(-Wa,-mbig-obj)
endif()

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
# Python it is skipped and says so. By its path, since CMake starts a target through the emulator where it has one.
find_package(Python3 3.9 QUIET COMPONENTS Interpreter)
function(tactnet_python_test name script)
    if(Python3_Interpreter_FOUND)
        add_test(NAME ${name} COMMAND "${Python3_EXECUTABLE}" "${CMAKE_CURRENT_SOURCE_DIR}/${script}" ${ARGN} COMMAND_EXPAND_LISTS)
    else()
        add_test(NAME ${name} COMMAND "${CMAKE_COMMAND}" -E echo "skipped: needs python3")
    endif()
    set_tests_properties(${name} PROPERTIES LABELS "${tactnet_room}" SKIP_RETURN_CODE 77 SKIP_REGULAR_EXPRESSION "skipped:")
endfunction()

# What tests that call a compiler by themselves give it, as arguments of tactnet_python_test: where headers are, and the definitions.
set(tactnet_includes "-I$<JOIN:$<TARGET_PROPERTY:tactnet::simulation,INTERFACE_INCLUDE_DIRECTORIES>,$<SEMICOLON>-I>")
set(definitions "$<TARGET_PROPERTY:tactnet::tactnet,INTERFACE_COMPILE_DEFINITIONS>")
set(tactnet_flags "${tactnet_includes}" "$<$<BOOL:${definitions}>:-D$<JOIN:${definitions},$<SEMICOLON>-D>>")

# A second compiler, for the tests of what must not compile and of what compilers make of the library.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    find_program(TACTNET_OTHER_COMPILER clang++ DOC "A second compiler for tests")
else()
    find_program(TACTNET_OTHER_COMPILER g++ DOC "A second compiler for tests")
endif()
# Compilers for other targets, and emulators of these.
find_program(TACTNET_AARCH64_COMPILER aarch64-linux-gnu-g++ DOC "For tests of AArch64")
find_program(TACTNET_AARCH64_EMULATOR NAMES qemu-aarch64 qemu-aarch64-static)
find_program(TACTNET_ARMHF_COMPILER arm-linux-gnueabihf-g++ DOC "For tests of 32-bit ARM")
find_program(TACTNET_ARM_EMULATOR NAMES qemu-arm qemu-arm-static)

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

# tactnet_test_part(target level folder [library...]): a program or object library of the sources of a folder.
function(tactnet_test_part target level folder)
    tactnet_test_level(${target} ${level})
    target_include_directories(${target} PRIVATE "${folder}")
    target_link_libraries(${target} PRIVATE ${ARGN})
    if(TARGET tactnet_precompiled_${level})
        target_precompile_headers(${target} REUSE_FROM tactnet_precompiled_${level})
    endif()
endfunction()

# tactnet_room(room): what the tests that follow belong to, as label of CTest and as target `room_<room>`: all of its programs.
macro(tactnet_room room)
    add_custom_target(room_${room})
    set(tactnet_room ${room})
    set(CMAKE_DIRECTORY_LABELS ${room})
endmacro()

# tactnet_test(name [SOURCES file...] [LEVEL optimised|quick|unoptimised] [UNOPTIMISED file... | UNOPTIMISED_BUT file...]
#              [LIBRARIES target...] [PARTS word...] [TIMEOUT seconds] [COST seconds] [FULL])
#
# One program test_<name> and one entry in CTest, or, for one that takes minutes, an entry <name>.<word> for the cases
# in files with each of these words in their names, and <name> for all others, so that they run side by side. A program
# in which no test case is left fails, rather than passing because nothing was wrong.
#
# Without SOURCES these are all *_test.cpp of the room and its folders, except those of programs before it and of folders with a
# CMakeLists.txt of their own. Those that include decode_image.hpp or through_jpeg.hpp, which are the examples' and need JPEG and
# PNG, are left out where these are missing. Those with cases in the suite "data" (`* doctest::test_suite("data")`), which need data
# that do not belong to the project (support/files/data_folder.hpp), make an entry <name>.data, which CTest reports as skipped where
# the data are missing.
#
# A Release build compiles at LEVEL: at -O1 (quick), at the level of users (optimised: the kernels, and what is built of them),
# or at -O0 (unoptimised), where results are compared with references and to the bit, and little is computed: this takes two thirds
# of the time to compile. UNOPTIMISED are files at -O0 whatever the LEVEL, UNOPTIMISED_BUT those that are not, alone. Files at -O0
# stand last, so that of a function that other files have, too, the linker takes the optimised one. With TACTNET_TEST_FULLY_OPTIMISED, as in the preset
# clang, nothing is unoptimised.
#
# FULL leaves the program to the full suite. COST is about what it takes, so that CTest starts the longest first.
function(tactnet_test name)
    cmake_parse_arguments(PARSE_ARGV 1 test "FULL" "LEVEL;TIMEOUT;COST" "SOURCES;UNOPTIMISED;UNOPTIMISED_BUT;LIBRARIES;PARTS")
    if(test_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR "tactnet_test(${name}): there is no '${test_UNPARSED_ARGUMENTS}'.")
    endif()
    set(room "${tactnet_room}")
    set(folder "${CMAKE_CURRENT_SOURCE_DIR}")
    if(folder STREQUAL "${PROJECT_SOURCE_DIR}/tests")
        string(APPEND folder "/${room}")
    endif()
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE path)
    set(sources ${test_SOURCES})
    if(NOT sources)
        file(GLOB_RECURSE sources CONFIGURE_DEPENDS RELATIVE "${folder}" "${folder}/*_test.cpp")
        file(GLOB_RECURSE own RELATIVE "${folder}" "${folder}/*/CMakeLists.txt")
        list(TRANSFORM own REPLACE "CMakeLists.txt$" ".*" )
        foreach(pattern IN LISTS own)
            list(FILTER sources EXCLUDE REGEX "^${pattern}")
        endforeach()
        get_property(taken GLOBAL PROPERTY tactnet_sources_of_${room})
        list(REMOVE_ITEM sources ${taken} "")
    endif()
    set_property(GLOBAL APPEND PROPERTY tactnet_sources_of_${room} ${sources})
    set(has_data FALSE)
    foreach(source IN LISTS sources)
        cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY "${folder}" OUTPUT_VARIABLE file)
        if(NOT EXISTS "${file}")
            continue() # it is made by the build
        endif()
        file(STRINGS "${file}" lines REGEX "^#include .*(decode_image|through_jpeg)[.]hpp|test_suite\\(\"data\"\\)")
        if(lines MATCHES "#include" AND NOT TARGET tactnet_image_files)
            message(STATUS "tactnet: ${path}/${source} is left out (needs TACTNET_BUILD_EXAMPLES, JPEG and PNG)")
            list(REMOVE_ITEM sources "${source}")
            continue()
        elseif(lines MATCHES "#include")
            list(APPEND test_LIBRARIES tactnet_image_files)
        endif()
        if(lines MATCHES "test_suite")
            set(has_data TRUE)
        endif()
    endforeach()
    if(NOT test_LEVEL)
        set(test_LEVEL quick)
    endif()
    foreach(file IN LISTS test_UNOPTIMISED test_UNOPTIMISED_BUT)
        if(NOT file IN_LIST sources)
            message(FATAL_ERROR "tactnet_test(${name}): there is no ${path}/${file}.")
        endif()
    endforeach()
    # The program of the files at the higher level, and a library of those at the lower.
    set(level ${test_LEVEL})
    set(unoptimised ${test_UNOPTIMISED})
    if(test_UNOPTIMISED_BUT)
        set(unoptimised ${sources})
        list(REMOVE_ITEM unoptimised ${test_UNOPTIMISED_BUT})
    endif()
    if(TACTNET_TEST_FULLY_OPTIMISED)
        set(unoptimised "")
        string(REPLACE unoptimised quick level "${level}")
    endif()
    list(REMOVE_ITEM sources ${unoptimised} "")
    list(TRANSFORM sources REPLACE "^([^/].*)" "${folder}/\\1")
    list(TRANSFORM unoptimised REPLACE "^([^/].*)" "${folder}/\\1")

    set(program test_${name})
    add_executable(${program} ${sources})
    tactnet_test_part(${program} ${level} "${folder}" ${test_LIBRARIES})
    set_target_properties(${program} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/${path}")
    if(unoptimised)
        add_library(${program}_unoptimised OBJECT ${unoptimised})
        tactnet_test_part(${program}_unoptimised unoptimised "${folder}" ${test_LIBRARIES})
        # Not as sources, which would come first in the linker's order.
        target_link_libraries(${program} PRIVATE $<TARGET_OBJECTS:${program}_unoptimised>)
    endif()

    if(NOT test_TIMEOUT)
        set(test_TIMEOUT 600)
    endif()
    if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
        math(EXPR test_TIMEOUT "4 * ${test_TIMEOUT}")
    endif()
    if(NOT test_COST)
        set(test_COST 20)
    endif()
    set(entries ${name})
    set(not_data "")
    if(has_data)
        add_test(NAME ${name}.data COMMAND ${program} --test-suite=data)
        set_tests_properties(${name}.data PROPERTIES SKIP_RETURN_CODE 77)
        list(APPEND entries ${name}.data)
        set(not_data --test-suite-exclude=data)
    endif()
    # Not where the checkout lies, which may have such a word in its path.
    set(others "")
    foreach(word IN LISTS test_PARTS)
        add_test(NAME ${name}.${word} COMMAND ${program} "--source-file=*/${path}/*${word}*" ${not_data})
        list(APPEND entries ${name}.${word})
        list(APPEND others "*/${path}/*${word}*")
    endforeach()
    set(all_but "")
    if(others)
        list(JOIN others "," others)
        set(all_but "--source-file-exclude=${others}")
    endif()
    add_test(NAME ${name} COMMAND ${program} ${all_but} ${not_data})
    set_tests_properties(${entries} PROPERTIES LABELS "${room}" TIMEOUT ${test_TIMEOUT} COST ${test_COST} FAIL_REGULAR_EXPRESSION
        "test cases: +0 ")
    add_dependencies(room_${room} ${program})
    if(NOT test_FULL)
        tactnet_library_tests(TESTS ${entries} TARGETS ${program})
    endif()
endfunction()

# tactnet_find_python(variable modules): sets a variable to a Python that can import these modules ("numpy, torch"), or to nothing.
function(tactnet_find_python variable modules)
    find_package(Python3 QUIET COMPONENTS Interpreter)
    set(found "")
    foreach(python IN ITEMS "${Python3_EXECUTABLE}" /usr/bin/python3)
        if(python AND NOT found)
            execute_process(COMMAND "${python}" -c "import ${modules}" RESULT_VARIABLE missing OUTPUT_QUIET ERROR_QUIET)
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
