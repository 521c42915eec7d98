# An overlay port: it packages the checkout that it lies in.
#     vcpkg install tactnet --overlay-ports=packaging/vcpkg
set(SOURCE_PATH "${CURRENT_PORT_DIR}/../../..")

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

# Headers only: nothing differs between debug and release.
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug" "${CURRENT_PACKAGES_DIR}/lib" "${CURRENT_PACKAGES_DIR}/share/doc")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
