# Writes the port of a release for a registry: the overlay port of this checkout, with the archive that the forge offers of
# the release's tag instead of the checkout. Needed once for each release, when its archive is there:
#
#     cmake -DARCHIVE=v0.3.0.tar.gz -DREPOSITORY=<owner>/<name> -DOUTPUT=<registry>/ports/tactnet \
#           -P packaging/vcpkg/write_registry_port.cmake
cmake_minimum_required(VERSION 3.22)

foreach(argument IN ITEMS ARCHIVE REPOSITORY OUTPUT)
    if(NOT ${argument})
        message(FATAL_ERROR "write_registry_port: expected -D${argument}=..., found none.")
    endif()
endforeach()
if(NOT EXISTS "${ARCHIVE}")
    message(FATAL_ERROR "write_registry_port: ${ARCHIVE}: no such file.")
endif()
set(port "${CMAKE_CURRENT_LIST_DIR}/tactnet")

file(READ "${port}/vcpkg.json" description)
string(JSON version GET "${description}" version)
if(NOT REPOSITORY MATCHES "^[^/]+/[^/]+$")
    message(FATAL_ERROR "write_registry_port: expected -DREPOSITORY=<owner>/<name>, found '${REPOSITORY}'.")
endif()
file(SHA512 "${ARCHIVE}" checksum)

file(READ "${port}/portfile.cmake" portfile)
set(source "set(SOURCE_PATH \"\${CURRENT_PORT_DIR}/../../..\")\n")
string(FIND "${portfile}" "${source}" position)
if(position EQUAL -1)
    message(FATAL_ERROR "write_registry_port: ${port}/portfile.cmake: expected a line ${source}found none.")
endif()
string(LENGTH "${source}" length)
math(EXPR rest "${position} + ${length}")
string(SUBSTRING "${portfile}" ${rest} -1 rest) # without what is said of the overlay in front of it
file(
    WRITE "${OUTPUT}/portfile.cmake"
    "vcpkg_from_github(
    OUT_SOURCE_PATH SOURCE_PATH
    REPO ${REPOSITORY}
    REF \"v\${VERSION}\"
    SHA512 ${checksum}
    HEAD_REF main
)
${rest}"
)
foreach(file IN ITEMS vcpkg.json usage)
    configure_file("${port}/${file}" "${OUTPUT}/${file}" COPYONLY)
endforeach()
message(STATUS "${OUTPUT}: tactnet ${version} of ${REPOSITORY}")
