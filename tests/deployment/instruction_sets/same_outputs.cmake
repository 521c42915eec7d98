# Units of the same instructions that cut their work by caches of other sizes must find the same bits.
#
# cmake -DFIRST=<program> -DSECOND=<program> -P same_outputs.cmake
cmake_minimum_required(VERSION 3.22)

foreach(program IN ITEMS FIRST SECOND)
    execute_process(COMMAND "${${program}}" OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
    string(FIND "${output}" " " end)
    string(SUBSTRING "${output}" 0 ${end} set_${program})
    string(SUBSTRING "${output}" ${end} -1 bits_${program})
endforeach()
if(set_FIRST STREQUAL set_SECOND)
    message(FATAL_ERROR "Both programs are for the same caches: ${set_FIRST}")
endif()
if(NOT bits_FIRST STREQUAL bits_SECOND)
    message(FATAL_ERROR "${set_FIRST} found\n${bits_FIRST}${set_SECOND} found\n${bits_SECOND}")
endif()
