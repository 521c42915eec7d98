# An overlay port: it packages the checkout that it lies in.
#     vcpkg install tactnet --overlay-ports=packaging/vcpkg
# packaging/vcpkg/write_registry_port.py makes of it the port of a release, for a registry.
set(SOURCE_PATH "${CURRENT_PORT_DIR}/../../..")

# Headers only: one build, and no program whose paths to libraries would have to be mended.
set(VCPKG_BUILD_TYPE release)
set(VCPKG_FIXUP_ELF_RPATH OFF)

vcpkg_check_features(
    OUT_FEATURE_OPTIONS feature_options
    FEATURES simd TACTNET_SIMD
    INVERTED_FEATURES networks TACTNET_SENSORS_ONLY
)
vcpkg_cmake_configure(
    SOURCE_PATH "${SOURCE_PATH}"
    OPTIONS ${feature_options}
            -DTACTNET_INSTALL=ON
            -DTACTNET_BUILD_TESTS=OFF
            -DTACTNET_BUILD_EXAMPLES=OFF
            -DTACTNET_BUILD_BENCHMARKS=OFF
)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH share/cmake/tactnet)
if(NOT "eigen" IN_LIST FEATURES)
    # What nobody has asked for is not asked for either.
    file(REMOVE "${CURRENT_PACKAGES_DIR}/share/pkgconfig/tactnet-eigen.pc"
                "${CURRENT_PACKAGES_DIR}/share/pkgconfig/tactnet-simulation.pc"
    )
endif()
set(VCPKG_POLICY_SKIP_PKGCONFIG_CHECK enabled) # they lie in share/ though one has Libs: but that is -pthread alone
vcpkg_fixup_pkgconfig()

file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/lib" "${CURRENT_PACKAGES_DIR}/share/doc")
file(INSTALL "${CURRENT_PORT_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
