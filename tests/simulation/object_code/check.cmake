# An effect that is not in a scene's list has no trace in the object code: including its header changes no symbol and
# no size. One that is listed is there, which shows that the check can see it.
#
# cmake -DCOMPILER=... -DNM=... -DSOURCE=... -DINCLUDES=a|b -DDEFINITIONS=a|b -DHEADER=... -DEFFECT=... -DFOLDER=...
#       -P check.cmake
cmake_minimum_required(VERSION 3.22)

set(arguments -std=c++20 -O2 -c)
string(REPLACE "|" ";" includes "${INCLUDES}")
foreach(folder IN LISTS includes)
    if(folder)
        list(APPEND arguments "-I${folder}")
    endif()
endforeach()
string(REPLACE "|" ";" definitions "${DEFINITIONS}")
foreach(definition IN LISTS definitions)
    if(definition)
        list(APPEND arguments "-D${definition}")
    endif()
endforeach()

# symbols(variable name option...): name, size and kind of each symbol of the compiled scene.
function(symbols result name)
    set(object "${FOLDER}/${name}.o")
    execute_process(
        COMMAND "${COMPILER}" ${arguments} ${ARGN} "${SOURCE}" -o "${object}" COMMAND_ERROR_IS_FATAL ANY
    )
    execute_process(COMMAND "${NM}" -S --defined-only "${object}" OUTPUT_VARIABLE lines COMMAND_ERROR_IS_FATAL ANY)
    # Without the address.
    string(REGEX REPLACE "(^|\n)[0-9a-f]+ " "\\1" lines "${lines}")
    file(SIZE "${object}" bytes)
    message("${name}: ${bytes} bytes")
    set(${result} "${lines}" PARENT_SCOPE)
endfunction()

file(MAKE_DIRECTORY "${FOLDER}")
symbols(without without)
symbols(included included "-DTACTNET_TEST_HEADER=<tactnet/simulation/${HEADER}>")
symbols(listed listed "-DTACTNET_TEST_HEADER=<tactnet/simulation/${HEADER}>" "-DTACTNET_TEST_EFFECT=${EFFECT},")
if(without STREQUAL "" OR without MATCHES "${EFFECT}")
    message(FATAL_ERROR "The scene without ${EFFECT} has these symbols:\n${without}")
endif()
if(NOT included STREQUAL without)
    message(FATAL_ERROR "Including ${HEADER} changes the object code:\n${included}\nWithout it:\n${without}")
endif()
if(NOT listed MATCHES "${EFFECT}")
    message(FATAL_ERROR "The scene with ${EFFECT} has no symbol of it:\n${listed}")
endif()
