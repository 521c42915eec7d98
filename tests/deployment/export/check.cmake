# Builds firmware.cpp without exceptions and run-time type information, sees what it asks of the system, and runs it.
#
# cmake -DCOMPILER=... -DINCLUDES=a,b -DOPTIONS=-x,-y -DHEADERS=<folder of the written headers> -DSOURCE=... \
#       -DPROGRAM=<to write> [-DEMULATOR=...] [-DNM=...] -P check.cmake
cmake_minimum_required(VERSION 3.22)

foreach(list IN ITEMS INCLUDES OPTIONS)
    string(REPLACE "," ";" ${list} "${${list}}")
endforeach()
# After everything else, or the headers of this machine would stand before those of another that is built for.
list(TRANSFORM INCLUDES PREPEND "-idirafter")
set(common -std=c++20 -O2 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -fno-exceptions -fno-rtti)
execute_process(
    COMMAND "${COMPILER}" ${common} ${OPTIONS} "-I${HEADERS}" ${INCLUDES} -MD -MF "${PROGRAM}.d" -c "${SOURCE}" -o "${PROGRAM}.o"
            COMMAND_ERROR_IS_FATAL ANY
)

file(READ "${PROGRAM}.d" included)
# What an output means: a header that needs nothing else of its room.
string(REGEX REPLACE "tactnet/networks/recognition[.]hpp" "" included "${included}")
foreach(pattern IN ITEMS "/iostream" "/fstream" "/filesystem" "/Eigen/" "operators/[a-z_]+/layer" "operators/layer" "tactnet/networks" "tactnet/io")
    if(included MATCHES "${pattern}")
        message(FATAL_ERROR "The header brings in ${pattern}, which a target without files may not have.")
    endif()
endforeach()

if(NM)
    execute_process(COMMAND "${NM}" -u "${PROGRAM}.o" OUTPUT_VARIABLE needs COMMAND_ERROR_IS_FATAL ANY)
    foreach(pattern IN ITEMS " __cxa_" " _Znw" " _Zna" " _Zdl" " malloc" " free" " f?open" " _ZSt[0-9]*__throw")
        if(needs MATCHES "${pattern}")
            message(FATAL_ERROR "The program needs '${pattern}': no heap, no exceptions, no files. All it needs:\n${needs}")
        endif()
    endforeach()
endif()

# Linked statically where it runs in an emulator, which then needs no libraries of that machine.
set(link "")
if(EMULATOR)
    set(link -static)
endif()
execute_process(COMMAND "${COMPILER}" ${OPTIONS} ${link} "${PROGRAM}.o" -o "${PROGRAM}" COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${EMULATOR} "${PROGRAM}" RESULT_VARIABLE status OUTPUT_VARIABLE output)
if(NOT status EQUAL 0)
    message(FATAL_ERROR "The program ended with ${status}; firmware.cpp says what that means.")
endif()
message("${output}")
