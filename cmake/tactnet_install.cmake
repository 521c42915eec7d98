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

configure_package_config_file(
    "${PROJECT_SOURCE_DIR}/cmake/tactnetConfig.cmake.in"
    "${PROJECT_BINARY_DIR}/tactnetConfig.cmake"
    INSTALL_DESTINATION "${tactnet_package_folder}"
    NO_SET_AND_CHECK_MACRO
)
# Before 1.0 a new minor version may change the interface.
write_basic_package_version_file(
    "${PROJECT_BINARY_DIR}/tactnetConfigVersion.cmake" COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT
)
install(
    FILES
        "${PROJECT_BINARY_DIR}/tactnetConfig.cmake"
        "${PROJECT_BINARY_DIR}/tactnetConfigVersion.cmake"
        "${PROJECT_SOURCE_DIR}/cmake/tactnet_dependencies.cmake"
    DESTINATION "${tactnet_package_folder}"
)
