# A consumer without CMake: what pkg-config says of the installed package is enough to compile, link and run.
#
# cmake -DPKG_CONFIG=... -DCOMPILER=... -DFLAGS=... -DPREFIX=<installed> -DVERSION=... -DFOLDER=<to write in> -P pkg_config.cmake
cmake_minimum_required(VERSION 3.22)

if(NOT PKG_CONFIG)
    message("skipped: no pkg-config on the PATH, and none in TACTNET_PKG_CONFIG")
    return()
endif()
file(GLOB_RECURSE files "${PREFIX}/*.pc")
list(LENGTH files count)
if(NOT count EQUAL 4)
    message(FATAL_ERROR "Expected four files of pkg-config in ${PREFIX}, found '${files}'.")
endif()
list(GET files 0 folder)
get_filename_component(folder "${folder}" DIRECTORY)
set(ENV{PKG_CONFIG_PATH} "${folder}:$ENV{PKG_CONFIG_PATH}")
separate_arguments(flags UNIX_COMMAND "${FLAGS}")

set(programs "${CMAKE_CURRENT_LIST_DIR}/../../packaging/conan/test_package")
foreach(package_and_source IN ITEMS "tactnet-sensors sensors" "tactnet-eigen eigen")
    separate_arguments(parts UNIX_COMMAND "${package_and_source}")
    list(GET parts 0 package)
    list(GET parts 1 source)
    execute_process(
        COMMAND "${PKG_CONFIG}" --print-errors --exists "${package} = ${VERSION}" RESULT_VARIABLE status ERROR_VARIABLE said
    )
    if(said MATCHES "Package '?(xsimd|eigen3)'?[^\n]*not found")
        message("skipped: pkg-config does not know ${CMAKE_MATCH_1} here")
        return()
    elseif(NOT status EQUAL 0)
        message(FATAL_ERROR "pkg-config does not take ${package}: ${said}")
    endif()
    execute_process(
        COMMAND "${PKG_CONFIG}" --cflags --libs ${package} OUTPUT_VARIABLE options OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY
    )
    separate_arguments(options UNIX_COMMAND "${options}")
    set(program "${FOLDER}/with_${package}")
    execute_process(
        COMMAND "${COMPILER}" -std=c++20 ${flags} "${programs}/${source}.cpp" ${options} -o "${program}"
                COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY
    )
    execute_process(COMMAND "${program}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
