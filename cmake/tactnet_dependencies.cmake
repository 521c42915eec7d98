# Finds what the library stands on. Used in the build and, installed, by find_package(tactnet), so that both always
# agree.

macro(tactnet_find_dependency package)
    if(CMAKE_FIND_PACKAGE_NAME STREQUAL "tactnet")
        find_dependency(${package} ${ARGN})
    else()
        find_package(${package} ${ARGN} REQUIRED)
    endif()
endmacro()

# tactnet_find_dependencies(ON|OFF): what the core needs, with or without vector instructions.
macro(tactnet_find_dependencies _tactnet_simd)
    tactnet_find_dependency(Threads)
    if(${_tactnet_simd})
        # Its version file accepts only the major version asked for, and any from 8.1 will do.
        tactnet_find_dependency(xsimd)
        if(xsimd_VERSION AND xsimd_VERSION VERSION_LESS 8.1)
            message(FATAL_ERROR "tactnet needs xsimd 8.1 or newer, found ${xsimd_VERSION} in ${xsimd_DIR}.")
        endif()
        # xsimd's own target may link xtl, which its headers need only for that library's complex numbers, and which
        # Debian's package neither brings nor asks for. Only the headers are wanted here.
        if(NOT TARGET tactnet::xsimd)
            get_target_property(_tactnet_xsimd_include xsimd INTERFACE_INCLUDE_DIRECTORIES)
            add_library(tactnet::xsimd INTERFACE IMPORTED)
            set_target_properties(
                tactnet::xsimd PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${_tactnet_xsimd_include}"
            )
        endif()
    endif()
endmacro()

# tactnet_find_eigen(variable): looks for Eigen, which simulation and eigen need and the core does not. The variable then
# says what is missing; it is empty when nothing is.
macro(tactnet_find_eigen _tactnet_missing)
    set(${_tactnet_missing} "")
    # No version is asked for: Eigen's version files accept the major version asked for only, and both 3.4 and 5 will do.
    if(NOT TARGET Eigen3::Eigen)
        find_package(Eigen3 QUIET)
    endif()
    if(NOT TARGET Eigen3::Eigen)
        set(${_tactnet_missing} "Eigen 3.4 or newer, and no package Eigen3 was found")
    elseif(Eigen3_VERSION AND Eigen3_VERSION VERSION_LESS 3.4)
        set(${_tactnet_missing} "Eigen 3.4 or newer, found ${Eigen3_VERSION} in ${Eigen3_DIR}")
    endif()
endmacro()
