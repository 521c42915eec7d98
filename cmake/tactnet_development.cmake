# How the project's own programs are built: warnings, this machine's instruction set. None of it reaches a user of
# tactnet::tactnet.

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Release, Debug, RelWithDebInfo or MinSizeRel" FORCE)
endif()

add_library(tactnet_warnings INTERFACE)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(tactnet_warnings INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
    if(TACTNET_WARNINGS_AS_ERRORS)
        target_compile_options(tactnet_warnings INTERFACE -Werror)
    endif()
    # GCC 12 warns of overlapping copies inside std::string where there are none (its bug 105329).
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
        target_compile_options(tactnet_warnings INTERFACE -Wno-restrict)
        # Of copies beyond the end of one, too (its bug 105651). True findings of that kind are worth seeing, so these stay
        # warnings; the sanitizers and Clang judge.
        target_compile_options(tactnet_warnings INTERFACE -Wno-error=array-bounds -Wno-error=stringop-overflow
                                                          -Wno-error=stringop-overread)
        # And of its own AVX-512 intrinsics, which start from an undefined register on purpose (its bug 105593).
        target_compile_options(tactnet_warnings INTERFACE -Wno-uninitialized -Wno-maybe-uninitialized)
    endif()
endif()

add_library(tactnet_native INTERFACE)
if(TACTNET_NATIVE)
    include(CheckCXXCompilerFlag)
    check_cxx_compiler_flag(-march=native TACTNET_HAS_MARCH_NATIVE)
    if(TACTNET_HAS_MARCH_NATIVE)
        target_compile_options(tactnet_native INTERFACE -march=native)
    endif()
endif()

# GCC collects garbage only when its heap is larger than 1 GB: a twelfth less compile time, and more memory
# (scripts/prepare counts on 1.5 GB per compiler).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options($<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=1048576>)
endif()

# In a Release build most of the compiler's time would go into optimising what runs once, or only talks: tests, and the
# commands of programs, are compiled at -O1. Other configurations say themselves how they are built.
add_library(tactnet_quick_to_compile INTERFACE)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(tactnet_quick_to_compile INTERFACE $<$<CONFIG:Release>:-O1>)
endif()

# tactnet_use(target): what every one of the project's own programs links.
function(tactnet_use target)
    target_link_libraries(${target} PRIVATE tactnet::tactnet tactnet_warnings tactnet_native)
    set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
endfunction()

# tactnet_name_instruction_set(variable): the short name of the instruction set that the programs are compiled for (detail/config.hpp).
function(tactnet_name_instruction_set variable)
    set(source "${PROJECT_BINARY_DIR}/CMakeFiles/name_of_instruction_set.cpp")
    file(WRITE "${source}" "#include <tactnet/detail/config.hpp>\nname: TACTNET_ARCH\n")
    separate_arguments(options NATIVE_COMMAND "${CMAKE_CXX_FLAGS}")
    if(TACTNET_HAS_MARCH_NATIVE)
        list(APPEND options -march=native)
    endif()
    if(NOT TACTNET_SIMD)
        list(APPEND options -DTACTNET_NO_SIMD)
    endif()
    execute_process(
        COMMAND "${CMAKE_CXX_COMPILER}" -std=c++20 ${options} "-I${PROJECT_SOURCE_DIR}/include" -E -P "${source}"
        OUTPUT_VARIABLE output ERROR_QUIET
    )
    set(name "that the compiler does not report")
    if(output MATCHES "name: for_([a-zA-Z0-9_]+)")
        set(name "${CMAKE_MATCH_1}")
    endif()
    set(${variable} "${name}" PARENT_SCOPE)
endfunction()
