# Finds what the library stands on. Used in the build and, installed, by find_package(tactnet), so that both always
# agree. Targets that the user's project has made itself are taken as they are.
#
# Each macro says what is missing in its variable, which is empty when nothing is.

# What the core needs, with or without vector instructions (ON or OFF).
macro(tactnet_find_dependencies _tactnet_missing _tactnet_simd)
    set(${_tactnet_missing} "")
    if(NOT TARGET Threads::Threads)
        find_package(Threads QUIET)
    endif()
    if(NOT TARGET Threads::Threads)
        set(${_tactnet_missing} "threads, and CMake's package Threads was not found")
    elseif(${_tactnet_simd})
        tactnet_find_xsimd(${_tactnet_missing})
    endif()
endmacro()

# The target is then in `_tactnet_xsimd`.
macro(tactnet_find_xsimd _tactnet_missing)
    set(${_tactnet_missing} "")
    # Its version file accepts only the major version asked for, and any from 8.1 will do. Where a target is there
    # already its version is not known here: the headers check it.
    if(NOT TARGET xsimd AND NOT TARGET xsimd::xsimd)
        find_package(xsimd QUIET)
    endif()
    if(TARGET xsimd)
        set(_tactnet_xsimd xsimd)
    else()
        set(_tactnet_xsimd xsimd::xsimd)
    endif()
    if(NOT TARGET ${_tactnet_xsimd})
        set(${_tactnet_missing} "xsimd 8.1 or newer, and no package xsimd was found")
    elseif(xsimd_VERSION AND xsimd_VERSION VERSION_LESS 8.1)
        set(${_tactnet_missing} "xsimd 8.1 or newer, found ${xsimd_VERSION} in ${xsimd_DIR}")
    endif()
endmacro()

# tactnet_link_xsimd(target): gives it the headers of `_tactnet_xsimd`. It is not exported with the target: a project that
# finds the installed package gets that of its own machine.
macro(tactnet_link_xsimd _tactnet_target)
    # Debian's xsimd links xtl, which its headers need only for that library's complex numbers, and which the package
    # neither brings nor asks for: linking it ends in "cannot find -lxtl". Only the headers are wanted then.
    get_target_property(_tactnet_xsimd_links ${_tactnet_xsimd} INTERFACE_LINK_LIBRARIES)
    if("xtl" IN_LIST _tactnet_xsimd_links AND NOT TARGET xtl)
        get_target_property(_tactnet_xsimd_include ${_tactnet_xsimd} INTERFACE_INCLUDE_DIRECTORIES)
        target_include_directories(${_tactnet_target} SYSTEM INTERFACE "$<BUILD_INTERFACE:${_tactnet_xsimd_include}>")
    else()
        target_link_libraries(${_tactnet_target} INTERFACE "$<BUILD_INTERFACE:${_tactnet_xsimd}>")
    endif()
endmacro()

# Eigen, which simulation and eigen need and the core does not.
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
