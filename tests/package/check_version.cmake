cmake_minimum_required(VERSION 3.22)

file(READ "${FOLDER}/packaging/vcpkg/tactnet/vcpkg.json" port)
string(JSON port_version GET "${port}" version)
if(NOT port_version STREQUAL VERSION)
    message(FATAL_ERROR "packaging/vcpkg/tactnet/vcpkg.json: expected version ${VERSION}, found ${port_version}.")
endif()

file(READ "${FOLDER}/CITATION.cff" citation)
if(NOT citation MATCHES "\nversion: ([^\n]*)\n" OR NOT CMAKE_MATCH_1 STREQUAL VERSION)
    message(FATAL_ERROR "CITATION.cff: expected version ${VERSION}, found '${CMAKE_MATCH_1}'.")
endif()

file(READ "${FOLDER}/CHANGELOG.md" changelog)
string(REPLACE "." "\\." pattern "\n## [[]${VERSION}[]]")
if(NOT changelog MATCHES "${pattern}")
    message(FATAL_ERROR "CHANGELOG.md: expected a section '## [${VERSION}]', found none.")
endif()
