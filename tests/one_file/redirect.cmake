# For each header that a one-file form holds, a file of its name that includes the whole: cmake -DFILE=… -DFOLDER=… -P …
cmake_minimum_required(VERSION 3.22)

file(REMOVE_RECURSE "${FOLDER}")
get_filename_component(name "${FILE}" NAME)
file(STRINGS "${FILE}" lines REGEX "^// ---- tactnet/")
if(NOT lines)
    message(FATAL_ERROR "${FILE}: expected headers, found none")
endif()
foreach(line IN LISTS lines)
    string(REPLACE "// ---- " "" header "${line}")
    file(WRITE "${FOLDER}/${header}" "#pragma once\n#include \"${FILE}\"\n")
endforeach()
# Two units of every program, first.cpp and second.cpp, take it by this name.
file(WRITE "${FOLDER}/one_file.hpp" "#pragma once\n#include <${name}>\n")
