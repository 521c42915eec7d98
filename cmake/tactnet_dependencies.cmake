# Finds what the library stands on. Used in the build and, installed, by find_package(tactnet), so that both always
# agree.

macro(tactnet_find_dependency package)
    if(CMAKE_FIND_PACKAGE_NAME STREQUAL "tactnet")
        find_dependency(${package} ${ARGN})
    else()
        find_package(${package} ${ARGN} REQUIRED)
    endif()
endmacro()

# tactnet_find_dependencies(ON|OFF): with or without what vector instructions need.
macro(tactnet_find_dependencies _tactnet_simd)
    tactnet_find_dependency(Eigen3 3.4)
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
