# `conan create .`, which ends with the test package: a consumer that deploys a tiny network and runs.
#
# cmake -DCONAN=... -DSOURCE=<checkout> -DOPTIONS=-o,... -DFOLDER=<to write in> -P conan.cmake
cmake_minimum_required(VERSION 3.22)

if(NOT CONAN)
    message("skipped: no conan on the PATH, and none in TACTNET_CONAN")
    return()
endif()
string(REPLACE "," ";" OPTIONS "${OPTIONS}")
# Under a name of its own, so that a package of the user's stays as it is.
set(name "tactnet/*@package_test/local")
execute_process(
    COMMAND "${CONAN}" create "${SOURCE}" --user package_test --channel local -s compiler.cppstd=20 -s build_type=Release
            ${OPTIONS} -c tools.build:jobs=1 -c "tools.cmake.cmake_layout:test_folder=${FOLDER}"
    RESULT_VARIABLE status
    OUTPUT_VARIABLE output
    ERROR_VARIABLE output
)
execute_process(COMMAND "${CONAN}" remove "${name}" --confirm OUTPUT_QUIET ERROR_QUIET)
if(NOT status EQUAL 0)
    message(FATAL_ERROR "conan create ended with ${status}:\n${output}")
endif()
foreach(sentence IN ITEMS "tactnet decodes recordings" "tactnet [0-9.]+ recognises" "tactnet takes Eigen's matrices")
    if(NOT output MATCHES "${sentence}" AND (OPTIONS STREQUAL "" OR sentence MATCHES "recordings"))
        message(FATAL_ERROR "Expected the test package to say '${sentence}', found\n${output}")
    endif()
endforeach()
message("${output}")
