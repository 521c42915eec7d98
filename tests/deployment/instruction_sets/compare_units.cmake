# A unit must find the same bits alone as in one program with units for other instruction sets: otherwise it took
# functions of theirs.
#
# cmake -DTOGETHER=<program> "-DALONE=<program>;<program>;..." -P compare_units.cmake
cmake_minimum_required(VERSION 3.22)

execute_process(COMMAND "${TOGETHER}" OUTPUT_VARIABLE together COMMAND_ERROR_IS_FATAL ANY)
set(alone "")
foreach(program IN LISTS ALONE)
    execute_process(COMMAND "${program}" OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
    string(APPEND alone "${output}")
endforeach()
if(NOT together STREQUAL alone)
    message(FATAL_ERROR "Together the units found\n${together}alone they found\n${alone}")
endif()
# What was compiled alike would prove nothing.
string(REGEX MATCHALL "[^\n]+" lines "${alone}")
list(LENGTH lines count)
list(TRANSFORM lines REPLACE " .*" "")
list(REMOVE_DUPLICATES lines)
list(LENGTH lines different)
if(NOT different EQUAL count)
    message(FATAL_ERROR "Of ${count} units only ${different} are for different instruction sets: ${lines}")
endif()
