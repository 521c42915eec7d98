# Makes the reference and reports its warnings as errors: cmake -DDOXYGEN=… -DFOLDER=… -P make.cmake
#
# Doxygen stands in FOLDER with its Doxyfile. Every type, concept, function and constant needs a sentence; members whose
# names explain themselves, `bound` of an effect and `layer` of a specification, and the room kernels, do not.
cmake_minimum_required(VERSION 3.22)

file(REMOVE_RECURSE "${FOLDER}/html")
execute_process(COMMAND "${DOXYGEN}" "${FOLDER}/Doxyfile" RESULT_VARIABLE result)
if(NOT result EQUAL 0)
    message(FATAL_ERROR "Doxygen has failed: ${result}.")
endif()
if(NOT EXISTS "${FOLDER}/html/index.html" OR NOT EXISTS "${FOLDER}/html/search/all_0.js")
    message(FATAL_ERROR "Expected ${FOLDER}/html/index.html with its search, found none.")
endif()

set(problems "")
file(READ "${FOLDER}/warnings.txt" text)
# Brackets and semicolons mean something to CMake's lists, not here.
string(REGEX REPLACE "[][;]" " " text "${text}")
string(REPLACE "\n" ";" warnings "${text}")
foreach(warning IN LISTS warnings)
    if(warning AND NOT warning MATCHES "(Compound (tactnet::kernels|[^ ]*<|[^ ]*::layer::)|of (struct|class|union) |of namespace tactnet::kernels).*is not documented|Compound [^ ]*::(bound|layer) is not documented")
        string(APPEND problems "  ${warning}\n")
    endif()
endforeach()
if(problems)
    message(FATAL_ERROR "The reference:\n${problems}")
endif()
