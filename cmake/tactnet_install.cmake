include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(tactnet_package_folder "${CMAKE_INSTALL_DATADIR}/cmake/tactnet")

# tactnet_export(target set): each component has a file of its own, so that one can be found without what another needs.
function(tactnet_export target set)
    target_include_directories(${target} INTERFACE "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
    install(TARGETS ${target} EXPORT ${set})
    install(EXPORT ${set} NAMESPACE tactnet:: DESTINATION "${tactnet_package_folder}")
endfunction()
if(TARGET tactnet)
    tactnet_export(tactnet tactnetTargets)
    tactnet_export(tactnet_simulation tactnetSimulationTargets)
    tactnet_export(tactnet_eigen tactnetEigenTargets)
endif()
tactnet_export(tactnet_sensors tactnetSensorsTargets)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.hpp")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/tactnetConfig.cmake.in" "${PROJECT_BINARY_DIR}/tactnetConfig.cmake"
    INSTALL_DESTINATION "${tactnet_package_folder}" NO_SET_AND_CHECK_MACRO)
configure_file("${PROJECT_SOURCE_DIR}/cmake/tactnetConfigVersion.cmake.in" "${PROJECT_BINARY_DIR}/tactnetConfigVersion.cmake" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/tactnetConfig.cmake" "${PROJECT_BINARY_DIR}/tactnetConfigVersion.cmake"
    "${PROJECT_SOURCE_DIR}/cmake/tactnet_dependencies.cmake" DESTINATION "${tactnet_package_folder}")

# For builds without CMake: pkg-config --cflags --libs tactnet, or tactnet-simulation, tactnet-eigen, tactnet-sensors. The
# folder may be moved as a whole, so paths start from where the file itself lies.
set(pkg_config_folder "${CMAKE_INSTALL_DATADIR}/pkgconfig")
file(RELATIVE_PATH pkg_config_prefix "/prefix/${pkg_config_folder}" "/prefix")
string(REGEX REPLACE "/$" "" pkg_config_prefix "${pkg_config_prefix}")
function(tactnet_install_pkg_config name description requires cflags libs)
    set(text [[
prefix=${pcfiledir}/@pkg_config_prefix@
includedir=${prefix}/@CMAKE_INSTALL_INCLUDEDIR@

Name: @name@
Description: @description@
Version: @PROJECT_VERSION@
Requires: @requires@
Cflags: -I${includedir}@cflags@
Libs: @libs@
]])
    file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/${name}.pc" CONTENT "${text}" @ONLY)
    install(FILES "${PROJECT_BINARY_DIR}/${name}.pc" DESTINATION "${pkg_config_folder}")
endfunction()
if(TACTNET_SIMD)
    set(pkg_config_vectors "xsimd >= 8.1")
    set(pkg_config_flags "")
else()
    set(pkg_config_vectors "")
    set(pkg_config_flags " -DTACTNET_NO_SIMD")
endif()
tactnet_install_pkg_config(tactnet-sensors "Decodes recordings and streams of tactile sensors" "" "${pkg_config_flags}" "")
if(TARGET tactnet)
    tactnet_install_pkg_config(tactnet "${PROJECT_DESCRIPTION}" "${pkg_config_vectors}" "${pkg_config_flags}" "-pthread")
    foreach(component IN ITEMS simulation eigen)
        tactnet_install_pkg_config(tactnet-${component} "tactnet and what its component ${component} needs"
            "tactnet = ${PROJECT_VERSION}, eigen3 >= 3.4" "" "")
    endforeach()
endif()
