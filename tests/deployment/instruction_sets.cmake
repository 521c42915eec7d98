# A smaller test (reduced.cpp) for other instruction sets than the build's own: each in a program of its own, three
# linked into one, and 64-bit and 32-bit ARM under an emulator.

# tactnet_reduced_unit(name FUNCTION function OPTIONS option...): an object library.
function(tactnet_reduced_unit name)
    cmake_parse_arguments(PARSE_ARGV 1 unit "" "FUNCTION" "OPTIONS")
    add_library(${name} OBJECT reduced.cpp)
    # Not tactnet_use: the instruction set is this unit's own.
    target_link_libraries(${name} PRIVATE tactnet::tactnet tactnet_warnings)
    target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests")
    target_compile_definitions(${name} PRIVATE TACTNET_TEST_UNIT=${unit_FUNCTION})
    target_compile_options(${name} PRIVATE ${unit_OPTIONS})
    set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
endfunction()

# The reference knows no instruction set: one object for all programs.
add_library(tactnet_deployment_bound OBJECT EXCLUDE_FROM_ALL ../support/layers/deployment_bound.cpp)
target_link_libraries(tactnet_deployment_bound PRIVATE tactnet::tactnet tactnet_warnings)
target_include_directories(tactnet_deployment_bound PRIVATE "${PROJECT_SOURCE_DIR}/tests")
set_target_properties(tactnet_deployment_bound PROPERTIES CXX_EXTENSIONS OFF)

# tactnet_reduced_program(name UNITS unit... FUNCTIONS function...)
function(tactnet_reduced_program name)
    cmake_parse_arguments(PARSE_ARGV 1 program "" "" "UNITS;FUNCTIONS")
    add_executable(${name} reduced_main.cpp $<TARGET_OBJECTS:tactnet_deployment_bound>)
    foreach(unit IN LISTS program_UNITS)
        target_sources(${name} PRIVATE $<TARGET_OBJECTS:${unit}>)
    endforeach()
    list(JOIN program_FUNCTIONS "," functions)
    target_link_libraries(${name} PRIVATE tactnet::tactnet tactnet_warnings)
    target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests")
    target_compile_definitions(${name} PRIVATE "TACTNET_TEST_UNITS=${functions}")
    set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
endfunction()

if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND TACTNET_SIMD)
    # Name, function, options, and what a processor must have.
    set(sets "sse41|reduced_first|-march=x86-64 -msse4.1|sse4.1" "avx2|reduced_second|-march=x86-64-v3|avx2"
        "no_simd|reduced_third|-DTACTNET_NO_SIMD|sse2"
    )
    if(TACTNET_HAS_MARCH_NATIVE)
        list(APPEND sets "native|reduced_first|-march=native|sse2")
    endif()
    include(CheckCXXSourceRuns)
    set(units "")
    set(functions "")
    set(alone "")
    foreach(set IN LISTS sets)
        string(REPLACE "|" ";" set "${set}")
        list(GET set 0 name)
        list(GET set 1 function)
        list(GET set 2 options)
        list(GET set 3 needs)
        separate_arguments(options)
        check_cxx_source_runs(
            "int main() { return __builtin_cpu_supports(\"${needs}\") ? 0 : 1; }" TACTNET_CPU_HAS_${name}
        )
        if(NOT TACTNET_CPU_HAS_${name})
            message(STATUS "tactnet: the test of deployed networks with ${name} is left out (needs ${needs})")
            continue()
        endif()
        tactnet_reduced_unit(deployed_${name} FUNCTION ${function} OPTIONS ${options})
        tactnet_reduced_program(test_deployed_${name} UNITS deployed_${name} FUNCTIONS ${function})
        add_test(NAME deployment.${name} COMMAND test_deployed_${name})
        # Native may be any of the others: it is in no program with them.
        if(NOT name STREQUAL native)
            list(APPEND units deployed_${name})
            list(APPEND functions ${function})
            list(APPEND alone "$<TARGET_FILE:test_deployed_${name}>")
        endif()
    endforeach()
    # Sizes of caches change how work is cut, and no result: here the bands of tiles.
    if(TACTNET_CPU_HAS_avx2)
        tactnet_reduced_unit(
            deployed_small_caches FUNCTION reduced_second OPTIONS -march=x86-64-v3 -DTACTNET_L1_CACHE_KIB=4
            -DTACTNET_L2_CACHE_KIB=512
        )
        tactnet_reduced_program(test_deployed_small_caches UNITS deployed_small_caches FUNCTIONS reduced_second)
        add_test(
            NAME deployment.small_caches
            COMMAND
                "${CMAKE_COMMAND}" "-DFIRST=$<TARGET_FILE:test_deployed_avx2>"
                "-DSECOND=$<TARGET_FILE:test_deployed_small_caches>" -P "${CMAKE_CURRENT_SOURCE_DIR}/same_outputs.cmake"
        )
    endif()
    list(LENGTH units count)
    if(count GREATER 1)
        tactnet_reduced_program(test_deployed_together UNITS ${units} FUNCTIONS ${functions})
        add_test(
            NAME deployment.together
            COMMAND
                "${CMAKE_COMMAND}" "-DTOGETHER=$<TARGET_FILE:test_deployed_together>" "-DALONE=${alone}" -P
                "${CMAKE_CURRENT_SOURCE_DIR}/compare_units.cmake"
        )
    endif()
endif()

# AArch64, which has another width of vectors, by a compiler that is not this build's.
find_program(TACTNET_AARCH64_COMPILER aarch64-linux-gnu-g++)
find_program(TACTNET_AARCH64_EMULATOR NAMES qemu-aarch64 qemu-aarch64-static)
set(TACTNET_AARCH64_ROOT /usr/aarch64-linux-gnu CACHE PATH "Libraries of AArch64 programs, for the emulator")
find_path(tactnet_xsimd_folder xsimd/xsimd.hpp)
if(TACTNET_AARCH64_COMPILER AND TACTNET_AARCH64_EMULATOR AND tactnet_xsimd_folder AND TACTNET_SIMD)
    # Only xsimd's own headers: those beside it belong to this machine's processor.
    file(MAKE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/aarch64/include")
    file(CREATE_LINK "${tactnet_xsimd_folder}/xsimd" "${CMAKE_CURRENT_BINARY_DIR}/aarch64/include/xsimd" SYMBOLIC)
    file(GLOB_RECURSE headers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/include/*.hpp")
    set(sources
        "${CMAKE_CURRENT_SOURCE_DIR}/reduced.cpp" "${CMAKE_CURRENT_SOURCE_DIR}/reduced_main.cpp"
        "${PROJECT_SOURCE_DIR}/tests/support/layers/deployment_bound.cpp"
    )
    # Without products of bytes, which a processor of the first version has not, and with them.
    foreach(set IN ITEMS "aarch64|-march=armv8-a" "aarch64_dotprod|-march=armv8.2-a+dotprod")
        string(REPLACE "|" ";" set "${set}")
        list(GET set 0 name)
        list(GET set 1 options)
        set(program "${CMAKE_CURRENT_BINARY_DIR}/aarch64/test_deployed_${name}")
        add_custom_command(
            OUTPUT "${program}"
            COMMAND
                "${TACTNET_AARCH64_COMPILER}" -std=c++20 -O2 ${options} -Wall -Wextra -isystem
                "${CMAKE_CURRENT_BINARY_DIR}/aarch64/include" "-I${PROJECT_SOURCE_DIR}/include"
                "-I${PROJECT_SOURCE_DIR}/tests" -DTACTNET_TEST_UNIT=reduced_first -DTACTNET_TEST_UNITS=reduced_first
                ${sources} -pthread -o "${program}"
            DEPENDS
                ${sources} ${headers} deployed_network.hpp eight_bit/reference.hpp reduced.hpp
                "${PROJECT_SOURCE_DIR}/tests/support/layers/deployment_bound.hpp"
            VERBATIM
        )
        add_custom_target(test_deployed_${name} ALL DEPENDS "${program}")
        add_test(
            NAME deployment.${name} COMMAND "${TACTNET_AARCH64_EMULATOR}" -cpu max -L "${TACTNET_AARCH64_ROOT}" "${program}"
        )
    endforeach()
else()
    message(STATUS "tactnet: the test of deployed networks on AArch64 is left out (needs aarch64-linux-gnu-g++, "
                   "qemu-aarch64 and xsimd)"
    )
endif()

# 32-bit ARM has no vectors for the library, and pairs of words that are multiplied at once.
find_program(TACTNET_ARMHF_COMPILER arm-linux-gnueabihf-g++)
find_program(TACTNET_ARM_EMULATOR NAMES qemu-arm qemu-arm-static)
set(TACTNET_ARMHF_ROOT /usr/arm-linux-gnueabihf CACHE PATH "Libraries of 32-bit ARM programs, for the emulator")
if(TACTNET_ARMHF_COMPILER AND TACTNET_ARM_EMULATOR)
    file(GLOB_RECURSE headers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/include/*.hpp")
    set(program "${CMAKE_CURRENT_BINARY_DIR}/deployed_armhf")
    set(sources
        "${CMAKE_CURRENT_SOURCE_DIR}/reduced.cpp" "${CMAKE_CURRENT_SOURCE_DIR}/reduced_main.cpp"
        "${PROJECT_SOURCE_DIR}/tests/support/layers/deployment_bound.cpp"
    )
    add_custom_command(
        OUTPUT "${program}"
        COMMAND
            "${TACTNET_ARMHF_COMPILER}" -std=c++20 -O2 -march=armv7-a+fp -Wall -Wextra
            "-I${PROJECT_SOURCE_DIR}/include" "-I${PROJECT_SOURCE_DIR}/tests" -DTACTNET_TEST_UNIT=reduced_first
            -DTACTNET_TEST_UNITS=reduced_first ${sources} -pthread -o "${program}"
        DEPENDS
            ${sources} ${headers} deployed_network.hpp eight_bit/reference.hpp reduced.hpp
            "${PROJECT_SOURCE_DIR}/tests/support/layers/deployment_bound.hpp"
        VERBATIM
    )
    add_custom_target(test_deployed_armhf ALL DEPENDS "${program}")
    add_test(NAME deployment.armhf COMMAND "${TACTNET_ARM_EMULATOR}" -L "${TACTNET_ARMHF_ROOT}" "${program}")
else()
    message(STATUS "tactnet: the test of deployed networks on 32-bit ARM is left out (needs arm-linux-gnueabihf-g++ "
                   "and qemu-arm)"
    )
endif()
