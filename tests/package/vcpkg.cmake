# vcpkg installs the port, and a consumer takes it from there, compiles, deploys a tiny network and runs.
#
# MODE classic: `vcpkg install tactnet`; manifest: the consumer's vcpkg.json asks for it; registry: sensors alone, from the
# port that write_registry_port.cmake makes, with an archive of the release that lies among the downloads already.
#
# cmake -DVCPKG=... -DTOOLCHAIN=<vcpkg.cmake> -DCOMPILER=... -DGENERATOR=... -DSOURCE=<checkout> -DVERSION=... -DMODE=... \
#       -DFOLDER=<to write in> -P vcpkg.cmake
cmake_minimum_required(VERSION 3.22)

if(NOT VCPKG)
    message("skipped: no vcpkg on the PATH, and none in TACTNET_VCPKG")
    return()
elseif(NOT EXISTS "${TOOLCHAIN}")
    message("skipped: no vcpkg.cmake in VCPKG_ROOT, and none in TACTNET_VCPKG_TOOLCHAIN")
    return()
endif()

file(REMOVE_RECURSE "${FOLDER}")
file(COPY "${SOURCE}/packaging/conan/test_package/" DESTINATION "${FOLDER}/consumer" PATTERN "*.py" EXCLUDE)
# What was built before is not taken: the port packages the checkout, of which vcpkg sees no changes.
set(options --binarysource=clear "--x-install-root=${FOLDER}/installed" "--x-buildtrees-root=${FOLDER}/buildtrees"
            "--x-packages-root=${FOLDER}/packages"
)
set(ports "${SOURCE}/packaging/vcpkg")
set(what tactnet)
set(components "core|eigen|sensors")
set(programs deploy eigen sensors)
if(MODE STREQUAL "manifest")
    file(WRITE "${FOLDER}/consumer/vcpkg.json" "{\"dependencies\": [\"tactnet\"]}\n")
    set(what "--x-manifest-root=${FOLDER}/consumer")
    set(components core)
    set(programs deploy)
elseif(MODE STREQUAL "registry")
    set(release "${FOLDER}/tactnet-${VERSION}")
    foreach(part IN ITEMS CMakeLists.txt LICENSE cmake include)
        file(COPY "${SOURCE}/${part}" DESTINATION "${release}")
    endforeach()
    # The name by which vcpkg_from_github looks for what it would download.
    set(archive "${FOLDER}/downloads/owner-tactnet-v${VERSION}.tar.gz")
    file(MAKE_DIRECTORY "${FOLDER}/downloads")
    execute_process(
        COMMAND "${CMAKE_COMMAND}" -E tar czf "${archive}" "tactnet-${VERSION}" WORKING_DIRECTORY "${FOLDER}"
                COMMAND_ERROR_IS_FATAL ANY
    )
    file(REMOVE_RECURSE "${release}")
    set(ports "${FOLDER}/ports")
    execute_process(
        COMMAND "${CMAKE_COMMAND}" "-DARCHIVE=${archive}" -DREPOSITORY=owner/tactnet "-DOUTPUT=${ports}/tactnet" -P
                "${SOURCE}/packaging/vcpkg/write_registry_port.cmake" COMMAND_ERROR_IS_FATAL ANY
    )
    list(APPEND options "--downloads-root=${FOLDER}/downloads")
    set(what "tactnet[core]")
    set(components sensors)
    set(programs sensors)
endif()

# Away from a vcpkg.json that may lie above the working folder.
if(NOT MODE STREQUAL "manifest")
    list(APPEND options --classic)
endif()
execute_process(
    COMMAND "${VCPKG}" install "${what}" "--overlay-ports=${ports}" ${options}
    WORKING_DIRECTORY "${FOLDER}"
    RESULT_VARIABLE status
    OUTPUT_VARIABLE output
    ERROR_VARIABLE output
)
if(NOT status EQUAL 0)
    message(FATAL_ERROR "vcpkg install ${what} ended with ${status}:\n${output}")
endif()
if(output MATCHES "post-build check problem")
    message(FATAL_ERROR "vcpkg finds fault with the port:\n${output}")
endif()
if(NOT output MATCHES "target_link_libraries\\(main PRIVATE tactnet::tactnet\\)")
    message(FATAL_ERROR "vcpkg does not tell how to use the port:\n${output}")
endif()

string(REPLACE "|" ";" components "${components}")
execute_process(
    COMMAND
        "${CMAKE_COMMAND}" -S "${FOLDER}/consumer" -B "${FOLDER}/build" -G "${GENERATOR}" "-DCMAKE_TOOLCHAIN_FILE=${TOOLCHAIN}"
        "-DCMAKE_CXX_COMPILER=${COMPILER}" -DCMAKE_BUILD_TYPE=Release -DVCPKG_MANIFEST_INSTALL=OFF
        "-DVCPKG_INSTALLED_DIR=${FOLDER}/installed" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF "-DCOMPONENTS=${components}"
        COMMAND_ERROR_IS_FATAL ANY
)
execute_process(COMMAND "${CMAKE_COMMAND}" --build "${FOLDER}/build" --parallel 1 COMMAND_ERROR_IS_FATAL ANY)
foreach(program IN LISTS programs)
    execute_process(COMMAND "${FOLDER}/build/test_${program}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
# Taken from there, and not from elsewhere on this machine.
file(STRINGS "${FOLDER}/build/CMakeCache.txt" found REGEX "^(tactnet|xsimd|Eigen3)_DIR:")
foreach(line IN LISTS found)
    if(NOT line MATCHES "=${FOLDER}/")
        message(FATAL_ERROR "Found elsewhere than where vcpkg has installed it: ${line}")
    endif()
endforeach()
